// What the lanes do at the traps of textbooks; tests/core/traps_test.cpp has the printed forms. Independent evidence:
// closed forms and conservation.
#include "momentum_rounding.h"
#include "rig.h"

namespace motley {
namespace {

using testing::box;
using testing::frame_time;
using testing::run;
using testing::with_gravity;

SolverSettings sequential(DriftCorrection correction, Vec3<float> gravity = {})
{
    SolverSettings settings = with_gravity(gravity);
    settings.method = Method::sequential_impulse;
    settings.substeps = 1;
    settings.iterations = 8;
    settings.drift_correction = correction;
    return settings;
}

TEST(Trap1InLanes, ASatisfiedJointStillHoldsAWeight)
{
    Scene scene;
    const BodyId weight = scene.add_body(box({0, 0, 0}));
    const ConstraintId joint = scene.add_joint(BallSocketDefinition{scene.ground(), weight, {}, {}});
    Solver solver(sequential(DriftCorrection::none, {0, -9.81F, 0}));
    run(scene, solver, 1);
    EXPECT_LT(scene.joint_report(joint).error, 1e-6F);
    EXPECT_NEAR(scene.joint_report(joint).force.y, 2 * 9.81, 1e-3);
}

TEST(Trap2InLanes, ASliderFarOutAlongItsRailKeepsAngularMomentum)
{
    // The lever arm of a ends where b is: with r_a alone, every impulse a metre away would turn the pair.
    Scene scene;
    BodyDefinition left = box({0, 0, 0}), right = box({1.5, 0, 0});
    left.angular_velocity = {0, 0, 0.5F};
    right.linear_velocity = {0.3F, 0.75F, 0};
    right.angular_velocity = {0, 0, 0.5F};
    const BodyId a = scene.add_body(left), b = scene.add_body(right);
    scene.add_joint(SliderDefinition{a, b, {}, {}});
    double squares = 0;
    const auto momentum = [&] {
        double sum = squares = 0;
        for (const BodyId id : {a, b}) {
            const BodyState s = scene.state(id);
            const Vec3<double> v = convert<double>(s.linear_velocity);
            const double spin = 0.5 * static_cast<double>(s.angular_velocity.z);
            sum += 2 * (s.position.x * v.y - s.position.y * v.x) + spin;
            const double turning = 2 * std::sqrt(dot(s.position, s.position) * dot(v, v)) + std::abs(spin);
            squares += turning * turning;
        }
        return sum;
    };
    // Relaxation acts on arms that have turned, so it drifts by a share of h: without it only rounding is left.
    Solver solver({.substeps = 16, .relaxations = 0});
    solver.step(scene, frame_time);
    const double before = momentum();
    run(scene, solver, 1);
    const double after = momentum(),
                 rounding = testing::rounding_of_momenta(60 * 16 * testing::stores_of(1, 1), squares);
    EXPECT_NEAR(after, before, rounding);
    EXPECT_GT(std::abs(before), 0.1);
}

TEST(Trap3InLanes, ALockTurnsBackAboutEveryAxis)
{
    for (int axis = 0; axis < 3; ++axis) {
        Scene scene;
        BodyDefinition body = box({0, 0, 0});
        double* const turn[3] = {&body.orientation.x, &body.orientation.y, &body.orientation.z};
        *turn[axis] = 0.1;
        const BodyId id = scene.add_body(body);
        const ConstraintId lock = scene.add_joint(RotationLockDefinition{scene.ground(), id, {}, {}});
        Solver solver;
        run(scene, solver, 1);
        EXPECT_LT(scene.joint_report(lock).angle_error, 1e-4F) << "axis " << axis;
    }
}

TEST(Trap4InLanes, ATurnThroughManyHemispheresNeverJumpsAndAFlippedQuaternionIsTheSameScene)
{
    // A welded pair tumbles through several turns: the cached impulse must not change its sign where q does.
    Scene scene;
    BodyDefinition left = box({-0.5, 0, 0}), right = box({0.5, 0, 0});
    left.angular_velocity = right.angular_velocity = {0, 0, 7};
    left.linear_velocity = {0, -3.5F, 0};
    right.linear_velocity = {0, 3.5F, 0};
    const BodyId a = scene.add_body(left), b = scene.add_body(right);
    const ConstraintId weld = scene.add_joint(FixedDefinition{a, b, {{0.5F, 0, 0}}, {{-0.5F, 0, 0}}});
    Scene flipped = scene;
    const BodyState s = flipped.state(b);
    const Quat<double>& q = s.orientation;
    flipped.set_pose(b, s.position, {-q.x, -q.y, -q.z, -q.w}, 0);
    Solver solver({.substeps = 8});
    float worst = 0, fastest_change = 0, before = 7;
    for (int step = 0; step < 240; ++step) {
        solver.step(scene, frame_time);
        solver.step(flipped, frame_time);
        worst = std::max(worst, scene.joint_report(weld).angle_error);
        const float rate = scene.state(b).angular_velocity.z;
        fastest_change = std::max(fastest_change, std::abs(rate - before));
        before = rate;
    }
    EXPECT_LT(worst, 2e-3F);
    EXPECT_LT(fastest_change, 0.05F);
    EXPECT_EQ(flipped.state(b).angular_velocity.z, scene.state(b).angular_velocity.z);
    EXPECT_EQ(flipped.state(b).position.x, scene.state(b).position.x);
}

TEST(Trap5InLanes, AWeldHalfATurnOffStaysBounded)
{
    for (const double short_of_pi : {0.0, 1e-7, 1e-4, 1e-2}) {
        Scene scene;
        BodyDefinition body = box({0, 0, 0});
        const double half = (3.14159265358979 - short_of_pi) / 2;
        body.orientation = {0, 0, std::sin(half), std::cos(half)};
        const BodyId id = scene.add_body(body);
        scene.add_joint(FixedDefinition{scene.ground(), id, {}, {}});
        Solver solver;
        float fastest = 0;
        for (int step = 0; step < 120; ++step) {
            ASSERT_EQ(solver.step(scene, frame_time).bodies_contained, 0);
            const Vec3<float> w = scene.state(id).angular_velocity;
            fastest = std::max(fastest, std::sqrt(dot(w, w)));
        }
        // At most the whole error within about one substep of 1/240 s.
        EXPECT_LT(fastest, 3.1416F * 240) << short_of_pi;
    }
}

TEST(Trap6InLanes, ABodyLeavesItsLimitWithTheSpeedItHas)
{
    Scene scene;
    const BodyId body = scene.add_body(box({0, 0, 0}));
    scene.add_joint(SliderDefinition{scene.ground(), body, {}, {}});
    SlideDriveDefinition stop{.body_a = scene.ground(), .body_b = body, .lower = 0};
    scene.add_joint(stop);
    scene.set_force(body, {-10, 0, 0}, {});
    Solver solver;
    run(scene, solver, 0.5);  // pressed on the limit, its impulse cached
    scene.set_force(body, {}, {});
    run(scene, solver, 0.1);
    scene.set_velocity(body, {2, 0, 0}, {});
    run(scene, solver, 0.5);
    EXPECT_NEAR(scene.state(body).linear_velocity.x, 2, 1e-3);
    EXPECT_NEAR(scene.state(body).position.x, 1, 5e-3);
}

TEST(Trap7InLanes, BaumgarteShrinksAnErrorByItsShareEachStep)
{
    Scene scene;
    const BodyId body = scene.add_body(box({0.01, 0, 0}));
    const ConstraintId joint = scene.add_joint(BallSocketDefinition{scene.ground(), body, {}, {}});
    Solver solver(sequential(DriftCorrection::baumgarte));
    for (int step = 1; step <= 20; ++step) {
        solver.step(scene, frame_time);
        EXPECT_NEAR(scene.joint_report(joint).error, 0.01 * std::pow(0.8, step), 1e-6) << step;
    }
}

TEST(Trap8InLanes, ProjectionKeepsTheCommonCentreAndClosesTheWholeGapToAStaticBody)
{
    for (const bool to_ground : {false, true}) {
        Scene scene;
        const BodyId light = scene.add_body(box({0, 0, 0}, 1)), heavy = scene.add_body(box({0.1, 0, 0}, 100));
        const ConstraintId joint = scene.add_joint(BallSocketDefinition{
            light, to_ground ? scene.ground() : heavy, {}, {to_ground ? 0.1F : 0, 0, 0}});
        Solver solver(sequential(DriftCorrection::projection));
        solver.step(scene, frame_time);
        EXPECT_LT(scene.joint_report(joint).error, 1e-6F);
        const double centre = scene.state(light).position.x + 100 * scene.state(heavy).position.x;
        if (!to_ground) {
            EXPECT_NEAR(centre, 10, 1e-5);
        }
        EXPECT_LT(std::abs(scene.state(light).linear_velocity.x),
                  1e-6F);  // positions moved, no energy added
    }
}

TEST(Trap9InLanes, AHeldBodyDoesNotDriftWithoutAnyCorrection)
{
    Scene scene;
    const BodyId body = scene.add_body(box({0, 0, 0}));
    scene.add_joint(FixedDefinition{scene.ground(), body, {}, {}});
    Solver solver(sequential(DriftCorrection::none, {0, -9.81F, 0}));
    run(scene, solver, 1);
    EXPECT_LT(std::abs(scene.state(body).position.y), 1e-6);  // integrating first would leave 0.16 m
}

TEST(Trap10InLanes, OneSweepSatisfiesAJointWhateverItsLever)
{
    for (const float lever : {0.1F, 2.0F, 5.0F, 50.0F}) {
        Scene scene;
        BodyDefinition body = box({-0.6 * static_cast<double>(lever), -0.64 * static_cast<double>(lever),
                                   -0.48 * static_cast<double>(lever)});
        body.angular_velocity = {0.5F, -0.3F, 0.8F};
        body.linear_velocity = {1, 2, 3};
        const BodyId id = scene.add_body(body);
        const Vec3<float> anchor = lever * Vec3<float>{0.6F, 0.64F, 0.48F};
        scene.add_joint(BallSocketDefinition{scene.ground(), id, {}, anchor});
        SolverSettings settings = sequential(DriftCorrection::none);
        settings.iterations = 1;
        Solver solver(settings);
        solver.step(scene, 1e-6F);
        const BodyState s = scene.state(id);
        const Vec3<float> v = s.linear_velocity + cross(s.angular_velocity, anchor);
        // What K^-1 in float leaves of 4 m/s; the condition number is that of m r^2 / I.
        const float condition = 1 + 2 * lever * lever / 0.2F;
        EXPECT_LT(std::sqrt(dot(v, v)), 1e-6F * 4 * condition) << "lever " << lever;
    }
}

TEST(Trap11InLanes, ACachedImpulseFollowsTheStepTheLoadAndNotATeleport)
{
    // A load of 1e7 kg, steps that change tenfold, then a teleport.
    Scene scene;
    const BodyId load = scene.add_body(box({0, 0, 0}, 1e7F));
    const ConstraintId joint = scene.add_joint(BallSocketDefinition{scene.ground(), load, {}, {}});
    Solver solver(with_gravity({0, -9.81F, 0}));
    run(scene, solver, 0.5);
    for (int step = 0; step < 60; ++step) {
        solver.step(scene, step % 2 == 0 ? 1.0F / 600 : 1.0F / 60);
        EXPECT_LT(std::abs(scene.state(load).linear_velocity.y), 1e-4F) << step;
    }
    EXPECT_NEAR(scene.joint_report(joint).force.y, 9.81e7, 1e5);
    scene.set_pose(load, {0, 0, 0}, {0, 0, 0, 1}, 0);
    EXPECT_EQ(scene.joint_report(joint).force.y, 0);
}

}  // namespace
}  // namespace motley
