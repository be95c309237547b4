// The C interface does what the C++ interface does: the same scene, built and stepped through both, has the same bits after
// every step, and gives the same numbers back.
#include <gtest/gtest.h>

#include <cstring>

#include "both.h"
#include "c/joint_mirrors.h"
#include "disc_crowd.h"
#include "joint_scene.h"
#include "scene/scene_core.h"

namespace motley {
namespace {

using testing::as_c;
using testing::Both;
using testing::DiscCrowd;
using testing::done;
using testing::JointScene;
using testing::MixedScene;

constexpr int steps = testing::long_run(100);

// An add and a set for every definition of C++, through the call of its name in C.
#define MOTLEY_THROUGH_C(name, Cpp)                                                               \
    motley_status add_through_c(motley_scene* scene, const Cpp& cpp, motley_constraint_id* joint) \
    {                                                                                             \
        motley_##name##_definition definition = motley_default_##name##_definition();             \
        c::give_fields(cpp, definition);                                                          \
        return motley_scene_add_##name(scene, &definition, joint);                                \
    }                                                                                             \
    motley_status set_through_c(motley_scene* scene, motley_constraint_id joint, const Cpp& cpp)  \
    {                                                                                             \
        motley_##name##_definition definition = motley_default_##name##_definition();             \
        c::give_fields(cpp, definition);                                                          \
        return motley_scene_set_##name(scene, joint, &definition);                                \
    }
MOTLEY_JOINT_TYPES(MOTLEY_THROUGH_C)

TEST(CInterface, EveryJointInEveryCaseHasTheSameBitsAsThroughCpp)
{
    const JointScene all;
    Both both(all.scene, testing::with_gravity({0, -9.81F, 0}));
    // Away with all joints, which are then added, one by one, through both interfaces.
    std::vector<ConstraintId> old;
    for (std::uint32_t slot = 0; slot < core_of(all.scene).joints->slots.size(); ++slot) {
        if (core_of(all.scene).joints->slots[slot].live == 0) continue;
        old.push_back({slot, core_of(all.scene).joints->slots[slot].generation});
        both.scene.remove_joint(old.back());
        ASSERT_TRUE(done(motley_scene_remove_joint(both.c_scene, as_c<motley_constraint_id>(old.back()))));
    }
    ASSERT_EQ(both.scene.joint_count(), 0U);
    std::vector<ConstraintId> joints;
    core_of(all.scene).joints->for_each([&](const auto& store, int) {
        for (std::size_t i = 0; i < store.size(); ++i) {
            const auto& definition = store.definitions[i];
            motley_constraint_id c{};
            joints.push_back(both.scene.add_joint(definition));
            ASSERT_TRUE(done(add_through_c(both.c_scene, definition, &c)));
            ASSERT_EQ(c.slot, joints.back().slot);
            ASSERT_EQ(c.generation, joints.back().generation);
            if (i % 3 != 0) continue;
            both.scene.set_joint(joints.back(), definition);
            ASSERT_TRUE(done(set_through_c(both.c_scene, c, definition)));
        }
    });
    EXPECT_GT(joints.size(), 500U);
    for (int step = 0; step < steps; ++step) ASSERT_NO_FATAL_FAILURE(both.step());

    std::vector<motley_joint_report> reports(joints.size());
    std::vector<motley_constraint_id> ids(joints.size());
    for (std::size_t i = 0; i < joints.size(); ++i) ids[i] = as_c<motley_constraint_id>(joints[i]);
    ASSERT_TRUE(done(motley_scene_read_joint_reports(both.c_scene, ids.size(), ids.data(), reports.data(),
                                                     sizeof(motley_joint_report))));
    for (std::size_t i = 0; i < joints.size(); ++i) {
        const JointReport report = both.scene.joint_report(joints[i]);
        EXPECT_EQ(reports[i].force.y, report.force.y);
        EXPECT_EQ(reports[i].torque.z, report.torque.z);
        EXPECT_EQ(reports[i].error, report.error);
        EXPECT_EQ(reports[i].angle_error, report.angle_error);
        EXPECT_EQ(reports[i].state, static_cast<motley_joint_state>(report.state));
    }
    motley_scene_errors errors;
    ASSERT_TRUE(done(motley_scene_measure_errors(both.c_scene, &errors)));
    EXPECT_EQ(errors.joint_separation_rms, both.scene.errors().joint_separation_rms);
    EXPECT_GT(errors.joint_separation_max, 0);
}

TEST(CInterface, ContactsOfAListHaveTheSameBitsForEveryMethod)
{
    for (const Method method : {Method::soft_step, Method::sequential_impulse, Method::direct}) {
        MixedScene mixed(7);
        SolverSettings settings = testing::with_gravity({0, -9.81F, 0});
        settings.method = method;
        settings.measures = true;
        settings.exact_joints = method == Method::soft_step;
        Both both(mixed.scene, settings);
        std::vector<Contact> contacts;
        const int steps_of_method = method == Method::direct ? steps / 5 : steps;  // it takes seconds
        for (int step = 0; step < steps_of_method; ++step) {
            mixed.scene = both.scene;
            contacts = mixed.contacts();
            ASSERT_NO_FATAL_FAILURE(both.step(contacts));
        }
        ASSERT_FALSE(contacts.empty());
        const motley_contact_impulse* impulses = nullptr;
        std::size_t count = 0;
        ASSERT_TRUE(done(motley_scene_contact_impulses(both.c_scene, &impulses, &count)));
        const std::span<const ContactImpulse> expected = both.scene.contact_impulses();
        ASSERT_EQ(count, expected.size());
        std::vector<motley_contact> list;
        for (const Contact& contact : contacts) list.push_back(as_c<motley_contact>(contact));
        for (std::size_t i = 0; i < count; ++i) {
            EXPECT_EQ(impulses[i].normal, expected[i].normal);
            EXPECT_EQ(impulses[i].friction.x, expected[i].friction.x);
            motley_joint_report report;
            ASSERT_TRUE(
                done(motley_scene_contact_report(both.c_scene, list.size(), list.data(), i, &report)));
            EXPECT_EQ(report.force.y, both.scene.contact_report(contacts, i).force.y);
        }
    }
}

TEST(CInterface, BodiesOfEveryKindAreTheSame)
{
    Both both{Scene{}};
    for (int kind = 0; kind < 5; ++kind) {
        BodyDefinition cpp;
        motley_body_definition c = motley_default_body_definition();
        if (kind < 3) {
            cpp.model = static_cast<BodyModel>(kind);
            c.model = kind;
        } else {
            cpp.motion = kind == 3 ? BodyMotion::static_body : BodyMotion::kinematic_body;
            c.motion = kind == 3 ? MOTLEY_STATIC_BODY : MOTLEY_KINEMATIC_BODY;
        }
        cpp.position = {1, 2, 3};
        c.position = {1, 2, 3};
        cpp.orientation = {0.5, -0.5, 0.5, 0.7};
        c.orientation = {0.5, -0.5, 0.5, 0.7};
        cpp.yaw = c.yaw = 7;
        cpp.mass = c.mass = 3;
        cpp.inertia = {0.2F, 0.02F, 0.01F, 0.3F, 0.03F, 0.25F};
        c.inertia = {0.2F, 0.02F, 0.01F, 0.3F, 0.03F, 0.25F};
        if (kind != 3) {
            cpp.linear_velocity = {0.5F, 1, 0};
            c.linear_velocity = {0.5F, 1, 0};
        }
        if (kind != 3 && kind != 0) {
            cpp.angular_velocity = {0, 0, 2};
            c.angular_velocity = {0, 0, 2};
        }
        motley_body_id id;
        const BodyId body = both.scene.add_body(cpp);
        ASSERT_TRUE(done(motley_scene_add_body(both.c_scene, &c, &id)));
        motley_body_state state;
        ASSERT_TRUE(done(motley_scene_body_state(both.c_scene, id, &state)));
        const BodyState expected = both.scene.state(body);
        EXPECT_EQ(state.position.z, expected.position.z);
        EXPECT_EQ(state.orientation.y, expected.orientation.y);
        EXPECT_EQ(state.yaw, expected.yaw);
        EXPECT_EQ(state.linear_velocity.y, expected.linear_velocity.y);
        EXPECT_EQ(state.angular_velocity.z, expected.angular_velocity.z);
        if (kind >= 3) continue;
        both.scene.set_force(body, {1, 2, 0}, {0, 0, kind == 0 ? 0.0F : 1.0F});
        ASSERT_TRUE(
            done(motley_scene_set_force(both.c_scene, id, {1, 2, 0}, {0, 0, kind == 0 ? 0.0F : 1.0F})));
    }
    for (int step = 0; step < steps; ++step) ASSERT_NO_FATAL_FAILURE(both.step());
}

TEST(CInterface, APersonBecomesAFigureAndFallsOnAFloorOfCapsules)
{
    Both both(Scene{}, testing::with_gravity({0, 0, -9.81F}));
    motley_body_id id;
    motley_shape_id shape;
    motley_body_definition body = motley_default_body_definition();
    body.model = MOTLEY_PLANAR;
    body.position = {0.1, 0.2, 1};
    const BodyId person = both.scene.add_body({.model = BodyModel::planar, .position = {0.1, 0.2, 1}});
    ASSERT_TRUE(done(motley_scene_add_body(both.c_scene, &body, &id)));
    motley_disc_definition disc = motley_default_disc_definition();
    disc.radius = 0.3F;
    both.scene.set_disc(person, {.radius = 0.3F});
    ASSERT_TRUE(done(motley_scene_set_disc(both.c_scene, id, &disc)));
    for (int step = 0; step < 3; ++step) ASSERT_NO_FATAL_FAILURE(both.step());

    both.scene.clear_disc(person);
    ASSERT_TRUE(done(motley_scene_clear_disc(both.c_scene, id)));
    motley_body_change change = motley_default_body_change();
    change.inertia.xx = 2;
    both.scene.change_body(person, {.model = BodyModel::rigid, .inertia = {2, 0, 0, 1, 0, 1}});
    ASSERT_TRUE(done(motley_scene_change_body(both.c_scene, id, &change)));
    motley_capsule_definition capsule = motley_default_capsule_definition();
    capsule.body = id;
    capsule.from = {-0.3F, 0, 0};
    capsule.to = {0.3F, 0, 0.1F};
    capsule.friction = 0.5F;
    both.scene.add_capsule({.body = person, .from = {-0.3F, 0, 0}, .to = {0.3F, 0, 0.1F}, .friction = 0.5F});
    ASSERT_TRUE(done(motley_scene_add_capsule(both.c_scene, &capsule, &shape)));
    motley_half_space_definition floor = motley_default_half_space_definition();
    floor.friction = 0.5F;
    both.scene.add_half_space({.friction = 0.5F});
    ASSERT_TRUE(done(motley_scene_add_half_space(both.c_scene, &floor, nullptr)));
    for (int step = 0; step < steps; ++step) ASSERT_NO_FATAL_FAILURE(both.step());

    motley_shape_contact contacts[4];
    std::size_t count = 0;
    ASSERT_TRUE(done(motley_scene_shape_contacts(both.c_scene, 4, contacts, &count)));
    const std::vector<ShapeContact> expected = both.scene.shape_contacts();
    ASSERT_EQ(count, expected.size());
    for (std::size_t i = 0; i < count; ++i) {
        EXPECT_EQ(contacts[i].b.slot, id.slot);
        EXPECT_EQ(contacts[i].normal.z, expected[i].normal.z);
        EXPECT_EQ(contacts[i].normal_force, expected[i].normal_force);
    }
    ASSERT_TRUE(done(motley_scene_remove_shape(both.c_scene, shape)));
    motley_bool alive = 1;
    ASSERT_TRUE(done(motley_scene_is_shape_alive(both.c_scene, shape, &alive)));
    EXPECT_EQ(alive, 0);
}

TEST(CInterface, ACrowdOfDiscsHasTheSameBitsAndTheSameContacts)
{
    DiscCrowd crowd({.people = 300, .friction = 0.3F});
    Both both(crowd.scene);
    for (int step = 0; step < steps; ++step) ASSERT_NO_FATAL_FAILURE(both.step());
    const std::vector<DiscContact> expected = both.scene.disc_contacts();
    ASSERT_GT(expected.size(), 10U);
    std::vector<motley_disc_contact> contacts(expected.size());
    std::size_t count = 0;
    ASSERT_TRUE(done(motley_scene_disc_contacts(both.c_scene, 5, contacts.data(), &count)));
    ASSERT_EQ(count, expected.size());
    EXPECT_EQ(contacts[5].normal_force, 0);  // beyond the capacity nothing is written
    ASSERT_TRUE(done(motley_scene_disc_contacts(both.c_scene, count, contacts.data(), &count)));
    for (std::size_t i = 0; i < count; ++i) {
        EXPECT_EQ(contacts[i].a.slot, expected[i].a.slot);
        EXPECT_EQ(contacts[i].wall.generation, expected[i].wall.generation);
        EXPECT_EQ(contacts[i].normal.y, expected[i].normal.y);
        EXPECT_EQ(contacts[i].normal_force, expected[i].normal_force);
        EXPECT_EQ(contacts[i].friction_force, expected[i].friction_force);
    }
}

TEST(CInterface, WheelsAndJointsOfSixCoordinatesMakeTheSameJoints)
{
    Scene two;
    const BodyId a = two.add_body(testing::box({0, 0, 0})), b = two.add_body(testing::box({0.5, 0, 0}));
    Both both(two, testing::with_gravity({0, -9.81F, 0}));
    SixDofDefinition cpp;
    cpp.body_a = a;
    cpp.body_b = b;
    motley_six_dof_definition c = motley_default_six_dof_definition();
    c.body_a = as_c<motley_body_id>(a);
    c.body_b = as_c<motley_body_id>(b);
    cpp.frame_a.position = {0.5F, 0, 0};
    c.frame_a.position = {0.5F, 0, 0};
    cpp.rotation[1] = AxisSetup::limited(-0.3F, 0.4F);
    c.rotation[1].lower = -0.3F;
    c.rotation[1].upper = 0.4F;
    cpp.rotation[2].motor_max_force = c.rotation[2].motor_max_force = 3;
    const std::vector<ConstraintId> expected = add_six_dof(both.scene, cpp);
    motley_constraint_id joints[MOTLEY_SIX_DOF_JOINTS];
    std::size_t count = 0;
    ASSERT_TRUE(done(motley_scene_add_six_dof(both.c_scene, &c, joints, &count)));
    ASSERT_EQ(count, expected.size());
    EXPECT_EQ(joints[count - 1].slot, expected.back().slot);

    const WheelDefinition wheel{.chassis = a, .wheel = b, .position = {0.5F, 0, 0}, .motor_max_torque = 1};
    motley_wheel_definition c_wheel = motley_default_wheel_definition();
    c_wheel.chassis = as_c<motley_body_id>(a);
    c_wheel.wheel = as_c<motley_body_id>(b);
    c_wheel.position = {0.5F, 0, 0};
    c_wheel.motor_max_torque = 1;
    motley_wheel made;
    const Wheel expected_wheel = add_wheel(both.scene, wheel);
    ASSERT_TRUE(done(motley_scene_add_wheel(both.c_scene, &c_wheel, &made)));
    EXPECT_EQ(made.motor.slot, expected_wheel.motor.slot);
    EXPECT_EQ(made.spring.generation, 0U);
    steer(both.scene, expected_wheel, wheel, 0.2F);
    ASSERT_TRUE(done(motley_scene_steer(both.c_scene, &made, &c_wheel, 0.2F)));

    const WeldDefinition weld{
        .body_a = a, .body_b = b, .frame_a = {{0.25F, 0, 0}}, .linear_hertz = 4, .angular_damping_ratio = 3};
    motley_weld_definition c_weld = motley_default_weld_definition();
    c_weld.body_a = as_c<motley_body_id>(a);
    c_weld.body_b = as_c<motley_body_id>(b);
    c_weld.frame_a.position = {0.25F, 0, 0};
    c_weld.linear_hertz = 4;
    c_weld.angular_damping_ratio = 3;
    motley_weld made_weld;
    const Weld expected_weld = add_weld(both.scene, weld);
    ASSERT_TRUE(done(motley_scene_add_weld(both.c_scene, &c_weld, &made_weld)));
    EXPECT_EQ(made_weld.rotation.slot, expected_weld.rotation.slot);
    EXPECT_EQ(made_weld.position.slot, expected_weld.position.slot);
    for (int step = 0; step < steps; ++step) ASSERT_NO_FATAL_FAILURE(both.step());
}

TEST(CInterface, BreakLimitsNameTheSameJoints)
{
    Scene one;
    const BodyId body = one.add_body(testing::box({1, 0, 0}));
    const ConstraintId joint = one.add_joint(BallSocketDefinition{one.ground(), body, {}, {-1, 0, 0}});
    Both both(one, testing::with_gravity({0, -9.81F, 0}));
    ASSERT_TRUE(
        done(motley_scene_set_break_limit(both.c_scene, as_c<motley_constraint_id>(joint), 0.1F, INFINITY)));
    both.scene.set_break_limit(joint, {.force = 0.1F});
    both.step();
    const motley_break_event* events = nullptr;
    std::size_t count = 0;
    ASSERT_TRUE(done(motley_scene_break_events(both.c_scene, &events, &count)));
    ASSERT_EQ(count, 1U);
    EXPECT_EQ(events[0].joint.slot, joint.slot);
    EXPECT_EQ(events[0].force, both.scene.break_events()[0].force);
}

TEST(CInterface, SettingsReadBackAreThoseThatWereSet)
{
    Both both{Scene{}};
    motley_solver_settings settings = motley_default_solver_settings();
    settings.method = MOTLEY_SEQUENTIAL_IMPULSE;
    settings.substeps = 7;
    settings.drift_correction = MOTLEY_DRIFT_PROJECTION;
    settings.warm_start = 0;
    settings.bad_contacts = MOTLEY_SKIP_BAD_CONTACTS;
    settings.penetration_slop = 0.25F;
    ASSERT_TRUE(done(motley_solver_set_settings(both.c_solver, &settings)));
    motley_solver_settings now = motley_default_solver_settings();
    ASSERT_TRUE(done(motley_solver_read_settings(both.c_solver, &now)));
    EXPECT_EQ(std::memcmp(&now, &settings, sizeof now), 0);
}

}  // namespace
}  // namespace motley
