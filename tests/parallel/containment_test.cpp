// What a step does with a body whose state is not finite: the body is frozen and named, and its joints and contacts
// are left out until the host revives it. Independent evidence: free fall, and the same scene without the bad body,
// bit for bit.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <vector>

#include "motley/motley.h"

namespace motley {
namespace {

constexpr float dt = 1.0F / 60;

/// So light that a finite force gives an acceleration that is not finite.
constexpr float light = 1e-6F;

BodyDefinition ball(const Vec3<double>& position, BodyModel model = BodyModel::rigid, float mass = 1)
{
    BodyDefinition body;
    body.model = model;
    body.mass = mass;
    body.position = position;
    return body;
}

SolverSettings settings_of(Method method)
{
    SolverSettings settings;
    settings.method = method;
    settings.drift_correction = DriftCorrection::baumgarte;  // a push shows in the velocities
    settings.gravity = {0, -10, 0};
    return settings;
}

/// A contact between balls of radius 1 that overlap by 0.2 m.
Contact contact_between(BodyId a, BodyId b)
{
    Contact contact;
    contact.body_a = a;
    contact.body_b = b;
    contact.key = 7;
    contact.normal = {1, 0, 0};
    contact.separation = -0.2F;
    contact.arm_a = {0.9F, 0, 0};
    contact.arm_b = {-0.9F, 0, 0};
    return contact;
}

/// Freezes a light body: a force drives it beyond the range of floats.
void freeze(Scene& scene, Solver& solver, BodyId body)
{
    scene.set_force(body, {3e38F, 3e38F, 0}, {});
    StepReport report;
    for (int step = 0; step < 10 && report.bodies_contained == 0; ++step) report = solver.step(scene, dt);
    ASSERT_EQ(report.status, StepStatus::done);
    ASSERT_EQ(report.bodies_contained, 1);
    EXPECT_EQ(report.first_contained, body);
    ASSERT_TRUE(scene.is_contained(body));
    scene.set_force(body, {}, {});
}

class Containment : public testing::TestWithParam<Method> {};

TEST_P(Containment, LeavesOutJointsAndContactsOfAFrozenBody)
{
    Scene scene, alone;
    Solver solver(settings_of(GetParam())), other(settings_of(GetParam()));
    const BodyId bad = scene.add_body(ball({0, 0, 0}, BodyModel::rigid, light));
    freeze(scene, solver, bad);
    const Vec3<double> at = scene.state(bad).position;
    EXPECT_TRUE(std::isfinite(at.x) && std::isfinite(at.y) && std::isfinite(at.z));

    // Bodies joined to and in contact with the frozen body, both with an error: neither may be pushed.
    const auto neighbour = [&](Scene& to, double side) {
        return to.add_body(ball({at.x + side * 1.8, at.y, at.z}));
    };
    const BodyId left = neighbour(scene, -1), right = neighbour(scene, 1);
    const BodyId free_left = neighbour(alone, -1), free_right = neighbour(alone, 1);
    const ConstraintId joint = scene.add_joint(BallSocketDefinition{bad, left, {-1, 0, 0}, {1, 0, 0}});
    const Contact contacts[] = {contact_between(bad, right)};
    for (int step = 0; step < 30; ++step) {
        const StepReport report = solver.step(scene, dt, contacts);
        ASSERT_EQ(report.status, StepStatus::done) << report.error;
        EXPECT_EQ(report.bodies_contained, 0) << "is counted once";
        if (GetParam() != Method::direct) {
            EXPECT_EQ(report.joints, 0);
            EXPECT_EQ(report.contacts, 0);
        }
        other.step(alone, dt);
        ASSERT_EQ(scene.state(left).position.y, alone.state(free_left).position.y) << step;
        ASSERT_EQ(scene.state(right).position.x, alone.state(free_right).position.x) << step;
        EXPECT_EQ(scene.contact_impulses()[0].normal, 0);
        EXPECT_EQ(scene.joint_report(joint).force.y, 0);
    }
    EXPECT_EQ(scene.state(bad).position.x, at.x);
    EXPECT_EQ(scene.state(bad).position.y, at.y);

    // After the revival its joint pulls and its contact pushes.
    scene.revive(bad, {at.x, scene.state(left).position.y, at.z}, scene.state(left).linear_velocity);
    EXPECT_FALSE(scene.is_contained(bad));
    const StepReport report = solver.step(scene, dt, contacts);
    ASSERT_EQ(report.status, StepStatus::done) << report.error;
    EXPECT_GT(scene.state(right).linear_velocity.x, 0);
    EXPECT_EQ(report.joints, GetParam() == Method::direct ? report.joints : 1);
}

TEST_P(Containment, LeavesOtherIslandsTheirBits)
{
    // Twelve chains of four links; the force acts on one of them. Compared with the same scene without the force.
    const auto build = [](Scene& scene, std::vector<BodyId>& ids) {
        for (int chain = 0; chain < 12; ++chain) {
            for (int i = 0; i < 4; ++i) {
                ids.push_back(
                    scene.add_body(ball({1.0 * i, 0, 3.0 * chain}, BodyModel::rigid, i == 2 ? light : 1)));
                const BodyId before = i == 0 ? scene.ground() : ids[ids.size() - 2];
                const Vec3<float> anchor = i == 0 ? Vec3<float>{-0.5F, 0, 3.0F * static_cast<float>(chain)}
                                                  : Vec3<float>{0.5F, 0, 0};
                scene.add_joint(BallSocketDefinition{before, ids.back(), anchor, {-0.5F, 0, 0}});
            }
        }
    };
    std::vector<BodyId> ids, calm_ids;
    Scene scene, calm;
    build(scene, ids);
    build(calm, calm_ids);
    Solver solver(settings_of(GetParam())), other(settings_of(GetParam()));
    const std::size_t first_bad = 4 * 5;
    std::int64_t contained = 0;
    for (int step = 0; step < 40; ++step) {
        if (step == 10) scene.set_force(ids[first_bad + 2], {3e38F, 0, 3e38F}, {});
        contained += solver.step(scene, dt).bodies_contained;
        other.step(calm, dt);
        for (std::size_t i = 0; i < ids.size(); ++i) {
            const BodyState state = scene.state(ids[i]);
            ASSERT_TRUE(std::isfinite(state.position.x) && std::isfinite(state.orientation.w)) << i;
            if (i / 4 == first_bad / 4) continue;
            ASSERT_EQ(state.position.y, calm.state(calm_ids[i]).position.y) << i << " in step " << step;
            ASSERT_EQ(state.angular_velocity.z, calm.state(calm_ids[i]).angular_velocity.z) << i;
        }
    }
    EXPECT_GE(contained, 1);
    EXPECT_LE(contained, 4);
}

TEST(ContainedBodies, CanBeRemovedAndTheirSlotsUsedAgain)
{
    Scene scene;
    Solver solver(settings_of(Method::soft_step));
    const BodyId bad = scene.add_body(ball({0, 0, 0}, BodyModel::planar, light));
    freeze(scene, solver, bad);
    scene.remove_body(bad);
    const BodyId next = scene.add_body(ball({0, 0, 0}, BodyModel::planar));
    EXPECT_FALSE(scene.is_contained(next));
    solver.step(scene, dt);
    EXPECT_LT(scene.state(next).position.y, 0);
}

TEST_P(Containment, HoldsABodyWhateverSpeedTheHostGivesIt)
{
    for (const BodyModel model : {BodyModel::particle, BodyModel::planar, BodyModel::rigid}) {
        Scene scene;
        Solver solver(settings_of(GetParam()));
        const BodyId bad = scene.add_body(ball({0, 0, 0}, model, light));
        freeze(scene, solver, bad);
        const BodyState before = scene.state(bad);
        const Vec3<float> speed{1, 2, 0}, turn{0, 0, model == BodyModel::particle ? 0.0F : 3.0F};
        scene.set_velocity(bad, speed, turn);
        scene.set_velocities({&bad, 1}, std::span(&speed, 1), std::span(&turn, 1));
        for (int step = 0; step < 5; ++step) solver.step(scene, dt);
        const BodyState after = scene.state(bad);
        EXPECT_EQ(after.position.x, before.position.x);
        EXPECT_EQ(after.position.y, before.position.y);
        EXPECT_EQ(after.yaw, before.yaw);
        EXPECT_EQ(after.orientation.z, before.orientation.z);
        EXPECT_EQ(after.linear_velocity.x, 0) << "and says so";
    }
}

TEST(ContainedBodies, FeelTheForcesThatWereSetMeanwhileOnceTheyAreRevived)
{
    for (const BodyModel model : {BodyModel::particle, BodyModel::planar, BodyModel::rigid}) {
        Scene scene;
        SolverSettings settings;
        Solver solver(settings);
        BodyDefinition body = ball({0, 0, 0}, model, light);
        body.inertia = {4, 0, 0, 4, 0, 4};
        const BodyId bad = scene.add_body(body);
        freeze(scene, solver, bad);
        const float torque = model == BodyModel::particle ? 0.0F : 8.0F;
        scene.set_force(bad, {3 * light, 0, 0}, {0, 0, torque});
        scene.revive(bad, {0, 0, 0}, {});
        solver.step(scene, 0.5F);
        // v = F t / m, w = T t / I, up to the rounding of four substeps.
        EXPECT_NEAR(scene.state(bad).linear_velocity.x, 1.5, 1e-5);
        EXPECT_NEAR(scene.state(bad).angular_velocity.z, torque * 0.5F / 4, 1e-5);
    }
}

INSTANTIATE_TEST_SUITE_P(Methods, Containment,
                         testing::Values(Method::soft_step, Method::sequential_impulse, Method::direct));

}  // namespace
}  // namespace motley
