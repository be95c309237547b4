// A type of joint that the library does not know, added by one file and one name in the list. Everything that is
// generated from the list must work for it too.
#include <gtest/gtest.h>

#include "level_rod.h"
#include "motley/motley.h"

namespace motley {
namespace {

BodyId add_body(Scene& scene, BodyModel model, double x, double y)
{
    BodyDefinition body{.model = model, .mass = 2};
    body.position = {x, y, 0};
    return scene.add_body(body);
}

TEST(AToyJoint, HoldsAnyPairOfBodiesAndReports)
{
    // A balance in free fall with a force on one side: both bodies accelerate by a = F / (m_a + m_b), and each gets
    // half the force.
    for (const BodyModel model_a : {BodyModel::particle, BodyModel::planar, BodyModel::rigid}) {
        for (const BodyModel model_b : {BodyModel::particle, BodyModel::planar, BodyModel::rigid}) {
            Scene scene;
            const BodyId a = add_body(scene, model_a, 0, 1), b = add_body(scene, model_b, 3, 1.5);
            LevelRodDefinition rod{a, b, 0.5F};
            const ConstraintId joint = scene.add_joint(rod);
            scene.set_force(b, {0, 8, 0}, {});
            Solver solver;
            for (int step = 0; step < 60; ++step)
                ASSERT_EQ(solver.step(scene, 1.0F / 60).status, StepStatus::done);
            EXPECT_NEAR(scene.state(a).linear_velocity.y, 2, 1e-3);
            EXPECT_NEAR(scene.state(b).linear_velocity.y, 2, 1e-3);
            const JointReport report = scene.joint_report(joint);
            EXPECT_NEAR(report.force.y, -4, 1e-2);
            EXPECT_LT(report.error, 1e-4F);
            scene.set_break_limit(joint, {.force = 3});
            solver.step(scene, 1.0F / 60);
            EXPECT_EQ(scene.break_events().size(), 1U);
            rod.offset = std::numeric_limits<float>::infinity();
            EXPECT_THROW(scene.set_joint(joint, rod), InvalidInput);
            scene.remove_body(b);
            EXPECT_EQ(scene.joint_count(), 0U);
        }
    }
}

TEST(AToyJoint, HoldsTheWholeListWithIt)
{
    // The list is a copy with one more type than the library's; the other types must still be there.
    Scene scene;
    const BodyId a = add_body(scene, BodyModel::rigid, 0, 0), b = add_body(scene, BodyModel::rigid, 1, 0);
    scene.add_joint(LevelRodDefinition{a, b});
    scene.add_joint(HingeDefinition{a, b, {{0.5F, 0, 0}}, {{-0.5F, 0, 0}}});
    for (const Method method : {Method::soft_step, Method::direct}) {
        Solver solver({.method = method, .gravity = {0, -9.81F, 0}}, {.threads = 2, .alone_below = 0});
        for (int step = 0; step < 60; ++step)
            ASSERT_EQ(solver.step(scene, 1.0F / 60).status, StepStatus::done);
        EXPECT_NEAR(scene.state(a).position.y, scene.state(b).position.y, 1e-5);
    }
}

}  // namespace
}  // namespace motley
