// Method::direct as a host uses it: against closed forms, against the limit to which the sequential methods converge,
// and where constraints are redundant, contradictory or singular.
#include <Eigen/Geometry>
#include <initializer_list>
#include <numbers>

#include "mixed_scene.h"
#include "rig.h"

namespace motley {
namespace {

using testing::box;
using testing::frame_time;
using testing::with_gravity;

constexpr double g = 9.81;

SolverSettings direct(DriftCorrection correction, Vec3<float> gravity = {0, -9.81F, 0})
{
    SolverSettings settings = with_gravity(gravity);
    settings.method = Method::direct;
    settings.substeps = 1;
    settings.drift_correction = correction;
    return settings;
}

/// The contact of a ball of radius 0.5 with a slope: a plane of the ground through the origin, tilted by `angle`.
Contact ball_on_slope(const Scene& scene, BodyId ball, double angle, float friction)
{
    const Vec3<double> n{-std::sin(angle), std::cos(angle), 0}, x = scene.state(ball).position;
    Contact contact;
    contact.body_a = scene.ground();
    contact.body_b = ball;
    contact.normal = convert<float>(n);
    contact.separation = static_cast<float>(dot(n, x) - 0.5);
    contact.arm_a = convert<float>(x - 0.5 * n);
    contact.arm_b = -0.5F * contact.normal;
    contact.friction = friction;
    return contact;
}

TEST(DirectMethod, AChainWithAThousandfoldWeightHoldsItsJoints)
{
    // Ten links of 1 kg and 1,000 kg at the end, starting level, for 10 s at 60 Hz: sequential methods cannot hold
    // it.
    Scene scene;
    std::vector<ConstraintId> joints;
    BodyId before = scene.ground();
    for (int i = 0; i < 11; ++i) {
        BodyDefinition link = box({0.5 * i + 0.25, 0, 0}, i == 10 ? 1000.0F : 1.0F);
        link.inertia = {0.005F * link.mass, 0, 0, 0.0233F * link.mass, 0, 0.0233F * link.mass};
        const BodyId body = scene.add_body(link);
        joints.push_back(scene.add_joint(BallSocketDefinition{
            before, body, i == 0 ? Vec3<float>{} : Vec3<float>{0.25F, 0, 0}, {-0.25F, 0, 0}}));
        before = body;
    }
    SolverSettings settings = direct(DriftCorrection::projection);
    settings.projections = 3;
    settings.substeps = 8;  // the light links turn by several tenths of a radian a substep
    Solver solver(settings);
    double squares = 0, violation = 0;
    int count = 0;
    for (int step = 0; step < testing::long_run(600); ++step) {
        const StepReport report = solver.step(scene, frame_time);
        ASSERT_EQ(report.status, StepStatus::done);
        ASSERT_EQ(report.bodies_contained, 0);
        violation = std::max(violation, report.direct_violation);
        for (const ConstraintId joint : joints) {
            const double error = static_cast<double>(scene.joint_report(joint).error);
            squares += error * error;
            ++count;
        }
    }
    std::printf("rms separation %.3g m, largest violation %.3g m/s\n", std::sqrt(squares / count), violation);
    EXPECT_LT(std::sqrt(squares / count), 1e-9);
    EXPECT_LT(violation, 1e-9);
}

TEST(DirectMethod, JointReportsHoldTheWeight)
{
    Scene scene;
    const BodyId a = scene.add_body(box({0, -1, 0}, 2)), b = scene.add_body(box({0, -2, 0}, 3));
    const ConstraintId upper = scene.add_joint(FixedDefinition{scene.ground(), a, {}, {{0, 1, 0}}});
    const ConstraintId lower =
        scene.add_joint(DistanceDefinition{.body_a = a, .body_b = b, .min_length = 0, .max_length = 1});
    Solver solver(direct(DriftCorrection::baumgarte));
    for (int step = 0; step < 60; ++step) solver.step(scene, frame_time);
    EXPECT_NEAR(scene.joint_report(upper).force.y, 5 * g, 1e-4 * g);
    EXPECT_NEAR(scene.joint_report(lower).force.y, 3 * g, 1e-4 * g);
    EXPECT_EQ(scene.joint_report(lower).state, JointState::upper);
}

TEST(DirectMethod, ABlockSticksBelowTheAngleOfFrictionAndSlidesAboveIt)
{
    // A particle accelerates by g (sin - mu cos) where tan(angle) > mu, and otherwise not at all.
    const double angle = 0.4;
    for (const float mu : {0.5F, 0.3F}) {
        Scene scene;
        BodyDefinition block = box({-0.5 * std::sin(angle), 0.5 * std::cos(angle), 0});
        block.model = BodyModel::particle;
        const BodyId body = scene.add_body(block);
        Solver solver(direct(DriftCorrection::baumgarte));
        StepReport report;
        for (int step = 0; step < 60; ++step) {
            Contact contact = ball_on_slope(scene, body, angle, mu);
            report = solver.step(scene, frame_time, {&contact, 1});
            ASSERT_LT(report.direct_violation, 1e-9) << mu << ", step " << step;
        }
        const Vec3<float> v = scene.state(body).linear_velocity;
        const double speed = std::hypot(v.x, v.y);
        const bool slides = static_cast<double>(mu) < std::tan(angle);
        EXPECT_NEAR(speed, slides ? g * (std::sin(angle) - static_cast<double>(mu) * std::cos(angle)) : 0,
                    1e-5);
    }
}

TEST(DirectMethod, ABallRollsDownASlopeWithoutSlipping)
{
    // a = 5/7 g sin for a solid ball, if mu > 2/7 tan.
    const double angle = 0.3;
    Scene scene;
    BodyDefinition ball = box({-0.5 * std::sin(angle), 0.5 * std::cos(angle), 0}, 2);
    ball.inertia = {0.2F, 0, 0, 0.2F, 0, 0.2F};  // 2/5 m r^2
    const BodyId body = scene.add_body(ball);
    Solver solver(direct(DriftCorrection::none));
    for (int step = 0; step < 60; ++step) {
        const Contact contact = ball_on_slope(scene, body, angle, 0.5F);
        ASSERT_LT(solver.step(scene, frame_time, {&contact, 1}).direct_violation, 1e-9);
    }
    const BodyState state = scene.state(body);
    EXPECT_NEAR(std::hypot(state.linear_velocity.x, state.linear_velocity.y), 5.0 / 7 * g * std::sin(angle),
                1e-4);
    EXPECT_NEAR(scene.contact_impulses()[0].normal / scene.last_step(), 2 * g * std::cos(angle), 1e-3);
}

/// A heap of balls, some of which slide and some of which stick, pushed from the side.
struct Heap {
    Scene scene;
    std::vector<BodyId> balls;
    std::vector<Contact> contacts;

    Heap()
    {
        for (int i = 0; i < 6; ++i) {
            const int row = i < 3 ? 0 : i < 5 ? 1 : 2, column = i < 3 ? i : i < 5 ? i - 3 : 0;
            BodyDefinition ball = box({column + 0.5 * row, 0.5 + row * 0.5 * std::numbers::sqrt3, 0},
                                      1 + 0.3F * static_cast<float>(i));
            ball.inertia = {0.1F * ball.mass, 0, 0, 0.1F * ball.mass, 0, 0.1F * ball.mass};
            balls.push_back(scene.add_body(ball));
        }
        scene.set_force(balls[0], {25, 0, 3}, {});
        scene.set_velocity(balls[5], {-0.4F, 0, 0.3F}, {0, 1, 0});
        for (std::size_t i = 0; i < balls.size(); ++i) {
            for (std::size_t k = i + 1; k < balls.size(); ++k)
                touch(balls[i], balls[k], 0.2F * static_cast<float>(i + 1));
            if (i < 3) touch(scene.ground(), balls[i], 0.6F);
        }
    }
    void touch(BodyId a, BodyId b, float friction)
    {
        const bool floor = a == scene.ground();
        const Vec3<double> x = scene.state(b).position;
        const Vec3<double> d = floor ? Vec3<double>{0, x.y, 0} : x - scene.state(a).position;
        const double length = std::sqrt(dot(d, d));
        if (length > (floor ? 0.51 : 1.01)) return;
        Contact contact;
        contact.body_a = a;
        contact.body_b = b;
        contact.key = contacts.size() + 1;
        contact.normal = convert<float>((1 / length) * d);
        contact.separation = static_cast<float>(length - (floor ? 0.5 : 1.0));
        contact.arm_a =
            floor ? Vec3<float>{static_cast<float>(x.x), 0, static_cast<float>(x.z)} : 0.5F * contact.normal;
        contact.arm_b = -0.5F * contact.normal;
        contact.friction = friction;
        contacts.push_back(contact);
    }
};

TEST(DirectMethod, IsWhereSweepsOverAHeapWithFrictionConverge)
{
    // The same step with sweeps, ten times as many each time: independent code, in float, one constraint after
    // another.
    const Heap start;
    Heap truth = start;
    SolverSettings settings = direct(DriftCorrection::baumgarte);
    const StepReport report = Solver(settings).step(truth.scene, frame_time, truth.contacts);
    ASSERT_EQ(report.status, StepStatus::done) << report.error;
    std::printf("heap of 6 balls, %zu contacts: violation %.2g m/s\n", start.contacts.size(),
                report.direct_violation);
    EXPECT_LT(report.direct_violation, 1e-9);
    double before = 1e9;
    settings.method = Method::sequential_impulse;
    for (int iterations = 1; iterations <= 10000; iterations *= 10) {
        settings.iterations = iterations;
        Heap heap = start;
        Solver(settings).step(heap.scene, frame_time, heap.contacts);
        double distance = 0;
        for (std::size_t i = 0; i < heap.balls.size(); ++i) {
            const Vec3<float> d = heap.scene.state(heap.balls[i]).linear_velocity -
                                  truth.scene.state(truth.balls[i]).linear_velocity;
            distance = std::max(distance, static_cast<double>(std::sqrt(dot(d, d))));
        }
        std::printf("  %6d iterations: %.3g m/s from it\n", iterations, distance);
        EXPECT_LT(distance, std::max(before, 2e-5));
        before = distance;
    }
    EXPECT_LT(before, 2e-5);
}

/// Cubes of 1 m. Each touches the cubes that it stands on with its lower corners.
struct Cubes {
    Scene scene;
    std::vector<BodyId> cubes;
    std::vector<std::pair<BodyId, BodyId>> stands_on;
    std::vector<Contact> contacts;

    BodyId add(Vec3<double> position, float mass, std::initializer_list<BodyId> below)
    {
        BodyDefinition cube = box(position, mass);
        cube.inertia = {mass / 6, 0, 0, mass / 6, 0, mass / 6};
        cubes.push_back(scene.add_body(cube));
        for (const BodyId other : below) stands_on.emplace_back(other, cubes.back());
        return cubes.back();
    }
    /// Finds the corners that lie on a face. The faces are taken to be level.
    void find_contacts(float friction)
    {
        contacts.clear();
        for (const auto& [a, b] : stands_on) {
            const bool floor = a == scene.ground();
            const BodyState below = scene.state(a), cube = scene.state(b);
            const Eigen::Quaterniond turn(cube.orientation.w, cube.orientation.x, cube.orientation.y,
                                          cube.orientation.z);
            for (int corner = 0; corner < 4; ++corner) {
                const Eigen::Vector3d arm =
                    turn * Eigen::Vector3d(corner % 2 == 0 ? 0.5 : -0.5, -0.5, corner < 2 ? 0.5 : -0.5);
                const Vec3<double> arm_b{arm.x(), arm.y(), arm.z()};
                const Vec3<double> from_a = cube.position + arm_b - below.position;
                if (!floor && std::abs(from_a.x) > 0.53) continue;
                Contact contact;
                contact.body_a = a;
                contact.body_b = b;
                contact.key = (std::uint64_t{a.slot} << 32) + 4 * std::uint64_t{b.slot} +
                              static_cast<std::uint64_t>(corner);
                contact.normal = {0, 1, 0};
                contact.separation = static_cast<float>(from_a.y - (floor ? 0 : 0.5));
                contact.arm_a = convert<float>(from_a);
                contact.arm_b = convert<float>(arm_b);
                contact.friction = friction;
                contacts.push_back(contact);
            }
        }
    }
    StepReport step(Solver& solver, float friction)
    {
        find_contacts(friction);
        const StepReport report = solver.step(scene, frame_time, contacts);
        EXPECT_EQ(report.status, StepStatus::done) << report.error;
        return report;
    }
    /// The largest violation over some steps, each of which must be solved.
    double run(Solver& solver, int steps, float friction)
    {
        double violation = 0;
        for (int i = 0; i < steps; ++i) {
            const StepReport report = step(solver, friction);
            EXPECT_EQ(report.direct_unsolved, 0) << "step " << i;
            violation = std::max(violation, report.direct_violation);
        }
        return violation;
    }
};

TEST(DirectMethod, AWallOfCubesWithFrictionIsSolvedInEveryStep)
{
    // 36 cubes, 144 contacts and 432 rows, but only 216 degrees of freedom; then the same with a weight of 1,000 kg
    // on top.
    for (const float top : {1.0F, 1000.0F}) {
        Cubes wall;
        std::vector<BodyId> below;
        for (int row = 0; row < 8; ++row) {
            std::vector<BodyId> here;
            for (int i = 0; i < 8 - row; ++i) {
                const auto k = static_cast<std::size_t>(i);
                const Vec3<double> at{1.05 * i + 0.525 * row, 0.5 + row, 0};
                here.push_back(row == 0 ? wall.add(at, 1, {wall.scene.ground()})
                                        : wall.add(at, row == 7 ? top : 1, {below[k], below[k + 1]}));
            }
            below = here;
        }
        Solver solver(direct(DriftCorrection::baumgarte));
        EXPECT_LT(wall.run(solver, 20, 0.5F), 1e-9);
    }
}

TEST(DirectMethod, AStackOfLightAndHeavyCubesIsSolvedInEveryStep)
{
    Cubes stack;
    BodyId below = stack.scene.ground();
    for (int i = 0; i < 20; ++i)
        below = stack.add({0.01 * (i % 3), 0.5 + i, 0}, i % 2 == 0 ? 1.0F : 1000.0F, {below});
    SolverSettings settings = direct(DriftCorrection::baumgarte);
    settings.substeps = 4;
    Solver solver(settings);
    EXPECT_LT(stack.run(solver, 20, 0.5F), 1e-9);
    EXPECT_LT(std::abs(stack.scene.state(below).linear_velocity.y), 1e-6F);
}

TEST(DirectMethod, StacksOfMassesFarApartAreHardlyEverLeftUnsolved)
{
    // Four stacks of twenty cubes of 1 kg and of a heavier mass in turn, each aside by up to 2 cm, 80 substeps together. Most
    // stacks tip over. Which solves are left depends on rounding: of twelve stacks, 240 substeps, 3, 3, 10, 34 and 46 on x86-64
    // and 2, 11, 26, 40 and 43 on ARM.
    for (const float heavy : {10.0F, 100.0F, 1000.0F, 1e4F, 1e5F}) {
        if (testing::is_sanitized && heavy > 100) continue;  // of one stack alone all may be left
        testing::Random random(3);
        int unsolved = 0, solves = 0;
        double violation = 0;
        for (int k = 0; k < testing::repeats(4); ++k) {
            Cubes stack;
            BodyId below = stack.scene.ground();
            for (int i = 0; i < 20; ++i)
                below =
                    stack.add({0.02 * random.symmetric(), 0.5 + i, 0}, i % 2 == 0 ? 1.0F : heavy, {below});
            SolverSettings settings = direct(DriftCorrection::baumgarte);
            settings.substeps = 4;
            Solver solver(settings);
            for (int step = 0; step < 5; ++step) {
                const StepReport report = stack.step(solver, 0.5F);
                ASSERT_EQ(report.status, StepStatus::done);
                unsolved += report.direct_unsolved;
                solves += settings.substeps;
                violation = std::max(violation, report.direct_violation);
            }
        }
        std::printf("cubes of 1 kg and %g kg: %d unsolved, off by %.2g m/s\n", static_cast<double>(heavy),
                    unsolved, violation);
        EXPECT_LE(unsolved, 2 + (heavy > 1000 ? 0.25 : 0.15) * solves) << heavy;
        if (heavy <= 1000) EXPECT_LT(violation, 1e-5) << heavy;
    }
}

TEST(DirectMethod, ANetOfHingesAndWeldsWithFarMoreRowsThanMotionsIsSolved)
{
    // 36 bodies have 216 degrees of freedom; their 60 joints and one to the ground have 336 rows. Masses are 1 and
    // 1,000 kg.
    constexpr int side = 6;
    Scene scene;
    std::vector<BodyId> bodies;
    for (int i = 0; i < side * side; ++i)
        bodies.push_back(
            scene.add_body(box({double(i % side), 0, double(i / side)}, i % 7 == 0 ? 1000.0F : 1.0F)));
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        if ((i + 1) % side != 0)
            scene.add_joint(HingeDefinition{bodies[i], bodies[i + 1], {{0.5F, 0, 0}}, {{-0.5F, 0, 0}}});
        if (i + side < bodies.size())
            scene.add_joint(FixedDefinition{bodies[i], bodies[i + side], {{0, 0, 0.5F}}, {{0, 0, -0.5F}}});
    }
    scene.add_joint(FixedDefinition{scene.ground(), bodies[0], {}, {}});
    Solver solver(direct(DriftCorrection::baumgarte));
    for (int step = 0; step < 20; ++step) {
        const StepReport report = solver.step(scene, frame_time);
        ASSERT_EQ(report.direct_unsolved, 0);
        ASSERT_LT(report.direct_violation, 1e-9);
    }
}

TEST(DirectMethod, ContradictoryConstraintsAreMetInTheLeastSquares)
{
    // A rod of 1 m and a rod of 2 m between the same two points, 1.5 m apart: they pull the mass both ways, and it
    // stays.
    Scene scene;
    const BodyId bob = scene.add_body(box({1.5, 0, 0}));
    for (const float length : {1.0F, 2.0F})
        scene.add_joint(DistanceDefinition{
            .body_a = scene.ground(), .body_b = bob, .min_length = length, .max_length = length});
    for (const DriftCorrection correction : {DriftCorrection::baumgarte, DriftCorrection::projection}) {
        Solver solver(direct(correction, {}));
        StepReport report;
        for (int step = 0; step < 30; ++step) report = solver.step(scene, frame_time);
        EXPECT_EQ(report.bodies_contained, 0);
        EXPECT_EQ(report.direct_unsolved, correction == DriftCorrection::baumgarte ? 1 : 0);
        EXPECT_NEAR(scene.state(bob).position.x, 1.5, 1e-6);
        EXPECT_LT(std::abs(scene.state(bob).linear_velocity.x), 1e-5F);
    }
}

TEST(DirectMethod, RedundantJointsShareTheirLoadAndIslandsDoNotFeelEachOther)
{
    // Two welds at one place carry half the weight each. A body far away has the same bits as without them.
    const auto far_away = [](Scene& scene) {
        const BodyId bob = scene.add_body(box({50, 0, 0}));
        scene.add_joint(BallSocketDefinition{scene.ground(), bob, {49, 0, 0}, {-1, 0, 0}});
        return bob;
    };
    Scene scene, alone;
    const BodyId alone_bob = far_away(alone), bob = far_away(scene);
    const BodyId weight = scene.add_body(box({0, 0, 0}));
    const ConstraintId first = scene.add_joint(FixedDefinition{scene.ground(), weight, {}, {}});
    const ConstraintId second = scene.add_joint(FixedDefinition{scene.ground(), weight, {}, {}});
    Solver solver(direct(DriftCorrection::baumgarte));
    for (int step = 0; step < 60; ++step) {
        solver.step(scene, frame_time);
        solver.step(alone, frame_time);
    }
    EXPECT_NEAR(scene.joint_report(first).force.y, g, 1e-4);
    EXPECT_NEAR(scene.joint_report(second).force.y, g, 1e-4);
    EXPECT_EQ(scene.state(bob).position.x, alone.state(alone_bob).position.x);
    EXPECT_EQ(scene.state(bob).position.y, alone.state(alone_bob).position.y);
}

TEST(DirectMethod, AServoAtItsBoundPullsWithThatAndNoMore)
{
    Scene scene;
    const BodyId weight = scene.add_body(box({0, 0, 0}));
    PointServoDefinition servo{scene.ground(), weight};
    servo.hertz = 0;
    servo.max_force = 12;
    const ConstraintId joint = scene.add_joint(servo);
    AngularServoDefinition hold{scene.ground(), weight};
    hold.hertz = 0;
    hold.max_torque = 1;
    scene.add_joint(hold);
    scene.set_force(weight, {3, 0, 0}, {0, 0, 1.5F});
    Solver solver(direct(DriftCorrection::baumgarte));
    for (int step = 0; step < 30; ++step) ASSERT_LT(solver.step(scene, frame_time).direct_violation, 1e-9);
    // The servo pulls against the motion, which is along the load: the net force is (3, -m g), shortened by 12.
    const double load = std::hypot(3, 2 * g), speed = (load - 12) / 2 * 0.5;
    EXPECT_NEAR(scene.state(weight).linear_velocity.y, -speed * 2 * g / load, 1e-5);
    EXPECT_NEAR(scene.state(weight).linear_velocity.x, speed * 3 / load, 1e-5);
    EXPECT_NEAR(scene.state(weight).angular_velocity.z, 0.5 / 0.5 * 0.5, 1e-5);
    const Vec3<float> f = scene.joint_report(joint).force;
    EXPECT_NEAR(std::sqrt(dot(f, f)), 12, 1e-4);
}

TEST(DirectMethod, RefusesAndContainsAsTheOthersDo)
{
    Scene scene;
    const BodyId good = scene.add_body(box({0, 0, 0})), bad = scene.add_body(box({9, 0, 0}));
    scene.set_velocity(good, {1, 0, 0}, {});
    const std::uint64_t hash = scene.state_hash();
    Solver solver(direct(DriftCorrection::baumgarte, {}));
    Contact contact;
    contact.body_a = good;
    contact.body_b = good;
    EXPECT_EQ(solver.step(scene, frame_time, {&contact, 1}).status, StepStatus::refused);
    EXPECT_EQ(scene.state_hash(), hash);
    scene.set_force(bad, {3e38F, 0, 0}, {});
    StepReport report;
    for (int step = 0; step < 300 && report.bodies_contained == 0; ++step)
        report = solver.step(scene, frame_time);
    EXPECT_EQ(report.bodies_contained, 1);
    EXPECT_TRUE(scene.is_contained(bad));
    const Vec3<double> at = scene.state(bad).position;
    solver.step(scene, frame_time);
    EXPECT_EQ(scene.state(bad).position.x, at.x);
    EXPECT_EQ(scene.state(good).linear_velocity.x, 1);
}

}  // namespace
}  // namespace motley
