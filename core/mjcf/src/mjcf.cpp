// See mjcf.h. First the bodies are read into a tree of links; then each link becomes a body of a figure.
#include "motley/mjcf/mjcf.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "mjcf_joints.h"
#include "motley/core/invalid_input.h"

namespace motley {
namespace {

using namespace mjcf;

/// Bodies of the file that move as one.
struct Link {
    pugi::xml_node node;
    std::vector<Joint> joints;  ///< with the link above
    std::vector<Solid> solids;
    MassProperties mass;
    std::vector<std::unique_ptr<Link>> below;
};

class Reader {
  public:
    Reader(std::string_view text, const MjcfOptions& options) : source_{text}, options_(options) {}

    MjcfModel read()
    {
        pugi::xml_document document;
        const pugi::xml_parse_result parsed = document.load_buffer(source_.text.data(), source_.text.size());
        if (!parsed)
            throw InvalidInput("MJCF: " + std::string(parsed.description()) + " at character " +
                               std::to_string(parsed.offset + 1));
        const pugi::xml_node root = document.child("mujoco");
        if (!root) throw InvalidInput("MJCF: has no element mujoco");
        for (const pugi::xml_node& node : elements(root)) read_setting(node);
        for (const pugi::xml_node& node : root.children("worldbody")) read_world(node);
        return std::move(model_);
    }

  private:
    Source source_;
    const MjcfOptions& options_;
    Compiler compiler_;
    Defaults defaults_;
    MjcfModel model_;

    static std::vector<pugi::xml_node> elements(const pugi::xml_node& node)
    {
        std::vector<pugi::xml_node> all;
        for (const pugi::xml_node& child : node.children()) {
            if (child.type() == pugi::node_element) all.push_back(child);
        }
        return all;
    }
    static bool is_one_of(std::string_view name, std::initializer_list<std::string_view> names)
    {
        return std::find(names.begin(), names.end(), name) != names.end();
    }
    /// An element that has no defaults.
    [[nodiscard]] Element plain(const pugi::xml_node& node) const
    {
        return Defaults().element(source_, node, "");
    }

    void read_setting(const pugi::xml_node& node)
    {
        const std::string_view name = node.name();
        if (is_one_of(name, {"worldbody", "visual", "statistic", "asset", "size", "custom", "sensor"}))
            return;
        if (name == "default") return defaults_.read(source_, node);
        if (name == "compiler") return read_compiler(plain(node));
        if (name == "option") return read_option(plain(node));
        const auto& left_out = options_.leave_out;
        if (std::find(left_out.begin(), left_out.end(), name) != left_out.end()) return;
        source_.refuse(node, "is not read; name it in MjcfOptions.leave_out to do without it");
    }

    void read_compiler(const Element& compiler)
    {
        compiler.allow_only({"angle", "autolimits", "eulerseq", "coordinate", "inertiafromgeom"},
                            {"meshdir", "texturedir", "assetdir", "strippath", "discardvisual", "boundmass",
                             "boundinertia", "usethread", "convexhull"});
        const std::string angle = compiler.text("angle", "degree");
        if (angle != "degree" && angle != "radian")
            compiler.refuse("angle is " + angle + "; expected degree or radian");
        if (angle == "radian") compiler_.per_unit = 1;
        compiler_.limits_by_range = compiler.text("autolimits", "true") != "false";
        const auto demand = [&](const char* name, const char* only) {
            if (compiler.text(name, only) != only)
                compiler.refuse(std::string(name) + " is " + compiler.text(name, "") + "; expected " + only);
        };
        demand("eulerseq", "xyz");
        demand("coordinate", "local");
        demand("inertiafromgeom", "auto");
    }

    void read_option(const Element& option)
    {
        option.allow_only(
            {"gravity", "wind", "density", "viscosity"},
            {"timestep", "integrator", "cone", "jacobian", "solver", "iterations", "tolerance", "impratio",
             "ls_iterations", "noslip_iterations", "noslip_tolerance", "ccd_iterations", "ccd_tolerance",
             "mpr_iterations", "mpr_tolerance", "apirate", "collision"});
        option.demand_zero("density");
        option.demand_zero("viscosity");
        const Vec3<double> wind = option.vector("wind", {});
        if (dot(wind, wind) != 0) option.refuse("wind is not 0, which is not read");
        model_.gravity = convert<float>(option.vector("gravity", {0, 0, -9.81}));
    }

    void read_world(const pugi::xml_node& world)
    {
        Link ground;
        read_geoms_and_bodies(world, {}, "", ground);
        for (const Solid& solid : ground.solids)
            model_.obstacles.push_back({.from = convert<float>(solid.from),
                                        .to = convert<float>(solid.to),
                                        .radius = static_cast<float>(solid.radius),
                                        .friction = solid.friction});
        for (const auto& link : ground.below) add_figure(*link);
    }

    /// Reads what is in a body, or in the world, into a link.
    void read_geoms_and_bodies(const pugi::xml_node& node, const Frame& frame, const std::string& childclass,
                               Link& link)
    {
        const bool is_world = std::string_view(node.name()) == "worldbody";
        bool has_inertial = false;
        MassProperties of_geoms;
        for (const pugi::xml_node& child : elements(node)) {
            const std::string_view name = child.name();
            if (is_one_of(name, {"light", "camera", "site", "freejoint", "joint"})) continue;
            if (name == "inertial" && !is_world) {
                link.mass.add(read_inertial(plain(child), frame, compiler_.per_unit));
                has_inertial = true;
            } else if (name == "geom") {
                const Element geom = defaults_.element(source_, child, childclass);
                if (is_world && geom.text("type", "sphere") == "plane") {
                    model_.floors.push_back(read_plane(geom, compiler_.per_unit));
                    continue;
                }
                link.solids.push_back(read_solid(geom, frame, compiler_.per_unit));
                of_geoms.add(link.solids.back().mass);
            } else if (name == "body") {
                read_body(child, frame, childclass, link);
            } else {
                source_.refuse(child, "is not read");
            }
        }
        if (!has_inertial) link.mass.add(of_geoms);
    }

    void read_body(const pugi::xml_node& node, const Frame& around, const std::string& outer_class,
                   Link& above)
    {
        const Element body = plain(node);
        body.allow_only({"name", "pos", "quat", "axisangle", "euler", "xyaxes", "zaxis", "childclass"}, {});
        const std::string childclass = body.text("childclass", outer_class.c_str());
        const Frame frame = around.below({body.vector("pos", {}), body.orientation(compiler_.per_unit)});
        auto own = std::make_unique<Link>();
        own->node = node;
        const bool is_free = read_joints(node, frame, childclass, *own);
        if (is_free && std::string_view(node.parent().name()) != "worldbody")
            body.refuse("has a free joint, which only a body of the world may have");
        // Without a joint it is a part of what it is in.
        if (own->joints.empty() && !is_free) return read_geoms_and_bodies(node, frame, childclass, above);
        read_geoms_and_bodies(node, frame, childclass, *own);
        if (!(own->mass.mass > 0)) body.refuse("moves and has no mass");
        above.below.push_back(std::move(own));
    }

    /// Returns whether the body is free.
    bool read_joints(const pugi::xml_node& node, const Frame& frame, const std::string& childclass,
                     Link& link)
    {
        bool is_free = false;
        for (const pugi::xml_node& child : elements(node)) {
            const std::string_view name = child.name();
            if (name == "freejoint") is_free = true;
            if (name != "joint") continue;
            const Element joint = defaults_.element(source_, child, childclass);
            if (joint.text("type", "hinge") == "free") {
                is_free = true;
            } else {
                link.joints.push_back(read_joint(joint, frame, compiler_));
            }
        }
        if (is_free && !link.joints.empty()) source_.refuse(node, "has a free joint and others");
        return is_free;
    }

    void add_figure(const Link& top)
    {
        MjcfFigure figure;
        figure.name = top.node.attribute("name").value();
        Placed world;
        if (!top.joints.empty()) {  // it hangs on the world
            world.body = figure.figure.add_body({.motion = BodyMotion::static_body});
            figure.bodies.emplace_back("world");
        }
        add_link(figure, top, world);
        model_.figures.push_back(std::move(figure));
    }

    void add_link(MjcfFigure& figure, const Link& link, Placed above)
    {
        constexpr double share = 0.05;  // of a link between two groups of hinges
        const std::vector<JointGroup> groups = group(link.joints);
        const std::size_t between = groups.empty() ? 0 : groups.size() - 1;
        for (std::size_t i = 0; i < between; ++i) {
            const Placed part = add_body(figure, "", link, share);
            join(figure.figure, groups[i], above, part);
            above = part;
        }
        const std::string name = link.node.attribute("name").value();
        const Placed own = add_body(figure, name, link, 1 - share * static_cast<double>(between));
        if (!groups.empty()) join(figure.figure, groups.back(), above, own);
        for (const Solid& solid : link.solids)
            figure.figure.add_capsule({.body = own.body,
                                       .from = convert<float>(solid.from - own.centre),
                                       .to = convert<float>(solid.to - own.centre),
                                       .radius = static_cast<float>(solid.radius),
                                       .friction = solid.friction,
                                       .group = 1});
        for (const auto& next : link.below) add_link(figure, *next, own);
    }

    /// Adds a body with a share of a link's mass.
    Placed add_body(MjcfFigure& figure, const std::string& name, const Link& link, double share)
    {
        const Sym3<double> inertia = share * link.mass.inertia;
        const auto narrow = [](double value) { return static_cast<float>(value); };
        BodyDefinition body{.position = link.mass.centre, .mass = narrow(share * link.mass.mass)};
        body.inertia = {narrow(inertia.xx), narrow(inertia.xy), narrow(inertia.xz),
                        narrow(inertia.yy), narrow(inertia.yz), narrow(inertia.zz)};
        figure.bodies.push_back(name);
        try {
            return {figure.figure.add_body(body), link.mass.centre};
        } catch (const InvalidInput& refused) {
            source_.refuse(link.node, refused.what());
        }
    }
};

}  // namespace

MjcfModel read_mjcf(std::string_view text, const MjcfOptions& options)
{
    return Reader(text, options).read();
}

}  // namespace motley
