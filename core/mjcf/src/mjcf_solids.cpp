// See mjcf_solids.h.
#include "mjcf_solids.h"

#include <cmath>
#include <numbers>

namespace motley::mjcf {
namespace {

using std::numbers::pi;
/// Attributes of geoms that only look or belong to MuJoCo's solver.
constexpr std::initializer_list<const char*> passed_over = {
    "group", "material", "rgba", "condim", "solref", "solimp", "solmix", "margin", "gap", "priority"};

/// m (|r|^2 1 - r r^T): the inertia of a mass at r.
Sym3<double> inertia_of_point(double mass, const Vec3<double>& r)
{
    const double r2 = dot(r, r);
    return mass *
           Sym3<double>{r2 - r.x * r.x, -r.x * r.y, -r.x * r.z, r2 - r.y * r.y, -r.y * r.z, r2 - r.z * r.z};
}

/// The moments about the axis and across it of a capsule of density 1, whose axis is `length` long: a cylinder, and two
/// half-spheres whose centres of mass are 3/8 r beyond its ends.
struct Moments {
    double volume, along, across;
};
Moments moments_of(double length, double r)
{
    const double cylinder = pi * r * r * length, ball = 4.0 / 3 * pi * r * r * r;
    const double h = length / 2;
    return {
        cylinder + ball, cylinder * r * r / 2 + ball * 2 / 5 * r * r,
        cylinder * (r * r / 4 + length * length / 12) + ball * (2.0 / 5 * r * r + h * h + 3.0 / 4 * h * r)};
}

float friction_of(const Element& geom)
{
    const std::vector<double> friction = geom.numbers("friction", 1, 3);
    const double first = friction.empty() ? 1 : friction[0];
    if (!(first >= 0)) geom.refuse("friction is " + geom.text("friction", "") + "; expected 0 or more");
    return static_cast<float>(first);
}

void demand_usual_contacts(const Element& geom)
{
    for (const char* bits : {"contype", "conaffinity"}) {
        if (geom.number(bits, 1) != 1) geom.refuse(std::string(bits) + " is not 1, which is not read");
    }
}

}  // namespace

void MassProperties::add(const MassProperties& other)
{
    const double sum = mass + other.mass;
    if (!(sum > 0)) return;
    const Vec3<double> middle = (1 / sum) * (mass * centre + other.mass * other.centre);
    inertia = inertia + inertia_of_point(mass, centre - middle) + other.inertia +
              inertia_of_point(other.mass, other.centre - middle);
    mass = sum;
    centre = middle;
}

Solid read_solid(const Element& geom, const Frame& around, double per_unit)
{
    geom.allow_only({"name", "class", "type", "size", "fromto", "pos", "quat", "axisangle", "euler", "xyaxes",
                     "zaxis", "mass", "density", "friction", "contype", "conaffinity"},
                    passed_over);
    demand_usual_contacts(geom);
    const std::string type = geom.text("type", "sphere");
    if (type != "sphere" && type != "capsule")
        geom.refuse("type is " + type + "; expected sphere, capsule or, in the world, plane");
    const std::vector<double> size = geom.numbers("size", 1, 3);
    if (size.empty() || !(size[0] > 0))
        geom.refuse("size is '" + geom.text("size", "") + "'; expected a radius above 0");
    Solid solid;
    solid.radius = size[0];
    solid.friction = friction_of(geom);
    if (const std::vector<double> ends = geom.numbers("fromto", 6, 6); type == "capsule" && !ends.empty()) {
        solid.from = around.to_world({ends[0], ends[1], ends[2]});
        solid.to = around.to_world({ends[3], ends[4], ends[5]});
    } else {
        const Frame own = around.below({geom.vector("pos", {}), geom.orientation(per_unit)});
        if (type == "capsule" && (size.size() < 2 || !(size[1] > 0)))
            geom.refuse("size is '" + geom.text("size", "") +
                        "'; expected a radius and half a length, or fromto");
        const double half = type == "capsule" ? size[1] : 0;
        solid.from = own.to_world({0, 0, -half});
        solid.to = own.to_world({0, 0, half});
    }
    const Vec3<double> along = solid.to - solid.from;
    const double length = std::sqrt(dot(along, along));
    const Moments moments = moments_of(length, solid.radius);
    const double mass = geom.number("mass", geom.number("density", 1000) * moments.volume);
    if (!(mass >= 0)) geom.refuse("mass or density is below 0");
    const double scale = mass / moments.volume;
    const Vec3<double> n = length > 0 ? (1 / length) * along : Vec3<double>{0, 0, 1};
    const double extra = moments.along - moments.across;
    const Sym3<double> inertia{
        moments.across + extra * n.x * n.x, extra * n.x * n.y, extra * n.x * n.z,
        moments.across + extra * n.y * n.y, extra * n.y * n.z, moments.across + extra * n.z * n.z};
    solid.mass = {mass, 0.5 * (solid.from + solid.to), scale * inertia};
    return solid;
}

HalfSpaceDefinition read_plane(const Element& geom, double per_unit)
{
    geom.allow_only({"name", "class", "type", "size", "pos", "quat", "axisangle", "euler", "xyaxes", "zaxis",
                     "friction", "contype", "conaffinity"},
                    passed_over);
    demand_usual_contacts(geom);
    const Frame own{geom.vector("pos", {}), geom.orientation(per_unit)};
    HalfSpaceDefinition plane;
    plane.point = own.position;
    plane.normal = convert<float>(rotate(own.orientation, Vec3<double>{0, 0, 1}));
    plane.friction = friction_of(geom);
    return plane;
}

MassProperties read_inertial(const Element& inertial, const Frame& around, double per_unit)
{
    inertial.allow_only(
        {"pos", "quat", "axisangle", "euler", "xyaxes", "zaxis", "mass", "diaginertia", "fullinertia"}, {});
    const Frame own = around.below({inertial.vector("pos", {}), inertial.orientation(per_unit)});
    const std::vector<double> full = inertial.numbers("fullinertia", 6, 6);
    const std::vector<double> diagonal = inertial.numbers("diaginertia", 3, 3);
    if (full.empty() && diagonal.empty()) inertial.refuse("has neither diaginertia nor fullinertia");
    const Sym3<double> inertia = full.empty()
                                     ? Sym3<double>{diagonal[0], 0, 0, diagonal[1], 0, diagonal[2]}
                                     : Sym3<double>{full[0], full[3], full[4], full[1], full[5], full[2]};
    const double mass = inertial.number("mass", 0);
    if (!(mass > 0)) inertial.refuse("mass is " + inertial.text("mass", "missing") + "; expected above 0");
    return {mass, own.position, rotate_tensor(own.orientation, inertia)};
}

}  // namespace motley::mjcf
