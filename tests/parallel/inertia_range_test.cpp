// Bodies of every inertia that a scene accepts. Independent evidence: equations of motion are linear in masses and
// moments of inertia, so that scaling all of them changes no motion; and bounds that hold for every body.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "motley/motley.h"

namespace motley {
namespace {

constexpr float dt = 1.0F / 60;

Sym3<float> tensor(float scale)
{
    return {scale, 0.1F * scale, -0.05F * scale, 1.5F * scale, 0.2F * scale, 2 * scale};
}

TEST(InertiaRange, FreeBodiesTumbleAlike)
{
    // No torque: I w' + w x I w = 0, which any factor of I leaves unchanged.
    const auto tumble = [](float scale) {
        Scene scene;
        BodyDefinition body;
        body.inertia = tensor(scale);
        body.angular_velocity = {1, 5, 2};
        const BodyId id = scene.add_body(body);
        Solver solver;
        for (int step = 0; step < 120; ++step) solver.step(scene, dt);
        return scene.state(id);
    };
    const BodyState usual = tumble(1);
    const Vec3<float>& w = usual.angular_velocity;
    ASSERT_GT(std::abs(w.x - 1) + std::abs(w.y - 5) + std::abs(w.z - 2), 0.5) << "it does tumble";
    // Moments are 1 to 2 times the scale; a scene accepts moments from 1e-20 to 1e20.
    for (const float scale : {1.001e-20F, 5e-20F, 1e-13F, 1e-6F, 1e6F, 1.1e10F, 1e13F, 4.9e19F}) {
        const BodyState state = tumble(scale);
        // Rounding of the tensors, 1e-7, grows linearly in a free motion of 120 steps with four substeps.
        EXPECT_NEAR(state.angular_velocity.x, w.x, 2e-3) << scale;
        EXPECT_NEAR(state.angular_velocity.y, w.y, 2e-3) << scale;
        EXPECT_NEAR(state.angular_velocity.z, w.z, 2e-3) << scale;
        EXPECT_NEAR(state.orientation.x, usual.orientation.x, 2e-3) << scale;
        EXPECT_NEAR(state.orientation.w, usual.orientation.w, 2e-3) << scale;
    }
}

/// Three links of mass `scale` that fall from level.
std::vector<Vec3<double>> chain_after_a_second(float scale, const SolverSettings& settings)
{
    Scene scene;
    std::vector<BodyId> links;
    BodyId before = scene.ground();
    Vec3<float> hook{};
    for (int i = 0; i < 3; ++i) {
        BodyDefinition link;
        link.position = {0.5 + i, 0, 0};
        link.mass = scale;
        link.inertia = tensor(0.05F * scale);
        links.push_back(scene.add_body(link));
        scene.add_joint(BallSocketDefinition{before, links.back(), hook, {-0.5F, 0, 0}});
        before = links.back();
        hook = {0.5F, 0, 0};
    }
    Solver solver(settings);
    for (int step = 0; step < 60; ++step) solver.step(scene, dt);
    std::vector<Vec3<double>> at(links.size());
    scene.read_positions(links, at);
    return at;
}

TEST(InertiaRange, ChainsFallAlikeHoweverHeavyTheyAreByEveryWayToSolve)
{
    SolverSettings soft;
    soft.gravity = {0, -9.81F, 0};
    SolverSettings exact = soft;
    exact.exact_joints = true;
    SolverSettings iterated = soft;
    iterated.method = Method::sequential_impulse;
    iterated.iterations = 8;
    for (const SolverSettings& settings : {soft, exact, iterated}) {
        const std::vector<Vec3<double>> usual = chain_after_a_second(1, settings);
        EXPECT_LT(usual[2].y, -0.5) << "it does fall";
        for (const float scale : {1e-10F, 1e-7F, 1e5F, 9e9F}) {
            const std::vector<Vec3<double>> at = chain_after_a_second(scale, settings);
            for (std::size_t i = 0; i < at.size(); ++i) {
                // A falling chain amplifies rounding. Bound: a millimetre of the three metres that it has fallen.
                EXPECT_NEAR(at[i].x, usual[i].x, 1e-3) << scale << ", link " << i;
                EXPECT_NEAR(at[i].y, usual[i].y, 1e-3) << scale << ", link " << i;
            }
        }
    }
}

TEST(InertiaRange, JointsHoldBodiesWithHardlyAnyOrAnyAmountOfInertia)
{
    // A kilogram hangs on an arm of 10 cm: it neither sinks nor is contained, and its joint reports its weight.
    for (const BodyModel model : {BodyModel::planar, BodyModel::rigid}) {
        for (const float moment : {1e-20F, 1e-16F, 1e-6F, 1e10F, 1e20F}) {
            Scene scene;
            BodyDefinition body;
            body.model = model;
            body.position = {0, -0.1, 0};
            body.inertia = {moment, 0, 0, moment, 0, moment};
            const BodyId id = scene.add_body(body);
            const ConstraintId joint =
                scene.add_joint(BallSocketDefinition{scene.ground(), id, {}, {0, 0.1F, 0}});
            Solver solver({.gravity = {0, -10, 0}});
            for (int step = 0; step < 120; ++step) {
                ASSERT_EQ(solver.step(scene, dt).bodies_contained, 0) << moment;
            }
            EXPECT_NEAR(scene.state(id).position.y, -0.1, 1e-3) << moment;
            EXPECT_NEAR(scene.joint_report(joint).force.y, 10, 0.1) << moment;
        }
    }
}

}  // namespace
}  // namespace motley
