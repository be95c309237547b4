// Servos, gears, racks, pulleys and the ends of a distance joint, against motions that are known in closed form.
#include "rig.h"

namespace motley {
namespace {

using testing::axis_along;
using testing::box;
using testing::run;
using testing::with_gravity;

constexpr double pi = 3.14159265358979;
constexpr double g = 9.81;

TEST(PointServo, HoldsAWeightWhereItsSpringBalancesIt)
{
    // A spring of frequency f on the body's own mass deflects by g / (2 pi f)^2.
    Scene scene;
    const BodyId weight = scene.add_body(box({0, 0, 0}));
    PointServoDefinition mouse{scene.ground(), weight};
    mouse.hertz = 1.5F;
    const ConstraintId servo = scene.add_joint(mouse);
    Solver solver(with_gravity({0, -9.81F, 0}));
    run(scene, solver, 5);
    const double sag = g / std::pow(2 * pi * 1.5, 2);
    EXPECT_NEAR(scene.state(weight).position.y, -sag, 1e-3 * sag);
    EXPECT_NEAR(scene.joint_report(servo).force.y, 2 * g, 1e-3 * 2 * g);
    EXPECT_NEAR(scene.joint_report(servo).error, sag, 1e-3 * sag);

    // The mouse moves on and the weight follows. The servo keeps its stored impulses when it is changed.
    mouse.local_anchor_a = {1, 0.5F, 0};
    scene.set_joint(servo, mouse);
    run(scene, solver, 5);
    EXPECT_NEAR(scene.state(weight).position.x, 1, 1e-3);
    EXPECT_NEAR(scene.state(weight).position.y, 0.5 - sag, 2e-3 * sag);
}

TEST(PointServo, ABoundBelowTheWeightLetsItFallAndSlowsIt)
{
    // a = g - F / m, whatever the stiffness; also for a motor whose target is rest.
    for (const float hertz : {0.0F, 8.0F}) {
        Scene scene;
        BodyDefinition ball = box({0, 0, 0});
        ball.model = BodyModel::particle;
        const BodyId weight = scene.add_body(ball);
        PointServoDefinition band{scene.ground(), weight};
        band.hertz = hertz;
        band.max_force = 5;
        scene.add_joint(band);
        Solver solver(with_gravity({0, -9.81F, 0}));
        run(scene, solver, 1);
        // The band must first be stretched to its bound: at 8 Hz, 5 N are 1 mm, which takes 20 ms of fall.
        EXPECT_NEAR(scene.state(weight).linear_velocity.y, -(g - 2.5), hertz > 0 ? 0.06 : 1e-3);
    }
}

TEST(PointServo, WithoutStiffnessIsDryFrictionOnAFloorSeenFromAbove)
{
    // It stops after v m / F and stays at rest.
    Scene scene;
    BodyDefinition disc = box({0, 0, 0});
    disc.model = BodyModel::planar;
    disc.linear_velocity = {1.2F, -0.9F, 0};
    const BodyId body = scene.add_body(disc);
    PointServoDefinition friction{scene.ground(), body};
    friction.hertz = 0;
    friction.max_force = 4;  // 2 m/s2 on 2 kg
    scene.add_joint(friction);
    Solver solver;
    run(scene, solver, 0.5);
    EXPECT_NEAR(scene.state(body).linear_velocity.x, 0.8 * 0.5, 1e-3);
    EXPECT_NEAR(scene.state(body).linear_velocity.y, -0.6 * 0.5, 1e-3);
    run(scene, solver, 0.5);
    EXPECT_LT(std::abs(scene.state(body).linear_velocity.x), 1e-6F);
    EXPECT_NEAR(scene.state(body).position.x, 1.2 * 0.75 / 2, 0.01);
}

TEST(AngularServo, GivesWayToATorqueAsItsStiffnessSaysAndNoFurtherThanItsBound)
{
    // For a rotation about z alone C = 2 sin(theta / 2) and G = cos(theta / 2), so tau = I (2 pi f)^2 2 tan(theta /
    // 2). Above the bound alpha = (tau - max) / I.
    const double inertia = 0.25 * 2;
    Scene scene;
    const BodyId wheel = scene.add_body(box({0, 0, 0}));
    AngularServoDefinition hold{scene.ground(), wheel};
    hold.hertz = 1;
    hold.max_torque = 5;
    const ConstraintId servo = scene.add_joint(hold);
    scene.set_force(wheel, {}, {0, 0, 4});
    Solver solver;
    run(scene, solver, 6);
    const double angle = 2 * std::atan(4 / (inertia * 4 * pi * pi) / 2);
    EXPECT_NEAR(scene.joint_report(servo).angle_error, angle, 2e-3 * angle);
    EXPECT_NEAR(scene.joint_report(servo).torque.z, -4, 0.01);
    hold.hertz = 0;
    scene.set_joint(servo, hold);
    scene.set_force(wheel, {}, {0, 0, 7});
    run(scene, solver, 1);
    EXPECT_NEAR(scene.state(wheel).angular_velocity.z, (7 - 5) / inertia, 0.02);
}

TEST(AngularServo, HoldsAnOrientationInThreeDimensionsAndFollowsATargetVelocity)
{
    Scene scene;
    BodyDefinition body = box({0, 0, 0});
    body.angular_velocity = {2, -3, 1};
    const BodyId top = scene.add_body(body);
    AngularServoDefinition hold{scene.ground(), top};
    hold.frame_a.rotation = {0.2F, -0.4F, 0.1F, 0.9F};
    hold.hertz = 3;
    const ConstraintId servo = scene.add_joint(hold);
    Solver solver;
    run(scene, solver, 4);
    EXPECT_LT(scene.joint_report(servo).angle_error, 1e-4F);
    hold.hertz = 0;
    hold.target_velocity = {0, 0, 2};
    scene.set_joint(servo, hold);
    run(scene, solver, 1);
    EXPECT_NEAR(scene.state(top).angular_velocity.z, 2, 1e-3);
    EXPECT_NEAR(scene.state(top).angular_velocity.x, 0, 1e-3);
}

/// A wheel on a hinge about z at x.
BodyId add_wheel(Scene& scene, double x, float mass)
{
    const BodyId wheel = scene.add_body(box({x, 0, 0}, mass));
    scene.add_joint(HingeDefinition{
        scene.ground(), wheel, {{static_cast<float>(x), 0, 0}, axis_along(2)}, {{}, axis_along(2)}});
    return wheel;
}

TEST(Gear, SpeedsUpAsBothInertiasSayAndNeverLosesAToothOverManyTurns)
{
    // omega_b = r omega_a, alpha_a = tau / (I_a + r^2 I_b).
    const float ratio = -2.5F;
    Scene scene;
    const BodyId a = add_wheel(scene, 0, 4), b = add_wheel(scene, 2, 1);
    const ConstraintId gear =
        scene.add_joint(GearDefinition{a, b, {0, 0, 1}, {0, 0, 3}, ratio});  // an axis of any length
    scene.set_force(a, {}, {0, 0, 3});
    Solver solver;
    run(scene, solver, 1);
    const double alpha = 3 / (1 + 2.5 * 2.5 * 0.25);
    EXPECT_NEAR(scene.state(a).angular_velocity.z, alpha, 2e-3 * alpha);
    EXPECT_NEAR(scene.state(b).angular_velocity.z, ratio * alpha, 2e-3 * 2.5 * alpha);
    // The reported torque is what turns b's inertia.
    EXPECT_NEAR(scene.joint_report(gear).torque.z, 0.25 * ratio * alpha, 0.01);

    scene.set_force(a, {}, {});
    double turned_a = 0, turned_b = 0;
    for (int step = 0; step < 60 * 60; ++step) {
        // Turns are counted from the poses step by step; each step turns less than half a turn.
        const auto angle = [&](BodyId body) {
            const Quat<double> q = scene.state(body).orientation;
            return 2 * std::atan2(q.z, q.w);
        };
        const double before_a = angle(a), before_b = angle(b);
        solver.step(scene, testing::frame_time);
        turned_a += std::remainder(angle(a) - before_a, 2 * pi);
        turned_b += std::remainder(angle(b) - before_b, 2 * pi);
    }
    EXPECT_GT(turned_a, 10 * 2 * pi);
    EXPECT_NEAR(turned_b, ratio * turned_a, 1e-3);
    EXPECT_LT(scene.joint_report(gear).angle_error, 1e-3F);
}

TEST(RackAndPinion, MovesAsTheInertiaOfBothSays)
{
    // v = r omega, (m + I / r^2) a = F, and the position of the rack gives the pinion's turns.
    Scene scene;
    const BodyId pinion = add_wheel(scene, 0, 2), rack = scene.add_body(box({0, -0.4, 0}, 3));
    scene.add_joint(SliderDefinition{scene.ground(), rack, {{0, -0.4F, 0}}, {}});
    RackAndPinionDefinition teeth{pinion, rack, {0, 0, 1}, {1, 0, 0}, 0.4F};
    const ConstraintId joint = scene.add_joint(teeth);
    scene.set_force(rack, {6, 0, 0}, {});
    Solver solver;
    run(scene, solver, 1);
    const double acceleration = 6 / (3 + 0.5 / 0.16);
    EXPECT_NEAR(scene.state(rack).linear_velocity.x, acceleration, 2e-3 * acceleration);
    EXPECT_NEAR(scene.state(pinion).angular_velocity.z, acceleration / 0.4, 5e-3 * acceleration);
    const Quat<double> q = scene.state(pinion).orientation;
    EXPECT_NEAR(2 * std::atan2(q.z, q.w) * 0.4, scene.state(rack).position.x, 1e-3);
    EXPECT_LT(scene.joint_report(joint).error, 1e-3F);
}

/// A nut of mass m and inertia I about an upright screw, held on its axis.
BodyId add_nut(Scene& scene, BodyId bolt, double height, float mass, float inertia)
{
    BodyDefinition nut = box({0, height, 0}, mass);
    nut.inertia = {inertia, 0, 0, inertia, 0, inertia};
    const BodyId id = scene.add_body(nut);
    const float half = 0.70710678F;
    const JointFrame upright{{0, 0, 0}, {0, 0, half, half}};  // x along y
    const JointFrame on_bolt{{0, static_cast<float>(height - scene.state(bolt).position.y), 0},
                             upright.rotation};
    scene.add_joint(PointOnLineDefinition{bolt, id, on_bolt, upright});
    scene.add_joint(ParallelAxesDefinition{bolt, id, on_bolt, upright});
    return id;
}

TEST(Screw, ANutRunsDownAsMassAndInertiaSay)
{
    // (m + I / p^2) a = m g with p = pitch / (2 pi); closed form.
    const float mass = 2, inertia = 0.05F, pitch = 0.5F;
    Scene scene;
    const BodyId bolt = scene.add_body({.motion = BodyMotion::static_body});
    const BodyId nut = add_nut(scene, bolt, 0, mass, inertia);
    const ConstraintId thread =
        scene.add_joint(ScrewDefinition{.body_a = bolt, .body_b = nut, .axis_a = {0, 1, 0}, .pitch = pitch});
    Solver solver(with_gravity({0, -9.81F, 0}));
    run(scene, solver, 2);
    const double p = static_cast<double>(pitch) / (2 * pi);
    const double acceleration = -9.81 * static_cast<double>(mass) /
                                (static_cast<double>(mass) + static_cast<double>(inertia) / (p * p));
    EXPECT_NEAR(scene.state(nut).linear_velocity.y, 2 * acceleration, 1e-3 * std::abs(2 * acceleration));
    EXPECT_NEAR(scene.state(nut).angular_velocity.y, 2 * acceleration / p,
                1e-3 * std::abs(2 * acceleration / p));
    EXPECT_LT(scene.joint_report(thread).error, 1e-4F);
    std::printf("a = %.5f m/s2 (%.5f), %.1f turns, off its thread by %.1e m\n",
                static_cast<double>(scene.state(nut).linear_velocity.y) / 2, acceleration,
                scene.state(nut).position.y / static_cast<double>(pitch),
                static_cast<double>(scene.joint_report(thread).error));
}

TEST(Screw, AThousandTurnsMoveItAThousandPitches)
{
    // The slide against the turns counted from the poses.
    const float pitch = -0.02F;
    Scene scene;
    const BodyId bolt = scene.add_body({.motion = BodyMotion::static_body});
    const BodyId nut = add_nut(scene, bolt, 0, 1, 0.01F);
    scene.add_joint(ScrewDefinition{.body_a = bolt, .body_b = nut, .axis_a = {0, 1, 0}, .pitch = pitch});
    scene.set_velocity(nut, {0, pitch * 15, 0}, {0, 15 * 2 * static_cast<float>(pi), 0});
    Solver solver;
    double turned = 0;
    while (turned < 1000 * 2 * pi) {
        const auto angle = [&] {
            const Quat<double> q = scene.state(nut).orientation;
            return 2 * std::atan2(q.y, q.w);
        };
        const double before = angle();
        solver.step(scene, testing::frame_time);
        turned += std::remainder(angle() - before, 2 * pi);
    }
    const double wanted = static_cast<double>(pitch) * turned / (2 * pi);
    EXPECT_NEAR(scene.state(nut).position.y, wanted, 1e-5) << "of 20 m";
}

TEST(Pulley, TwoWeightsFallAsAtwoodsMachine)
{
    // a = g (m_b - m_a) / (m_a + m_b), tension 2 m_a m_b g / (m_a + m_b).
    Scene scene;
    const BodyId a = scene.add_body(box({-1, 0, 0}, 2)), b = scene.add_body(box({1, 0, 0}, 3));
    const ConstraintId rope =
        scene.add_joint(PulleyDefinition{a, b, {}, {}, {-1, 5, 0}, {1, 5, 0}, 1, 0, 10});
    Solver solver(with_gravity({0, -9.81F, 0}));
    run(scene, solver, 1);
    EXPECT_NEAR(scene.state(b).linear_velocity.y, -g / 5, 5e-3);
    EXPECT_NEAR(scene.state(a).linear_velocity.y, g / 5, 5e-3);
    EXPECT_NEAR(scene.joint_report(rope).force.y, 2 * 2 * 3 * g / 5, 0.05);
    EXPECT_EQ(scene.joint_report(rope).state, JointState::upper);
    EXPECT_LT(scene.joint_report(rope).error, 1e-3F);
}

TEST(Pulley, ABlockAndTackleBalancesTheRatioOfWeightsAndASlackRopeHoldsNothing)
{
    // Ratio 3: three lengths of rope carry b, so that 6 kg balance 2 kg. With a rope that is too long both fall
    // freely.
    for (const float length : {5 + 3 * 5.0F, 25.0F}) {
        Scene scene;
        BodyDefinition light = box({-1, 0, 0}, 2), heavy = box({1, 0, 0}, 6);
        heavy.model = BodyModel::particle;
        const BodyId a = scene.add_body(light), b = scene.add_body(heavy);
        const ConstraintId rope =
            scene.add_joint(PulleyDefinition{a, b, {}, {}, {-1, 5, 0}, {1, 5, 0}, 3, 0, length});
        Solver solver(with_gravity({0, -9.81F, 0}));
        run(scene, solver, 0.5);
        const bool slack = length > 20;
        EXPECT_NEAR(scene.state(a).linear_velocity.y, slack ? -g / 2 : 0, 2e-3);
        EXPECT_NEAR(scene.state(b).linear_velocity.y, slack ? -g / 2 : 0, 2e-3);
        EXPECT_NEAR(scene.joint_report(rope).force.y, slack ? 0 : 6 * g, 0.1);
        EXPECT_EQ(scene.joint_report(rope).state, slack ? JointState::inactive : JointState::upper);
    }
}

TEST(Pulley, HoldsTwoEqualWeightsStillByEveryMethod)
{
    // The wheels are fixed to the world, so the bodies do not conserve momentum among themselves.
    for (const Method method : {Method::soft_step, Method::sequential_impulse, Method::direct}) {
        Scene scene;
        const BodyId a = scene.add_body(box({0, -1, 0})), b = scene.add_body(box({2, -1, 0}));
        scene.add_joint(PulleyDefinition{a, b, {}, {}, {0, 0, 0}, {2, 0, 0}, 1, 0, 2});
        SolverSettings settings = with_gravity({0, -9.81F, 0});
        settings.method = method;
        Solver solver(settings);
        run(scene, solver, 2);
        for (const BodyId weight : {a, b}) EXPECT_NEAR(scene.state(weight).position.y, -1, 2e-3);
    }
}

TEST(Distance, ASpringBetweenStopsRestsOnTheOneThatItsLoadReaches)
{
    // A weight stands on a spring that carries half of it; the limit carries the other half.
    Scene scene;
    const BodyId weight = scene.add_body(box({0, 1, 0}));
    DistanceDefinition strut{scene.ground(), weight};
    strut.min_length = 0.8F;
    strut.max_length = 1.2F;
    strut.rest_length = 1;
    strut.spring_hertz = 5;
    strut.spring_damping_ratio = 1;
    strut.spring_max_force = 9.81F;
    const ConstraintId joint = scene.add_joint(strut);
    scene.add_joint(SliderDefinition{scene.ground(), weight, {{}, axis_along(1)}, {{}, axis_along(1)}});
    Solver solver(with_gravity({0, -9.81F, 0}));
    run(scene, solver, 3);
    EXPECT_NEAR(scene.state(weight).position.y, 0.8, 1e-3);
    EXPECT_NEAR(scene.joint_report(joint).force.y, 2 * g, 0.02);
    EXPECT_EQ(scene.joint_report(joint).state, JointState::lower);
}

TEST(BreakLimit, TellsTheHostOnceTheLoadIsAboveItAndLetsItDecide)
{
    // A weight of 2 g N hangs on a ball-socket with a break limit of 15 N: every step reports it until the host
    // removes it.
    Scene scene;
    const BodyId weight = scene.add_body(box({0, 0, 0}));
    const ConstraintId joint = scene.add_joint(BallSocketDefinition{scene.ground(), weight, {}, {}});
    Solver solver(with_gravity({0, -9.81F, 0}));
    scene.set_break_limit(joint, {.force = 21});
    run(scene, solver, 1);
    EXPECT_TRUE(scene.break_events().empty());
    EXPECT_THROW(scene.set_break_limit(joint, {.force = 0}), InvalidInput);
    EXPECT_THROW(scene.set_break_limit(joint, {.torque = -1}), InvalidInput);
    EXPECT_THROW(scene.set_break_limit({}, {.force = 1}), InvalidInput);
    scene.set_break_limit(joint, {.force = 15});
    run(scene, solver, 0.1);
    ASSERT_EQ(scene.break_events().size(), 1U);
    EXPECT_EQ(scene.break_events()[0].joint, joint);
    EXPECT_NEAR(scene.break_events()[0].force, 2 * g, 0.05);
    EXPECT_LT(scene.state(weight).position.y, 1e-3);  // it still holds
    scene.remove_joint(scene.break_events()[0].joint);
    run(scene, solver, 1);
    EXPECT_TRUE(scene.break_events().empty());
    EXPECT_NEAR(scene.state(weight).linear_velocity.y, -g, 1e-3);
}

TEST(BreakLimit, AHingeTellsOfItsTorque)
{
    // An arm that a weld holds level bears the moment of its weight.
    Scene scene;
    const BodyId arm = scene.add_body(box({0.5, 0, 0}));
    const ConstraintId weld = scene.add_joint(FixedDefinition{scene.ground(), arm, {}, {{-0.5F, 0, 0}}});
    scene.set_break_limit(weld, {.torque = 9});
    Solver solver(with_gravity({0, -9.81F, 0}));
    run(scene, solver, 2);
    ASSERT_EQ(scene.break_events().size(), 1U);
    EXPECT_NEAR(scene.break_events()[0].torque, 2 * g * 0.5, 0.05);
    scene.set_break_limit(weld, {});
    run(scene, solver, 0.1);
    EXPECT_TRUE(scene.break_events().empty());
}

/// A wheel of 1 kg with suspension on the world, y up.
WheelDefinition wheel_on_ground(Scene& scene)
{
    WheelDefinition wheel;
    wheel.chassis = scene.ground();
    wheel.wheel = scene.add_body(box({0.3, 0, 0}, 1));
    wheel.position = {0.3F, 0, 0};
    return wheel;
}

TEST(Wheel, ItsSuspensionGivesWayByItsFrequencyAndItsMotorSpinsItUp)
{
    // Sag g / (2 pi f)^2; alpha = tau / I about the axle, until the target speed is reached.
    Scene scene;
    WheelDefinition definition = wheel_on_ground(scene);
    definition.spring_hertz = 2;
    definition.lower = -0.5F;
    definition.motor_speed = 12;
    definition.motor_max_torque = 1;
    const Wheel wheel = add_wheel(scene, definition);
    Solver solver(with_gravity({0, -9.81F, 0}));
    run(scene, solver, 1);
    EXPECT_NEAR(scene.state(definition.wheel).angular_velocity.z, 1 / 0.25, 0.05);
    run(scene, solver, 4);
    const BodyState state = scene.state(definition.wheel);
    EXPECT_NEAR(state.angular_velocity.z, 12, 1e-2);
    EXPECT_NEAR(state.position.x, 0.3, 1e-3);
    EXPECT_NEAR(state.position.y, -g / std::pow(2 * pi * 2, 2), 1e-3);
    EXPECT_LT(scene.joint_report(wheel.axle).angle_error, 1e-3F);
}

TEST(Wheel, SteeringTurnsItsAxle)
{
    Scene scene;
    const WheelDefinition definition = wheel_on_ground(scene);
    const Wheel wheel = add_wheel(scene, definition);
    Solver solver;
    for (int step = 0; step < 60; ++step) {
        steer(scene, wheel, definition, 0.01F * static_cast<float>(std::min(step, 50)));
        solver.step(scene, testing::frame_time);
    }
    run(scene, solver, 0.5);
    const Vec3<double> axle = rotate(scene.state(definition.wheel).orientation, Vec3<double>{0, 0, 1});
    EXPECT_NEAR(axle.x, std::sin(0.5), 2e-3);
    EXPECT_NEAR(axle.z, std::cos(0.5), 2e-3);
}

TEST(Wheel, WhatItRefusesLeavesNothingBehind)
{
    Scene scene;
    const WheelDefinition good = wheel_on_ground(scene);
    WheelDefinition bad = good;
    bad.axle = {0.1F, 1, 0};
    EXPECT_THROW(add_wheel(scene, bad), InvalidInput);
    bad = good;
    bad.suspension = {0, 0, 0};
    EXPECT_THROW(add_wheel(scene, bad), InvalidInput);
    bad = good;
    bad.spring_hertz = -1;
    bad.lower = 0;
    EXPECT_THROW(add_wheel(scene, bad), InvalidInput);
    bad = good;
    bad.motor_max_torque = -2;
    EXPECT_THROW(add_wheel(scene, bad), InvalidInput);
    EXPECT_EQ(scene.joint_count(), 0U);
}

}  // namespace
}  // namespace motley
