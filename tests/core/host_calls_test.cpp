// What a host keeps and asks of the bodies themselves. Independent evidence: what it was told when it added them.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "motley/motley.h"

namespace motley {
namespace {

/// One body of each model and motion, turned each in its own way.
std::vector<BodyId> add_one_of_each(Scene& scene)
{
    std::vector<BodyId> bodies;
    for (const BodyModel model : {BodyModel::particle, BodyModel::planar, BodyModel::rigid}) {
        for (const BodyMotion motion :
             {BodyMotion::dynamic_body, BodyMotion::kinematic_body, BodyMotion::static_body}) {
            BodyDefinition body;
            body.model = model;
            body.motion = motion;
            body.yaw = 0.3 + static_cast<double>(bodies.size());
            body.orientation = {0.1, 0.2, 0.3, 1.0 + static_cast<double>(bodies.size())};
            bodies.push_back(scene.add_body(body));
        }
    }
    return bodies;
}

TEST(HostCalls, OrientationsInBulkAreThoseOfStates)
{
    Scene scene;
    std::vector<BodyId> bodies = add_one_of_each(scene);
    bodies.push_back(scene.ground());
    struct Own {
        char before = 'b';
        Quat<double> orientation{};
        char after = 'a';
    };
    std::vector<Own> own(bodies.size());
    scene.read_orientations(bodies, {&own[0].orientation, own.size(), sizeof(Own)});
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const Quat<double> expected = scene.state(bodies[i]).orientation, &q = own[i].orientation;
        EXPECT_EQ(q.x, expected.x) << i;
        EXPECT_EQ(q.y, expected.y) << i;
        EXPECT_EQ(q.z, expected.z) << i;
        EXPECT_EQ(q.w, expected.w) << i;
        EXPECT_NEAR(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w, 1, 1e-12) << i;
        EXPECT_EQ(own[i].before, 'b');
        EXPECT_EQ(own[i].after, 'a');
    }
}

TEST(HostCalls, BodiesAreListedBySlotWithoutTheGroundAndTheRemoved)
{
    Scene scene;
    std::vector<BodyId> listed(3);
    scene.read_bodies(listed);
    EXPECT_TRUE(listed.empty());
    std::vector<BodyId> bodies = add_one_of_each(scene);
    scene.read_bodies(listed);
    EXPECT_EQ(listed, bodies);
    scene.remove_body(bodies[2]);
    scene.remove_body(bodies[7]);
    scene.read_bodies(listed);
    bodies.erase(bodies.begin() + 7);
    bodies.erase(bodies.begin() + 2);
    EXPECT_EQ(listed, bodies);
    scene.renumber_bodies();
    scene.read_bodies(listed);
    EXPECT_EQ(listed, bodies) << "rows move, slots do not";
    const BodyId born = scene.add_body({});
    scene.read_bodies(listed);
    EXPECT_EQ(listed.size(), scene.body_count());
    for (std::size_t i = 1; i < listed.size(); ++i) EXPECT_LT(listed[i - 1].slot, listed[i].slot);
    EXPECT_NE(std::find(listed.begin(), listed.end(), born), listed.end());
    // As bulk calls take them.
    std::vector<Vec3<double>> positions(listed.size());
    EXPECT_NO_THROW(scene.read_positions(listed, positions));
}

TEST(HostCalls, UserDataIsZeroAtBirthAndStaysWithItsBodyInCopies)
{
    Scene scene;
    const std::vector<BodyId> bodies = add_one_of_each(scene);
    EXPECT_EQ(scene.user_data(bodies[4]), 0U);
    const std::uint64_t hash = scene.state_hash();
    scene.set_user_data(bodies[4], 0xFEDCBA9876543210U);
    scene.set_user_data(scene.ground(), 3);
    EXPECT_EQ(scene.state_hash(), hash);
    EXPECT_EQ(scene.user_data(bodies[4]), 0xFEDCBA9876543210U);
    EXPECT_EQ(scene.user_data(bodies[3]), 0U);
    EXPECT_EQ(scene.user_data(bodies.back()), 0U);
    scene.renumber_bodies();
    Scene copy = scene;
    scene.set_user_data(bodies[4], 1);
    EXPECT_EQ(copy.user_data(bodies[4]), 0xFEDCBA9876543210U);
    EXPECT_EQ(copy.user_data(copy.ground()), 3U);
    const BodyId late = copy.add_body({});
    EXPECT_EQ(copy.user_data(late), 0U);
    copy.set_user_data(late, 9);
    copy.remove_body(late);
    const BodyId in_its_slot = copy.add_body({});
    ASSERT_EQ(in_its_slot.slot, late.slot);
    EXPECT_EQ(copy.user_data(in_its_slot), 0U);
}

TEST(HostCalls, JointReportsInBulkAreThoseOfEachJoint)
{
    Scene scene;
    std::vector<ConstraintId> joints;
    BodyId above = scene.ground();
    for (int i = 0; i < 5; ++i) {
        const BodyId body = scene.add_body({.position = {0.5 + i, 0, 0}, .mass = 1 + static_cast<float>(i)});
        joints.push_back(scene.add_joint(
            BallSocketDefinition{above, body, {above == scene.ground() ? 0.0F : 0.5F, 0, 0}, {-0.5F, 0, 0}}));
        above = body;
    }
    joints.push_back(
        scene.add_joint(DistanceDefinition{.body_a = scene.ground(), .body_b = above, .max_length = 4}));
    Solver solver({.gravity = {0, -9.81F, 0}});
    for (int step = 0; step < 20; ++step) solver.step(scene, 1.0F / 60);
    std::vector<JointReport> reports(joints.size());
    scene.read_joint_reports(joints, reports);
    for (std::size_t i = 0; i < joints.size(); ++i) {
        const JointReport expected = scene.joint_report(joints[i]);
        EXPECT_EQ(reports[i].force.x, expected.force.x) << i;
        EXPECT_EQ(reports[i].force.y, expected.force.y) << i;
        EXPECT_EQ(reports[i].torque.z, expected.torque.z) << i;
        EXPECT_EQ(reports[i].error, expected.error) << i;
        EXPECT_EQ(reports[i].state, expected.state) << i;
    }
    EXPECT_NE(reports[0].force.y, 0);
    // A list with one bad handle changes no report.
    const std::array<ConstraintId, 2> bad{joints[1], ConstraintId{}};
    std::array<JointReport, 2> kept{};
    kept[0].error = 7;
    EXPECT_THROW(scene.read_joint_reports(bad, kept), InvalidInput);
    EXPECT_EQ(kept[0].error, 7);
}

}  // namespace
}  // namespace motley
