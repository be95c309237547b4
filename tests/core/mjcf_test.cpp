// Figures in MJCF. Independent evidence: rotations multiplied by hand, solids summed up from small cubes, and the file of
// MuJoCo's humanoid, whose joints and mass are known.
#include "motley/mjcf/mjcf.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <span>
#include <sstream>

#include "motley/motley.h"
#include "rig.h"

namespace motley {
namespace {

constexpr double pi = 3.141592653589793;

std::string in_world(const std::string& inside)
{
    return "<mujoco><worldbody>" + inside + "</worldbody></mujoco>";
}

std::string humanoid()
{
    std::ifstream file(MOTLEY_TEST_DATA "/humanoid.xml");
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
}

std::string message_of(const std::string& text, const MjcfOptions& options = {})
{
    try {
        (void)read_mjcf(text, options);
    } catch (const InvalidInput& refused) {
        return refused.what();
    }
    return "accepted";
}

/// Mass, centre and inertia of a capsule of density 1000 as the sum of small cubes.
struct Cubes {
    double mass = 0;
    Vec3<double> centre{};
    Sym3<double> inertia{};
    Cubes(const Vec3<double>& from, const Vec3<double>& to, double radius)
    {
        constexpr int steps = 80;
        const Vec3<double> low{std::min(from.x, to.x) - radius, std::min(from.y, to.y) - radius,
                               std::min(from.z, to.z) - radius};
        const Vec3<double> high{std::max(from.x, to.x) + radius, std::max(from.y, to.y) + radius,
                                std::max(from.z, to.z) + radius};
        const Vec3<double> size = (1.0 / steps) * (high - low), along = to - from;
        std::vector<Vec3<double>> inside;
        for (int i = 0; i < steps * steps * steps; ++i) {
            const Vec3<double> p{low.x + (i % steps + 0.5) * size.x,
                                 low.y + (i / steps % steps + 0.5) * size.y,
                                 low.z + (i / steps / steps + 0.5) * size.z};
            const double t = std::clamp(dot(p - from, along) / dot(along, along), 0.0, 1.0);
            const Vec3<double> gap = p - (from + t * along);
            if (dot(gap, gap) < radius * radius) inside.push_back(p);
        }
        const double each = 1000 * size.x * size.y * size.z;
        for (const Vec3<double>& p : inside) centre = centre + (1.0 / static_cast<double>(inside.size())) * p;
        mass = each * static_cast<double>(inside.size());
        for (const Vec3<double>& p : inside) {
            const Vec3<double> r = p - centre;
            inertia = inertia + each * Sym3<double>{r.y * r.y + r.z * r.z, -r.x * r.y, -r.x * r.z,
                                                    r.x * r.x + r.z * r.z, -r.y * r.z, r.x * r.x + r.y * r.y};
        }
    }
};

TEST(Mjcf, ACapsuleWeighsAndTurnsAsItsVolumeDoes)
{
    const MjcfModel model = read_mjcf(in_world(
        R"(<body pos="1 2 3"><freejoint/><geom type="capsule" fromto="0 0 0 .2 .3 .1" size=".08"/></body>)"));
    const BodyDefinition body = model.figures.at(0).figure.bodies()[0];
    const Cubes cubes({1, 2, 3}, {1.2, 2.3, 3.1}, 0.08);
    EXPECT_NEAR(body.mass, cubes.mass, 0.002 * cubes.mass);
    EXPECT_NEAR(body.position.x, cubes.centre.x, 1e-4);
    EXPECT_NEAR(body.position.z, cubes.centre.z, 1e-4);
    const double scale = cubes.inertia.xx;
    EXPECT_NEAR(body.inertia.xx, cubes.inertia.xx, 0.005 * scale);
    EXPECT_NEAR(body.inertia.xy, cubes.inertia.xy, 0.005 * scale);
    EXPECT_NEAR(body.inertia.xz, cubes.inertia.xz, 0.005 * scale);
    EXPECT_NEAR(body.inertia.yy, cubes.inertia.yy, 0.005 * scale);
    EXPECT_NEAR(body.inertia.yz, cubes.inertia.yz, 0.005 * scale);
    EXPECT_NEAR(body.inertia.zz, cubes.inertia.zz, 0.005 * scale);
}

TEST(Mjcf, PartsWithoutAJointAreOneBody)
{
    const MjcfModel model = read_mjcf(in_world(R"(
        <body><freejoint/><geom type="capsule" fromto="0 0 0 0 0 1" size=".1" mass="3"/>
          <body pos="0 0 1.2"><geom size=".2" mass="1"/></body></body>)"));
    ASSERT_EQ(model.figures.at(0).figure.bodies().size(), 1U);
    const BodyDefinition body = model.figures[0].figure.bodies()[0];
    EXPECT_FLOAT_EQ(body.mass, 4);
    EXPECT_NEAR(body.position.z, (3 * 0.5 + 1 * 1.2) / 4, 1e-12);
}

Quat<double> turn(const Vec3<double>& axis, double degrees)
{
    const double length = std::sqrt(dot(axis, axis)), half = degrees * pi / 360, s = std::sin(half) / length;
    return {s * axis.x, s * axis.y, s * axis.z, std::cos(half)};
}

/// The angle between two orientations, rad.
double apart(const Quat<double>& p, const Quat<double>& q)
{
    const Quat<double> d = conjugate(p) * q;
    return 2 * std::atan2(std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z), std::abs(d.w));
}

/// Hinges whose ranges leave only one angle each turn the body by the product of their rotations, in their order.
TEST(Mjcf, HingesTurnABodyInTheirOrder)
{
    struct Hinge {
        const char* axis;
        Vec3<double> vector;
        double degrees;
        const char* pos;
    };
    const std::vector<std::vector<Hinge>> cases = {
        {{"0 -1 1", {0, -1, 1}, 40, "0 0 0"}},
        {{"1 0 0", {1, 0, 0}, 30, "0 0 0"}, {"0 0 2", {0, 0, 2}, -50, "0 0 0"}},
        {{"1 0 0", {1, 0, 0}, -25, "0 0 0"},
         {"0 0 1", {0, 0, 1}, 20, "0 0 0"},
         {"0 1 0", {0, 1, 0}, -100, "0 0 0"}},
        {{"-1 0 0", {-1, 0, 0}, -25, "0 0 0"},
         {"0 0 -1", {0, 0, -1}, 20, "0 0 0"},
         {"0 1 0", {0, 1, 0}, 35, "0 0 0"}},
        {{"2 1 1", {2, 1, 1}, 35, "0 0 0"}, {"0 -1 1", {0, -1, 1}, -60, "0 0 0"}},
        // Apart, and not perpendicular: with links between them.
        {{"0 1 0", {0, 1, 0}, 30, "0 0 .08"}, {"1 0 .5", {1, 0, 0.5}, -20, "0 0 .04"}},
        {{"1 0 0", {1, 0, 0}, 30, "0 0 0"},
         {"1 1 0", {1, 1, 0}, 25, "0 0 0"},
         {"0 0 1", {0, 0, 1}, 15, "0 0 0"}},
    };
    for (const std::vector<Hinge>& hinges : cases) {
        std::ostringstream text;
        text << R"(<body name="hook"><geom size=".1" mass="5"/>)";
        text << R"(<body name="arm" quat="1 .1 .2 .3">)";
        // In the frame of the arm, which is turned against the world.
        const double length = std::sqrt(1 + 0.01 + 0.04 + 0.09);
        const Quat<double> frame{0.1 / length, 0.2 / length, 0.3 / length, 1 / length};
        Quat<double> expected{0, 0, 0, 1};
        for (const Hinge& hinge : hinges) {
            text << "<joint axis=\"" << hinge.axis << "\" pos=\"" << hinge.pos << "\" range=\""
                 << hinge.degrees << ' ' << hinge.degrees << "\"/>";
            expected = expected * turn(hinge.vector, hinge.degrees);
        }
        expected = frame * expected * conjugate(frame);  // the body has the orientation of the world at first
        text << R"(<geom type="capsule" fromto="0 0 0 .3 0 0" size=".05" mass="1"/></body></body>)";
        const MjcfModel model = read_mjcf("<mujoco><option gravity=\"0 0 0\"/><worldbody>" + text.str() +
                                          "</worldbody></mujoco>");
        Scene scene;
        const Placing origin;
        const std::vector<BodyId> bodies = add_assembly(scene, model.figures.at(0).figure, {&origin, 1});
        ASSERT_EQ(model.figures[0].bodies.back(), "arm");
        SolverSettings settings;
        settings.gravity = model.gravity;
        settings.method = Method::direct;
        Solver solver(settings);
        for (int step = 0; step < 400; ++step)
            ASSERT_EQ(solver.step(scene, 1.0F / 240).status, StepStatus::done);
        EXPECT_LT(apart(scene.state(bodies.back()).orientation, expected), 2e-3)
            << hinges.size() << " hinges, the first about " << hinges[0].axis;
    }
}

TEST(Mjcf, ReadsTheHumanoid)
{
    const MjcfModel model =
        read_mjcf(humanoid(), {.leave_out = {"contact", "tendon", "actuator", "keyframe"}});
    ASSERT_EQ(model.figures.size(), 1U);
    ASSERT_EQ(model.floors.size(), 1U);
    EXPECT_FLOAT_EQ(model.floors[0].normal.z, 1);
    const MjcfFigure& figure = model.figures[0];
    EXPECT_EQ(figure.name, "torso");
    // 13 bodies move: the head and the hands are parts of others; each ankle has a link between its two hinges.
    EXPECT_EQ(figure.bodies.size(), 13U + 2);
    EXPECT_EQ(std::count(figure.bodies.begin(), figure.bodies.end(), ""), 2);
    double mass = 0;
    for (const BodyDefinition& body : figure.figure.bodies()) mass += static_cast<double>(body.mass);
    // The sum of the volumes of its spheres and capsules by hand: see the comment of the file's sizes.
    double volume = 0;
    const auto capsule = [&](double length, double r) {
        volume += pi * r * r * length + 4.0 / 3 * pi * r * r * r;
    };
    capsule(0.14, 0.07), capsule(0.12, 0.06), capsule(0, 0.09);  // torso, waist, head
    capsule(0.12, 0.06), capsule(0.14, 0.09);                    // lower waist, pelvis
    for (int side = 0; side < 2; ++side) {
        capsule(std::sqrt(0.01 * 0.01 + 0.34 * 0.34), 0.06), capsule(0.3, 0.049);  // thigh, shin
        for (int i = 0; i < 2; ++i) capsule(std::sqrt(0.21 * 0.21 + 0.02 * 0.02), 0.027);
        capsule(std::sqrt(3 * 0.16 * 0.16), 0.04), capsule(std::sqrt(3 * 0.16 * 0.16), 0.031),
            capsule(0, 0.04);
    }
    EXPECT_NEAR(mass, 1000 * volume, 1e-3);
}

/// A hundred humanoids fall on their floor: limits hold, joints hold, and the floor bears their weight.
TEST(Mjcf, HumanoidsFallAndLie)
{
    const MjcfModel model =
        read_mjcf(humanoid(), {.leave_out = {"contact", "tendon", "actuator", "keyframe"}});
    Scene scene;
    for (const HalfSpaceDefinition& floor : model.floors) scene.add_half_space(floor);
    const int people = testing::repeats(20);
    std::vector<Placing> placings(static_cast<std::size_t>(people));
    for (std::size_t i = 0; i < placings.size(); ++i) {
        placings[i].position = {3.0 * static_cast<double>(i), 0, 0.3};
        placings[i].orientation = turn({0.3, 1, 0.1}, 200.0 / people * static_cast<double>(i) - 90);
    }
    const std::vector<BodyId> bodies = add_assembly(scene, model.figures[0].figure, placings);
    SolverSettings settings;
    settings.gravity = model.gravity;
    settings.exact_joints = true;
    Solver solver(settings, {.threads = 2});
    double floor_force = 0;
    for (int step = 0; step < 900; ++step) {
        const StepReport report = solver.step(scene, 1.0F / 60);
        ASSERT_EQ(report.status, StepStatus::done) << report.error;
        ASSERT_EQ(report.bodies_contained, 0);
        if (step < 840) continue;
        for (const ShapeContact& contact : scene.shape_contacts())
            floor_force += static_cast<double>(contact.normal.z * contact.normal_force) / 60;
    }
    double weight = 0;
    for (const BodyDefinition& body : model.figures[0].figure.bodies())
        weight += people * 9.81 * static_cast<double>(body.mass);
    EXPECT_NEAR(floor_force, weight, 0.01 * weight);
    EXPECT_LT(scene.errors().joint_separation_max, 1e-3);
    for (const BodyId body : bodies) EXPECT_GT(scene.state(body).position.z, 0);
}

/// Two dozen humanoids with rotors fall on each other from up to 17 m. The sweeps of the default neither throw them nor
/// lose them, though a forearm turns by a radian in a substep; energy may not grow, and the floor bears them in the end.
TEST(Mjcf, AHeapOfHumanoidsIsNotThrownApartByTheDefault)
{
    const MjcfModel model =
        read_mjcf(humanoid(), {.leave_out = {"contact", "tendon", "actuator", "keyframe"}});
    const std::span<const BodyDefinition> definitions = model.figures[0].figure.bodies();
    for (int heap = 0; heap < testing::repeats(3); ++heap) {
        Scene scene;
        for (const HalfSpaceDefinition& floor : model.floors) scene.add_half_space(floor);
        std::vector<Placing> placings(testing::is_sanitized ? 4 : 24);
        for (std::size_t i = 0; i < placings.size(); ++i) {
            const double place = static_cast<double>(i) + 100 * heap;
            placings[i].position = {0.5 * std::sin(7 * place), 0.5 * std::cos(11 * place),
                                    0.3 + 0.7 * static_cast<double>(i)};
            placings[i].orientation = turn({std::sin(3 * place), 1, 0.4}, 137 * place);
        }
        const std::vector<BodyId> bodies = add_assembly(scene, model.figures[0].figure, placings);
        const auto energy = [&] {
            double sum = scene.errors().kinetic_energy;
            for (std::size_t i = 0; i < bodies.size(); ++i)
                sum += 9.81 * static_cast<double>(definitions[i % definitions.size()].mass) *
                       scene.state(bodies[i]).position.z;
            return sum;
        };
        const double at_start = energy();
        SolverSettings settings;
        settings.gravity = model.gravity;
        Solver solver(settings, {.threads = 2});
        double floor_force = 0, weight = 0;
        for (int step = 0; step < 900; ++step) {
            const StepReport report = solver.step(scene, 1.0F / 60);
            ASSERT_EQ(report.status, StepStatus::done) << report.error;
            ASSERT_EQ(report.bodies_contained, 0) << heap;
            ASSERT_LT(energy(), 1.01 * at_start) << heap << ", step " << step;
            if (step < 840) continue;
            for (const ShapeContact& contact : scene.shape_contacts()) {
                if (contact.a == scene.ground())
                    floor_force += static_cast<double>(contact.normal.z * contact.normal_force) / 60;
            }
        }
        for (std::size_t i = 0; i < bodies.size(); ++i)
            weight += 9.81 * static_cast<double>(definitions[i % definitions.size()].mass);
        EXPECT_NEAR(floor_force, weight, 0.03 * weight);
        EXPECT_LT(scene.errors().joint_separation_max, 0.1);
        EXPECT_LT(energy(), 0.1 * at_start);
    }
}

TEST(Mjcf, RefusesWhatItDoesNotKnowByNameAndLine)
{
    EXPECT_EQ(message_of("<mujoco><worldbody>"), "MJCF: Start-end tags mismatch at character 19");
    EXPECT_EQ(message_of("<robot/>"), "MJCF: has no element mujoco");
    EXPECT_EQ(message_of("<mujoco>\n<tendon/></mujoco>"),
              "MJCF: tendon, line 2: is not read; name it in MjcfOptions.leave_out to do without it");
    EXPECT_EQ(message_of("<mujoco>\n<tendon/></mujoco>", {.leave_out = {"tendon"}}), "accepted");
    EXPECT_EQ(message_of(in_world(
                  "<body>\n<freejoint/>\n<geom name=\"belly\" type=\"box\" size=\"1 1 1\"/></body>")),
              "MJCF: geom 'belly', line 3: type is box; expected sphere, capsule or, in the world, plane");
    EXPECT_EQ(message_of(in_world(R"(<body><freejoint/><geom size="-1"/></body>)")),
              "MJCF: geom, line 1: size is '-1'; expected a radius above 0");
    EXPECT_EQ(message_of(in_world(R"(<body><freejoint/><geom size="1e"/></body>)")),
              "MJCF: geom, line 1: size is '1e'; expected 1 to 3 finite numbers");
    EXPECT_EQ(message_of(in_world(R"(<body><freejoint/><geom size="1" shellinertia="true"/></body>)")),
              "MJCF: geom, line 1: has the attribute shellinertia, which is not read here");
    EXPECT_EQ(message_of(in_world(R"(<body name="a"><freejoint/></body>)")),
              "MJCF: body 'a', line 1: moves and has no mass");
    EXPECT_EQ(message_of(in_world(R"(<body><joint type="slide"/><geom size="1"/></body>)")),
              "MJCF: joint, line 1: type is slide; expected hinge, ball or, below the world, free");
    EXPECT_EQ(message_of(in_world(R"(<body><joint range="20 10"/><geom size="1"/></body>)")),
              "MJCF: joint, line 1: range is '20 10'; expected two angles in order within half a turn");
    EXPECT_EQ(message_of(in_world(R"(<body><joint axis="0 0 0"/><geom size="1"/></body>)")),
              "MJCF: joint, line 1: axis has no length");
    EXPECT_EQ(message_of(in_world(R"(<body><joint class="x"/><geom size="1"/></body>)")),
              "MJCF: joint, line 1: class 'x' is not among the defaults");
    EXPECT_EQ(message_of(in_world(
                  R"(<body><freejoint/><geom size="1"/><body><freejoint/><geom size="1"/></body></body>)")),
              "MJCF: body, line 1: has a free joint, which only a body of the world may have");
    EXPECT_EQ(message_of(in_world(R"(<body><freejoint/><geom size="1" mass="1e20"/></body>)")),
              "MJCF: body, line 1: BodyDefinition.mass is 1.00000002e+20; expected 1e-10 to 1e10 (kg)");
    EXPECT_EQ(message_of(in_world("<flex/>")), "MJCF: flex, line 1: is not read");
    EXPECT_EQ(message_of("<mujoco><compiler eulerseq=\"zyx\"/></mujoco>"),
              "MJCF: compiler, line 1: eulerseq is zyx; expected xyz");
}

/// Texts cut anywhere, and with any byte changed, are read or refused.
TEST(Mjcf, ForgedTextsAreReadOrRefused)
{
    const std::string whole = humanoid();
    const MjcfOptions options{.leave_out = {"contact", "tendon", "actuator", "keyframe"}};
    for (std::size_t cut = 0; cut < whole.size(); cut += 37) (void)message_of(whole.substr(0, cut), options);
    std::uint64_t state = 7;
    for (int i = 0; i < 400; ++i) {
        std::string forged = whole;
        for (int k = 0; k < 3; ++k) {
            state = state * 6364136223846793005ULL + 1442695040888963407ULL;
            forged[(state >> 33) % forged.size()] = static_cast<char>(state >> 25);
        }
        (void)message_of(forged, options);
    }
}

}  // namespace
}  // namespace motley
