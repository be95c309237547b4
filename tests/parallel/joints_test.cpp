// Joints against motions that are known in closed form, and against each other.
#include <algorithm>

#include "swing.h"

namespace motley {
namespace {

using testing::axis_along;
using testing::box;
using testing::run;
using testing::with_gravity;

constexpr float dt = testing::frame_time;
constexpr double pi = 3.14159265358979;

TEST(Hinge, TurnsUnderATorqueAsItsInertiaAboutTheAxisSays)
{
    // omega = tau t / (I + m r^2), about z through a point r from the centre; nothing else moves.
    Scene scene;
    const BodyId door = scene.add_body(box({0.5, 0, 0}));
    const ConstraintId hinge = scene.add_joint(
        HingeDefinition{scene.ground(), door, {{}, axis_along(2)}, {{-0.5F, 0, 0}, axis_along(2)}});
    scene.set_force(door, {}, {0, 0, 3});
    Solver solver;
    run(scene, solver, 1);
    const double inertia = 0.5 + 2 * 0.25;
    const BodyState state = scene.state(door);
    EXPECT_NEAR(state.angular_velocity.z, 3 / inertia, 0.003 * 3);
    EXPECT_NEAR(std::atan2(state.position.y, state.position.x), 1.5, 0.015);  // tau t^2 / 2 I, t + h/2
    const JointReport report = scene.joint_report(hinge);
    EXPECT_LT(report.error, 5e-4F);
    EXPECT_LT(report.angle_error, 1e-4F);
    // The hinge pulls the centre along its circle: m r omega^2 inwards, m r alpha along it.
    const Vec3<float> f = report.force;
    // The report averages four substeps, which are behind by one to two substeps: 2 (1.5 + 2) h of 1 s in omega^2 on
    // average.
    EXPECT_NEAR(std::sqrt(dot(f, f)), std::hypot(2 * 0.5 * 9, 2 * 0.5 * 3), 9.5 * 2 * 3.5 / 240);
}

TEST(Slider, SlidesDownAnInclineWithoutFriction)
{
    // v = g sin(theta) t along the rail, and no turn.
    Scene scene;
    const double theta = 0.6;
    const Quat<float> rail{0, 0, static_cast<float>(std::sin(-theta / 2)),
                           static_cast<float>(std::cos(theta / 2))};
    const BodyId block = scene.add_body(box({0, 0, 0}));
    const ConstraintId slider =
        scene.add_joint(SliderDefinition{scene.ground(), block, {{}, rail}, {{0.2F, 0.1F, 0}, rail}});
    Solver solver(with_gravity({0, -9.81F, 0}));
    scene.set_pose(block, {-0.2, -0.1, 0}, {0, 0, 0, 1}, 0);
    run(scene, solver, 1);
    const BodyState state = scene.state(block);
    const double v = 9.81 * std::sin(theta);
    EXPECT_NEAR(state.linear_velocity.x, v * std::cos(theta), 0.01);
    EXPECT_NEAR(state.linear_velocity.y, -v * std::sin(theta), 0.01);
    EXPECT_LT(scene.joint_report(slider).error, 1e-3F);
    EXPECT_LT(scene.joint_report(slider).angle_error, 1e-3F);
}

TEST(Fixed, TwoBodiesFlyAsOne)
{
    // A welded pair in free flight: the common centre of mass moves in a straight line, and the relative pose stays.
    Scene scene;
    BodyDefinition left = box({-0.5, 0, 0}, 1), right = box({0.5, 0, 0}, 3);
    left.linear_velocity = {1, 2, 0};
    right.angular_velocity = {0.5F, 1, 2};
    const BodyId a = scene.add_body(left), b = scene.add_body(right);
    const ConstraintId weld = scene.add_joint(FixedDefinition{a, b, {{0.5F, 0, 0}}, {{-0.5F, 0, 0}}});
    Solver solver;
    run(scene, solver, 2);
    EXPECT_LT(scene.joint_report(weld).error, 1e-3F);
    EXPECT_LT(scene.joint_report(weld).angle_error, 2e-3F);
    const BodyState s = scene.state(a), t = scene.state(b);
    const Vec3<double> relative = rotate(conjugate(s.orientation), t.position - s.position);
    EXPECT_NEAR(relative.x, 1, 2e-3);
    EXPECT_NEAR(std::hypot(relative.y, relative.z), 0, 2e-3);
    const Vec3<double> centre =
        0.25 * s.position + 0.75 * t.position;  // started at 0.25, with a quarter of (1, 2, 0)
    EXPECT_NEAR(centre.x, 0.25 + 0.25 * 2, 1e-4);
    EXPECT_NEAR(centre.y, 0.5 * 2, 1e-4);
}

TEST(PointOnPlane, ABeadSlidesDownAnInclinedPlaneAndTurnsAsItLikes)
{
    // a = g sin(theta) along the plane, nothing along its normal; no torque, so the spin stays.
    Scene scene;
    const double theta = 0.5;
    BodyDefinition bead = box({0, 0, 0});
    bead.inertia = {0.3F, 0, 0, 0.3F, 0, 0.3F};
    bead.angular_velocity = {1, 2, -0.5F};
    bead.linear_velocity = {0, 0, 1};
    const BodyId body = scene.add_body(bead);
    // The frame's x is the plane's normal: y turned by theta about z.
    const double turn = (pi / 2 + theta) / 2;
    const Quat<float> normal{0, 0, static_cast<float>(std::sin(turn)), static_cast<float>(std::cos(turn))};
    const ConstraintId joint =
        scene.add_joint(PointOnPlaneDefinition{scene.ground(), body, {{}, normal}, {}});
    Solver solver(with_gravity({0, -9.81F, 0}));
    run(scene, solver, 1);
    const BodyState s = scene.state(body);
    const double v = 9.81 * std::sin(theta);
    EXPECT_NEAR(s.linear_velocity.x, -v * std::cos(theta), 0.01);
    EXPECT_NEAR(s.linear_velocity.y, -v * std::sin(theta), 0.01);
    EXPECT_NEAR(s.linear_velocity.z, 1, 1e-4);
    EXPECT_NEAR(s.angular_velocity.y, 2, 1e-3);
    const Vec3<float> f = scene.joint_report(joint).force;
    EXPECT_NEAR(std::sqrt(dot(f, f)), 2 * 9.81 * std::cos(theta), 0.02);
}

TEST(PointOnLine, ABeadOnAWireKeepsItsSpeedAlongItAndTheWireBearsTheWeight)
{
    Scene scene;
    BodyDefinition bead = box({0, 0, 0});
    bead.linear_velocity = {1.5F, 0, 0};
    bead.angular_velocity = {0, 2, 0};
    const BodyId body = scene.add_body(bead);
    const ConstraintId wire = scene.add_joint(PointOnLineDefinition{scene.ground(), body, {}, {}});
    Solver solver(with_gravity({0, -9.81F, 0}));
    run(scene, solver, 1);
    const BodyState s = scene.state(body);
    EXPECT_NEAR(s.position.x, 1.5, 1e-3);
    EXPECT_LT(std::hypot(s.position.y, s.position.z), 1e-3);
    EXPECT_NEAR(s.angular_velocity.y, 2, 1e-3);
    EXPECT_NEAR(scene.joint_report(wire).force.y, 2 * 9.81, 0.02);
}

TEST(RotationLock, ABodyUnderATorqueFallsAndDoesNotTurn)
{
    Scene scene;
    const BodyId body = scene.add_body(box({0, 0, 0}));
    const ConstraintId lock = scene.add_joint(RotationLockDefinition{scene.ground(), body, {}, {}});
    scene.set_force(body, {}, {1, -2, 3});
    Solver solver(with_gravity({0, -9.81F, 0}));
    run(scene, solver, 1);
    EXPECT_NEAR(scene.state(body).linear_velocity.y, -9.81, 1e-3);
    const JointReport report = scene.joint_report(lock);
    EXPECT_NEAR(report.torque.x, -1, 1e-2);
    EXPECT_NEAR(report.torque.y, 2, 2e-2);
    EXPECT_NEAR(report.torque.z, -3, 3e-2);
    EXPECT_LT(report.angle_error, 1e-3F);
}

TEST(ParallelAxes, ABodySpinsUpAboutTheAxisAndNotAcrossIt)
{
    // alpha = tau / I about x; the joint bears the rest of the torque.
    Scene scene;
    const BodyId body = scene.add_body(box({0, 0, 0}));
    const ConstraintId joint = scene.add_joint(ParallelAxesDefinition{scene.ground(), body, {}, {}});
    scene.set_force(body, {}, {0.6F, 1, -2});
    Solver solver;
    run(scene, solver, 1);
    const BodyState s = scene.state(body);
    EXPECT_NEAR(s.angular_velocity.x, 0.6 / 0.2, 0.01);
    EXPECT_LT(std::hypot(s.angular_velocity.y, s.angular_velocity.z), 0.01);
    const JointReport report = scene.joint_report(joint);
    EXPECT_NEAR(report.torque.y, -1, 0.05);
    EXPECT_NEAR(report.torque.z, 2, 0.05);
}

TEST(SlideDrive, AMotorBelowTheWeightStallsAndOneAboveItLifts)
{
    // On a vertical rail: a = F/m - g until the speed is reached.
    for (const float force : {10.0F, 40.0F}) {
        Scene scene;
        const BodyId lift = scene.add_body(box({0, 0, 0}));
        scene.add_joint(SliderDefinition{scene.ground(), lift, {{}, axis_along(1)}, {{}, axis_along(1)}});
        SlideDriveDefinition motor{.body_a = scene.ground(), .body_b = lift};
        motor.frame_a.rotation = motor.frame_b.rotation = axis_along(1);
        motor.motor_speed = 1.5F;
        motor.motor_max_force = force;
        const ConstraintId drive = scene.add_joint(motor);
        Solver solver(with_gravity({0, -9.81F, 0}));
        run(scene, solver, 0.1);
        EXPECT_NEAR(scene.state(lift).linear_velocity.y, (force / 2 - 9.81F) * 0.1F, 2e-3F) << force;
        EXPECT_NEAR(scene.joint_report(drive).force.y, force, 1e-3F * force) << force;
        run(scene, solver, 1.9);
        if (force > 20) {
            EXPECT_NEAR(scene.state(lift).linear_velocity.y, 1.5, 1e-3);
            EXPECT_NEAR(scene.joint_report(drive).force.y, 2 * 9.81, 0.02);
        } else {
            EXPECT_NEAR(scene.state(lift).linear_velocity.y, (force / 2 - 9.81F) * 2, 0.02F);
        }
    }
}

TEST(TwistDrive, ASpringSwingsWithItsFrequency)
{
    // Undamped, period 1/f. The implicit spring damps and slows by O(f h), so the test uses many substeps.
    Scene scene;
    const BodyId wheel = scene.add_body(box({0, 0, 0}));
    scene.add_joint(HingeDefinition{scene.ground(), wheel, {{}, axis_along(2)}, {{}, axis_along(2)}});
    TwistDriveDefinition spring{.body_a = scene.ground(), .body_b = wheel};
    spring.frame_a.rotation = spring.frame_b.rotation = axis_along(2);
    spring.spring_hertz = 1;
    spring.spring_target = 0.5F;
    scene.add_joint(spring);
    SolverSettings settings;
    settings.substeps = 32;
    Solver solver(settings);
    EXPECT_NEAR(testing::swing_period(scene, solver, wheel, 6), 1.0, 0.01);
}

TEST(TwistDrive, AHingedBarRestsAtItsLimitAndReportsWhichOne)
{
    Scene scene;
    const BodyId bar = scene.add_body(box({0.5, 0, 0}));
    scene.add_joint(
        HingeDefinition{scene.ground(), bar, {{}, axis_along(2)}, {{-0.5F, 0, 0}, axis_along(2)}});
    TwistDriveDefinition limit{.body_a = scene.ground(), .body_b = bar, .lower = -0.7F, .upper = 0.2F};
    limit.frame_a.rotation = limit.frame_b.rotation = axis_along(2);
    const ConstraintId drive = scene.add_joint(limit);
    Solver solver(with_gravity({0, -9.81F, 0}));
    run(scene, solver, 4);
    const BodyState state = scene.state(bar);
    EXPECT_NEAR(std::atan2(state.position.y, state.position.x), -0.7, 2e-3);
    EXPECT_EQ(scene.joint_report(drive).state, JointState::lower);
    // The limit bears the moment of the weight about the hinge.
    EXPECT_NEAR(scene.joint_report(drive).torque.z, 2 * 9.81 * 0.5 * std::cos(0.7), 0.05);
}

TEST(SwingLimit, APendulumStaysInItsConeAndHangsAtItsEdge)
{
    Scene scene;
    const BodyId bob = scene.add_body(box({1, 0, 0}));
    scene.add_joint(BallSocketDefinition{scene.ground(), bob, {}, {-1, 0, 0}});
    const ConstraintId cone =
        scene.add_joint(SwingLimitDefinition{.body_a = scene.ground(), .body_b = bob, .max_angle = 0.4F});
    Solver solver(with_gravity({0, -9.81F, 0}));
    double widest = 0;
    for (int step = 0; step < 300; ++step) {
        solver.step(scene, dt);
        const Vec3<double> p = scene.state(bob).position;
        widest = std::max(widest, std::acos(std::clamp(p.x / std::sqrt(dot(p, p)), -1.0, 1.0)));
    }
    EXPECT_LT(widest, 0.41);
    EXPECT_NEAR(std::atan2(scene.state(bob).position.y, scene.state(bob).position.x), -0.4, 3e-3);
    EXPECT_EQ(scene.joint_report(cone).state, JointState::upper);
    EXPECT_NEAR(scene.joint_report(cone).torque.z, 2 * 9.81 * std::cos(0.4), 0.2);
}

/// A box that `tie` joins to the ground is thrown; the hash after a second.
template <class Tie>
std::uint64_t thrown(const Tie& tie)
{
    Scene scene;
    BodyDefinition body = box({0.4, 0.1, 0});
    body.linear_velocity = {0.5F, 1, -0.3F};
    body.angular_velocity = {1, -0.5F, 2};
    const BodyId id = scene.add_body(body);
    tie(scene, id, JointFrame{{}, {0.1F, 0.2F, 0.3F, 1}},
        JointFrame{{-0.4F, -0.1F, 0}, {0.1F, 0.2F, 0.3F, 1}});
    Solver solver(with_gravity({0, -9.81F, 0}));
    run(scene, solver, 1);
    return scene.state_hash();
}

TEST(SixDof, BecomesTheVeryJointThatItIs)
{
    const auto same = [](const SixDofDefinition& six, const auto& joint, const char* name) {
        const std::uint64_t by_six =
            thrown([&](Scene& scene, BodyId body, const JointFrame& a, const JointFrame& b) {
                SixDofDefinition definition = six;
                definition.body_a = scene.ground();
                definition.body_b = body;
                definition.frame_a = a;
                definition.frame_b = b;
                EXPECT_EQ(add_six_dof(scene, definition).size(), 1U) << name;
            });
        EXPECT_EQ(by_six, thrown(joint)) << name;
    };
    const auto by = []<class Definition>(Definition) {
        return [](Scene& scene, BodyId body, const JointFrame& a, const JointFrame& b) {
            scene.add_joint(Definition{scene.ground(), body, a, b});
        };
    };
    SixDofDefinition fixed;
    same(fixed, by(FixedDefinition{}), "fixed");
    SixDofDefinition hinge;
    hinge.rotation[0] = AxisSetup::free();
    same(hinge, by(HingeDefinition{}), "hinge");
    SixDofDefinition slider;
    slider.position[0] = AxisSetup::free();
    same(slider, by(SliderDefinition{}), "slider");
    SixDofDefinition ball = hinge;
    ball.rotation[1] = ball.rotation[2] = AxisSetup::free();
    same(
        ball,
        [](Scene& scene, BodyId body, const JointFrame& a, const JointFrame& b) {
            scene.add_joint(BallSocketDefinition{scene.ground(), body, a.position, b.position});
        },
        "ball-socket");
}

TEST(SixDof, LimitsEachPositionWithinItsBox)
{
    // Free inside a box of half sizes 0.1, 0.2, 0.3, and shaken: no position exceeds its limit by more than the
    // softness of the limits.
    Scene scene;
    const BodyId body = scene.add_body(box({0, 0, 0}));
    SixDofDefinition six;
    six.body_a = scene.ground();
    six.body_b = body;
    for (int axis = 0; axis < 3; ++axis) {
        const float half = 0.1F * static_cast<float>(axis + 1);
        six.position[axis] = AxisSetup::limited(-half, half);
    }
    EXPECT_EQ(add_six_dof(scene, six).size(), 4U);  // three drives and the rotation lock
    Solver solver(with_gravity({3, -9.81F, 1}));
    double most[3] = {};
    for (int step = 0; step < 240; ++step) {
        if (step % 40 == 20) scene.set_velocity(body, {-2, 3, 4}, {});
        solver.step(scene, dt);
        const Vec3<double> p = scene.state(body).position;
        most[0] = std::max(most[0], std::abs(p.x));
        most[1] = std::max(most[1], std::abs(p.y));
        most[2] = std::max(most[2], std::abs(p.z));
    }
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_LT(most[axis], 0.1 * (axis + 1) + 2e-3);
        EXPECT_GT(most[axis], 0.1 * (axis + 1) - 1e-3);
    }
}

TEST(SixDof, AUniversalJointTurnsAboutTwoAxesAndCarriesATorqueAboutTheThird)
{
    // Position and rotation about z are locked: y of the body stays perpendicular to x of the ground, whatever torque
    // acts.
    Scene scene;
    const BodyId body = scene.add_body(box({0, 0, 0}));
    SixDofDefinition six;
    six.body_a = scene.ground();
    six.body_b = body;
    six.rotation[0] = six.rotation[1] = AxisSetup::free();
    const std::vector<ConstraintId> parts = add_six_dof(scene, six);
    ASSERT_EQ(parts.size(), 2U);  // a ball-socket and perpendicular axes: 4 rows
    scene.set_force(body, {}, {0.05F, 0.1F, 2});
    Solver solver;
    run(scene, solver, 0.1);
    EXPECT_NEAR(scene.joint_report(parts[1]).torque.z, -2, 0.01);
    run(scene, solver, 0.9);
    const Quat<double> q = scene.state(body).orientation;
    const Vec3<double> y = rotate(q, Vec3<double>{0, 1, 0});
    EXPECT_LT(std::abs(y.x), 1e-3);
    const Vec3<double> turned{2 * q.x, 2 * q.y, 2 * q.z};
    EXPECT_GT(turned.x, 0.05);  // tau t^2 / 2 I = 0.125 and 0.125
    EXPECT_GT(turned.y, 0.05);
}

TEST(SixDof, ALockedTwistStaysWhileTheSwingIsLoose)
{
    // A constant-velocity joint: it swings within its cone and does not twist.
    Scene scene;
    const BodyId body = scene.add_body(box({0, 0, 0}));
    SixDofDefinition six;
    six.body_a = scene.ground();
    six.body_b = body;
    six.rotation[1] = six.rotation[2] = AxisSetup::free();
    six.max_swing = 0.8F;
    ASSERT_EQ(add_six_dof(scene, six).size(), 3U);  // ball-socket, twist lock, cone
    scene.set_force(body, {}, {1, 0.3F, 0.4F});
    Solver solver;
    for (int step = 0; step < 120; ++step) {
        solver.step(scene, dt);
        const Quat<double> q = scene.state(body).orientation;
        const Vec3<double> x = rotate(q, Vec3<double>{1, 0, 0});
        EXPECT_LT(std::abs(2 * std::atan2(q.x, q.w)), 2e-3);
        EXPECT_LT(std::acos(std::clamp(x.x, -1.0, 1.0)), 0.81);
    }
}

TEST(SixDof, EveryCombinationOfLocksHoldsWhatItLocksAndLeavesTheRest)
{
    // 64 combinations, each with a force and a torque along all six coordinates at once for a tenth of a second.
    // Locked coordinates stay; free ones move by F t^2 / 2 m and tau t^2 / 2 I. A locked position makes the free ones
    // move along the axes of the ground. Rotations are small: a locked one differs from the angle measured here by
    // half the product of the other two, 1.3e-3.
    for (int locks = 0; locks < 63; ++locks) {
        Scene scene;
        BodyDefinition definition = box({0, 0, 0}, 2);
        definition.inertia = {0.5F, 0, 0, 0.5F, 0, 0.5F};
        const BodyId body = scene.add_body(definition);
        SixDofDefinition six;
        six.body_a = scene.ground();
        six.body_b = body;
        for (int axis = 0; axis < 3; ++axis) {
            if ((locks >> axis & 1) != 0) six.position[axis] = AxisSetup::free();
            if ((locks >> (3 + axis) & 1) != 0) six.rotation[axis] = AxisSetup::free();
        }
        add_six_dof(scene, six);
        scene.set_force(body, {20, 20, 20}, {5, 5, 5});
        Solver solver({.substeps = 8});
        run(scene, solver, 0.1);
        const BodyState s = scene.state(body);
        const double moved[6] = {s.position.x,        s.position.y,        s.position.z,
                                 2 * s.orientation.x, 2 * s.orientation.y, 2 * s.orientation.z};
        for (int i = 0; i < 6; ++i) {
            const bool is_free = (locks >> i & 1) != 0;
            // 10 m/s2 and 10 rad/s2 for 0.1 s give 0.05, and the order of integration adds up to 1/16 of that.
            EXPECT_NEAR(moved[i], is_free ? 0.05 : 0, is_free ? 0.005 : 2e-3)
                << "locks " << locks << ", " << i;
        }
    }
}

TEST(SixDof, EachRotationHasLimitsOfItsOwn)
{
    for (int axis = 0; axis < 3; ++axis) {
        Scene scene;
        BodyDefinition definition = box({0, 0, 0}, 2);
        definition.inertia = {0.5F, 0, 0, 0.5F, 0, 0.5F};
        const BodyId body = scene.add_body(definition);
        SixDofDefinition six;
        six.body_a = scene.ground();
        six.body_b = body;
        for (AxisSetup& rotation : six.rotation) rotation = AxisSetup::limited(-1, 1);
        six.rotation[axis] = AxisSetup::limited(-0.2F, 0.3F);
        EXPECT_EQ(add_six_dof(scene, six).size(), 4U);  // ball-socket and three drives
        const float torques[3] = {axis == 0 ? 4.0F : 0, axis == 1 ? 4.0F : 0, axis == 2 ? 4.0F : 0};
        Solver solver;
        for (const float sign : {1.0F, -1.0F}) {
            scene.set_force(body, {}, sign * Vec3<float>{torques[0], torques[1], torques[2]});
            run(scene, solver, 2);
            const Quat<double> q = scene.state(body).orientation;
            const double parts[3] = {q.x, q.y, q.z};
            EXPECT_NEAR(2 * std::atan2(parts[axis], q.w), sign > 0 ? 0.3 : -0.2, 2e-3) << "axis " << axis;
        }
    }
}

TEST(SixDof, WhatItRefusesLeavesNothingBehind)
{
    Scene scene;
    const BodyId body = scene.add_body(box({0, 0, 0}));
    SixDofDefinition six;
    six.body_a = scene.ground();
    six.body_b = body;
    six.rotation[0] = AxisSetup::limited(1, -1);
    EXPECT_THROW(add_six_dof(scene, six), InvalidInput);
    six.rotation[0] = AxisSetup::free();
    six.max_swing = 1;  // a hinge has no swing
    EXPECT_THROW(add_six_dof(scene, six), InvalidInput);
    six.max_swing = -1;
    EXPECT_THROW(add_six_dof(scene, six), InvalidInput);
    six.max_swing = static_cast<float>(pi);
    for (int axis = 0; axis < 3; ++axis) six.position[axis] = six.rotation[axis] = AxisSetup::free();
    EXPECT_THROW(add_six_dof(scene, six), InvalidInput);
    EXPECT_EQ(scene.joint_count(), 0U);
}

}  // namespace
}  // namespace motley
