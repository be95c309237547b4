// Spheres, capsules and half-spaces whose contacts the library finds. Independent evidence: closed forms, Newton's third
// law and momentum.
#include <gtest/gtest.h>

#include <cmath>

#include "motley/motley.h"

namespace motley {
namespace {

constexpr float dt = 1.0F / 60;
constexpr float g = 9.81F;

BodyDefinition sphere_at(const Vec3<double>& position, float mass, float radius)
{
    const float moment = 0.4F * mass * radius * radius;
    return {.position = position, .mass = mass, .inertia = {moment, 0, 0, moment, 0, moment}};
}

/// A capsule along x of half length h, with the moments of a rod.
BodyDefinition rod_at(const Vec3<double>& position, float mass, float h, float radius)
{
    const float across = mass * h * h / 3 + 0.4F * mass * radius * radius,
                along = 0.5F * mass * radius * radius;
    return {.position = position, .mass = mass, .inertia = {along, 0, 0, across, 0, across}};
}

void run(Solver& solver, Scene& scene, int steps)
{
    for (int step = 0; step < steps; ++step) {
        const StepReport report = solver.step(scene, dt);
        ASSERT_EQ(report.status, StepStatus::done) << report.error;
    }
}

TEST(Shapes, ABallRestsOnAFloorWithItsWeight)
{
    Scene scene;
    scene.add_half_space({.normal = {0, 0, 2}, .friction = 0.5F});
    const BodyId ball = scene.add_body(sphere_at({3, -2, 0.5}, 7, 0.2F));
    scene.add_capsule({.body = ball, .radius = 0.2F, .friction = 0.5F});
    Solver solver({.gravity = {0, 0, -g}});
    run(solver, scene, 240);
    EXPECT_NEAR(scene.state(ball).position.z, 0.2, 1e-3);
    const std::vector<ShapeContact> contacts = scene.shape_contacts_of(ball);
    ASSERT_EQ(contacts.size(), 1U);
    EXPECT_NEAR(contacts[0].normal_force, 7 * g, 1e-3F * 7 * g);
    EXPECT_EQ(contacts[0].a, scene.ground());
    EXPECT_EQ(contacts[0].b, ball);
    EXPECT_FLOAT_EQ(contacts[0].normal.z, 1);
    BodyLoad load;
    scene.read_loads({&ball, 1}, {}, StridedSpan<BodyLoad>(&load, 1));
    EXPECT_NEAR(load.normal_force, 7 * g, 1e-3F * 7 * g);
    EXPECT_NEAR(load.net_force.z, 7 * g, 1e-3F * 7 * g);
}

/// The contacts join the host's list, so that every method, a tolerance and measures serve them.
TEST(Shapes, EveryMethodServesThem)
{
    SolverSettings impulses, direct, tolerance, exact;
    impulses.method = Method::sequential_impulse;
    direct.method = Method::direct;
    tolerance.tolerance = 1e-4F;
    tolerance.measures = true;
    exact.exact_joints = true;
    for (SolverSettings settings : {impulses, direct, tolerance, exact}) {
        settings.gravity = {0, 0, -g};
        Scene scene;
        scene.add_half_space({.friction = 0.5F});
        const BodyId lying = scene.add_body(rod_at({0, 0, 0.11}, 3, 0.5F, 0.1F));
        scene.add_capsule(
            {.body = lying, .from = {-0.5F, 0, 0}, .to = {0.5F, 0, 0}, .radius = 0.1F, .friction = 0.5F});
        Solver solver(settings);
        run(solver, scene, 240);
        const std::vector<ShapeContact> contacts = scene.shape_contacts();
        ASSERT_EQ(contacts.size(), 2U);
        for (const ShapeContact& contact : contacts) EXPECT_NEAR(contact.normal_force, 1.5F * g, 0.01F * g);
        EXPECT_NEAR(scene.state(lying).position.z, 0.1, 6e-3);
    }
}

/// A solid ball that rolls down a slope of angle t goes s = 5/14 g sin(t) t^2.
TEST(Shapes, ABallRollsDownASlopeWithFiveSeventhsOfItsAcceleration)
{
    constexpr double angle = 0.3;
    Scene scene;
    const Vec3<double> normal{std::sin(angle), 0, std::cos(angle)};
    scene.add_half_space({.normal = convert<float>(normal), .friction = 1});
    const BodyId ball = scene.add_body(sphere_at(0.2 * normal, 2, 0.2F));
    scene.add_capsule({.body = ball, .radius = 0.2F, .friction = 1});
    Solver solver({.gravity = {0, 0, -g}});
    run(solver, scene, 120);
    const Vec3<double> at = scene.state(ball).position;
    const double down = at.x * std::cos(angle) - at.z * std::sin(angle);
    EXPECT_NEAR(down, 5.0 / 14 * 9.81 * std::sin(angle) * 4, 0.01 * 2.07);
    EXPECT_NEAR(dot(at, normal), 0.2, 1e-3);
}

TEST(Shapes, BallsThatMeetHeadOnExchangeTheirVelocities)
{
    Scene scene;
    BodyDefinition one = sphere_at({-1, 0, 0}, 2, 0.3F), other = sphere_at({1, 0, 0}, 2, 0.3F);
    one.linear_velocity = {3, 0, 0};
    other.linear_velocity = {-1, 0, 0};
    const BodyId a = scene.add_body(one), b = scene.add_body(other);
    for (const BodyId body : {a, b}) scene.add_capsule({.body = body, .radius = 0.3F, .restitution = 1});
    Solver solver(SolverSettings{});
    run(solver, scene, 60);
    EXPECT_NEAR(scene.state(a).linear_velocity.x, -1, 1e-4);
    EXPECT_NEAR(scene.state(b).linear_velocity.x, 3, 1e-4);
}

TEST(Shapes, ALyingCapsuleRestsOnBothEnds)
{
    Scene scene;
    scene.add_half_space({.friction = 0.5F});
    const BodyId lower = scene.add_body(rod_at({0, 0, 0.11}, 3, 0.5F, 0.1F));
    const BodyId upper = scene.add_body(rod_at({0.2, 0, 0.32}, 3, 0.5F, 0.1F));
    for (const BodyId body : {lower, upper})
        scene.add_capsule(
            {.body = body, .from = {-0.5F, 0, 0}, .to = {0.5F, 0, 0}, .radius = 0.1F, .friction = 0.5F});
    Solver solver({.gravity = {0, 0, -g}});
    run(solver, scene, 10);
    // One upon the other lies still for a while; it is no stable equilibrium, so it is not run for long.
    const std::vector<ShapeContact> between = scene.shape_contacts_of(upper);
    ASSERT_EQ(between.size(), 2U);
    scene.remove_body(upper);
    run(solver, scene, 240);
    const std::vector<ShapeContact> contacts = scene.shape_contacts();
    ASSERT_EQ(contacts.size(), 2U);
    for (const ShapeContact& contact : contacts) EXPECT_NEAR(contact.normal_force, 1.5F * g, 0.02F * g);
    EXPECT_NEAR(std::abs(contacts[0].arm_b.x), 0.5F, 1e-3F);
    EXPECT_NEAR(scene.state(lower).position.z, 0.1, 1e-3);
}

/// A person seen from above as a capsule across the shoulders, pushed at one shoulder by a small fast ball: linear and
/// angular momentum about the origin stay.
TEST(Shapes, APersonStruckAtOneShoulderTurns)
{
    Scene scene;
    const BodyId person = scene.add_body(
        {.model = BodyModel::planar, .position = {1, 2, 0}, .mass = 80, .inertia = {1, 0, 0, 1, 0, 2.5F}});
    scene.add_capsule({.body = person, .from = {0, -0.2F, 0}, .to = {0, 0.2F, 0}, .radius = 0.12F});
    BodyDefinition thrown{.model = BodyModel::planar, .position = {-1, 2.25, 0}, .mass = 5};
    thrown.linear_velocity = {1.5F, 0, 0};
    const BodyId ball = scene.add_body(thrown);
    scene.add_capsule({.body = ball, .radius = 0.1F});
    const auto momenta = [&] {
        Vec3<double> sum{};
        for (const auto& [body, mass, moment] : {std::tuple{person, 80.0, 2.5}, std::tuple{ball, 5.0, 1.0}}) {
            const BodyState s = scene.state(body);
            const Vec3<double> v = convert<double>(s.linear_velocity);
            sum = sum + Vec3<double>{mass * v.x, mass * v.y,
                                     mass * (s.position.x * v.y - s.position.y * v.x) +
                                         moment * static_cast<double>(s.angular_velocity.z)};
        }
        return sum;
    };
    const Vec3<double> before = momenta();
    Solver solver(SolverSettings{});
    // Contacts keep their arms through a step, in which the ball slides along by 2 mm.
    for (int step = 0; step < 900; ++step) ASSERT_EQ(solver.step(scene, dt / 10).status, StepStatus::done);
    const Vec3<double> after = momenta();
    EXPECT_NEAR(after.x, before.x, 1e-5);
    EXPECT_NEAR(after.y, before.y, 1e-5);
    EXPECT_NEAR(after.z, before.z, 2e-3 * 7.5);
    EXPECT_LT(scene.state(person).angular_velocity.z, -0.02F);
    EXPECT_GT(scene.state(person).linear_velocity.x, 0.02F);
}

/// The torso meets a wall flat: both ends of the stretch bear half of what pushes.
TEST(Shapes, ATorsoPressedFlatAgainstAWallBearsThePush)
{
    Scene scene;
    const Vec2<double> ends[] = {{0, -5}, {0, 5}};
    const WallId wall = scene.add_wall({.points = ends});
    const BodyId person = scene.add_body({.model = BodyModel::planar, .position = {0.13, 0, 0}, .mass = 80});
    scene.add_capsule({.body = person, .from = {0, -0.2F, 0}, .to = {0, 0.2F, 0}, .radius = 0.12F});
    scene.set_force(person, {-500, 0, 0}, {});
    Solver solver(SolverSettings{});
    run(solver, scene, 120);
    const std::vector<ShapeContact> contacts = scene.shape_contacts();
    ASSERT_EQ(contacts.size(), 2U);
    for (const ShapeContact& contact : contacts) {
        EXPECT_NEAR(contact.normal_force, 250, 1);
        EXPECT_EQ(contact.wall, wall);
    }
    EXPECT_NEAR(scene.state(person).yaw, 0, 1e-4);
    scene.remove_wall(wall);
    EXPECT_TRUE(scene.shape_contacts().empty()) << "contacts with a wall that is gone";
    run(solver, scene, 1);
    EXPECT_TRUE(scene.shape_contacts().empty());
}

/// A planar person runs into one who lies on the floor: the push is in the plane, whatever the height, and equal on both.
TEST(Shapes, AWalkerStumblesOverARigidCapsule)
{
    Scene scene;
    scene.add_half_space({});
    const BodyId lying = scene.add_body(rod_at({2, 0, 0.15}, 70, 0.8F, 0.15F));
    scene.set_pose(lying, {2, 0, 0.15}, {0, 0, std::sqrt(0.5), std::sqrt(0.5)}, 0);
    scene.add_capsule({.body = lying, .from = {-0.8F, 0, 0}, .to = {0.8F, 0, 0}, .radius = 0.15F});
    BodyDefinition walker{.model = BodyModel::planar, .position = {0, 0.1, 0}, .mass = 80};
    walker.linear_velocity = {1.5F, 0, 0};
    const BodyId person = scene.add_body(walker);
    scene.set_disc(person, {.radius = 0.2F});
    Solver solver({.gravity = {0, 0, -g}});
    double along = 0;
    bool met = false;
    for (int step = 0; step < 120; ++step) {
        run(solver, scene, 1);
        const double now = 80 * static_cast<double>(scene.state(person).linear_velocity.x) +
                           70 * static_cast<double>(scene.state(lying).linear_velocity.x);
        for (const ShapeContact& contact : scene.shape_contacts_of(person)) {
            met = met || contact.normal_force > 0;
            EXPECT_FLOAT_EQ(contact.normal.z, 0);
            EXPECT_EQ(contact.b, lying);
        }
        along = now;
    }
    EXPECT_TRUE(met);
    EXPECT_NEAR(along, 80 * 1.5, 1e-3 * 80 * 1.5);
    EXPECT_NEAR(scene.state(lying).position.z, 0.15, 2e-3);
}

TEST(Shapes, NothingFastPassesThrough)
{
    for (const float speed : {5.0F, 20.0F, 100.0F, 300.0F}) {
        Scene scene;
        const Vec2<double> ends[] = {{10, -5}, {10, 5}};
        scene.add_wall({.points = ends});
        scene.add_half_space({.point = {0, 0, -10}});
        BodyDefinition obstacle = sphere_at({-10, 0, 0}, 1, 0.5F);
        obstacle.motion = BodyMotion::static_body;
        scene.add_capsule({.body = scene.add_body(obstacle), .radius = 0.5F});
        const auto shoot = [&](const Vec3<float>& velocity) {
            BodyDefinition bullet = sphere_at({0, 0, 0}, 1, 0.1F);
            bullet.linear_velocity = velocity;
            const BodyId body = scene.add_body(bullet);
            scene.add_capsule({.body = body, .radius = 0.1F, .group = 1});
            return body;
        };
        const BodyId at_wall = shoot({speed, 0, 0}), at_floor = shoot({0, 0, -speed}),
                     at_ball = shoot({-speed, 0, 0});
        Solver solver(SolverSettings{});
        for (int step = 0; step < 300; ++step) {
            run(solver, scene, 1);
            ASSERT_LT(scene.state(at_wall).position.x, 10) << speed << " m/s";
            ASSERT_GT(scene.state(at_floor).position.z, -10) << speed << " m/s";
            ASSERT_GT(scene.state(at_ball).position.x, -9.5) << speed << " m/s";
        }
        EXPECT_NEAR(scene.state(at_floor).position.z, -9.9, 0.02);
    }
}

TEST(Shapes, WhatDoesNotMeetDoesNotTouch)
{
    const auto contacts_between = [](const auto& change) {
        Scene scene;
        const BodyId a = scene.add_body(sphere_at({0, 0, 0}, 1, 0.2F)),
                     b = scene.add_body(sphere_at({0.3, 0, 0}, 1, 0.2F));
        CapsuleDefinition one{.body = a, .radius = 0.2F}, other{.body = b, .radius = 0.2F};
        change(scene, one, other);
        scene.add_capsule(one);
        scene.add_capsule(other);
        Solver solver(SolverSettings{});
        const StepReport report = solver.step(scene, dt);
        EXPECT_EQ(report.status, StepStatus::done) << report.error;
        EXPECT_EQ(report.shape_contacts, static_cast<std::int64_t>(scene.shape_contacts().size()));
        return report.shape_contacts;
    };
    EXPECT_EQ(contacts_between([](Scene&, CapsuleDefinition&, CapsuleDefinition&) {}), 1);
    EXPECT_EQ(
        contacts_between([](Scene&, CapsuleDefinition& a, CapsuleDefinition& b) { a.group = b.group = 7; }),
        0);
    EXPECT_EQ(contacts_between(
                  [](Scene&, CapsuleDefinition& a, CapsuleDefinition& b) { a.group = 1, b.group = 2; }),
              1);
    EXPECT_EQ(contacts_between(
                  [](Scene&, CapsuleDefinition& a, CapsuleDefinition&) { a.category = 2, a.mask = 2; }),
              0);
    EXPECT_EQ(contacts_between([](Scene&, CapsuleDefinition& a, CapsuleDefinition&) { a.mask = 2; }), 0);
    EXPECT_EQ(contacts_between([](Scene& scene, CapsuleDefinition& a, CapsuleDefinition& b) {
                  scene.add_joint(BallSocketDefinition{a.body, b.body, {0.15F, 0, 0}, {-0.15F, 0, 0}});
              }),
              0);
    EXPECT_EQ(contacts_between([](Scene&, CapsuleDefinition& a, CapsuleDefinition& b) { b.body = a.body; }),
              0);
}

/// A joint that is added or removed later counts from then on.
TEST(Shapes, AJointKeepsItsBodiesFromTouchingForAsLongAsItLasts)
{
    Scene scene;
    const BodyId a = scene.add_body(sphere_at({0, 0, 0}, 1, 0.2F)),
                 b = scene.add_body(sphere_at({0.4, 0, 0}, 1, 0.2F));
    for (const BodyId body : {a, b}) scene.add_capsule({.body = body, .radius = 0.2F});
    Solver solver(SolverSettings{});
    EXPECT_EQ(solver.step(scene, dt).shape_contacts, 1);
    EXPECT_EQ(solver.step(scene, dt).shape_contacts, 1);
    const ConstraintId joint = scene.add_joint(BallSocketDefinition{a, b, {0.2F, 0, 0}, {-0.2F, 0, 0}});
    EXPECT_EQ(solver.step(scene, dt).shape_contacts, 0);
    EXPECT_EQ(solver.step(scene, dt).shape_contacts, 0);
    scene.remove_joint(joint);
    EXPECT_EQ(solver.step(scene, dt).shape_contacts, 1);
}

/// The host's own contacts act beside those that are found, and its reads are of its own.
TEST(Shapes, TheHostsContactsActBesideThem)
{
    Scene scene;
    scene.add_half_space({});
    const BodyId found = scene.add_body(sphere_at({0, 0, 0.2}, 1, 0.2F)),
                 listed = scene.add_body(sphere_at({5, 0, 0.2}, 1, 0.2F));
    scene.add_capsule({.body = found, .radius = 0.2F});
    Solver solver({.gravity = {0, 0, -g}});
    std::vector<Contact> list;
    for (int step = 0; step < 60; ++step) {
        const double height = scene.state(listed).position.z;
        list = {{.body_a = scene.ground(),
                 .body_b = listed,
                 .key = 9,
                 .normal = {0, 0, 1},
                 .separation = static_cast<float>(height - 0.2),
                 .arm_b = {0, 0, static_cast<float>(-height)}}};
        ASSERT_EQ(solver.step(scene, dt, list).status, StepStatus::done);
    }
    ASSERT_EQ(scene.contact_impulses().size(), 1U);
    EXPECT_NEAR(scene.contact_impulses()[0].normal / dt, g, 0.01F);
    EXPECT_NEAR(scene.contact_report(list, 0).force.z, g, 0.01F);
    EXPECT_THROW((void)scene.contact_report(list, 1), InvalidInput);
    ASSERT_EQ(scene.shape_contacts().size(), 1U);
    EXPECT_NEAR(scene.shape_contacts()[0].normal_force, g, 0.01F);
    BodyLoad loads[2];
    const BodyId both[] = {found, listed};
    scene.read_loads(both, list, StridedSpan<BodyLoad>(loads));
    for (const BodyLoad& load : loads) EXPECT_NEAR(load.normal_force, g, 0.01F);
    list[0].key = std::uint64_t{1} << 63;
    const std::uint64_t hash = scene.state_hash();
    const StepReport report = solver.step(scene, dt, list);
    EXPECT_EQ(report.status, StepStatus::refused);
    EXPECT_NE(report.error.find("contacts[0].key is 9223372036854775808; expected below 2^63"),
              std::string::npos)
        << report.error;
    EXPECT_EQ(scene.state_hash(), hash);
    EXPECT_EQ(scene.shape_contacts().size(), 1U);
}

/// A kinematic platform lifts what lies on it.
TEST(Shapes, APlatformLiftsWhatLiesOnIt)
{
    Scene scene;
    const BodyId platform = scene.add_body(
        {.motion = BodyMotion::kinematic_body, .position = {0, 0, 1}, .linear_velocity = {0.5F, 0, 0.25F}});
    scene.add_half_space({.body = platform, .friction = 1});
    const BodyId box = scene.add_body(sphere_at({0, 0, 1.2}, 4, 0.2F));
    // Three balls: they do not roll.
    for (const Vec3<float> at :
         {Vec3<float>{0.3F, 0, 0}, Vec3<float>{-0.2F, 0.3F, 0}, Vec3<float>{-0.2F, -0.3F, 0}})
        scene.add_capsule({.body = box, .from = at, .to = at, .radius = 0.2F, .friction = 1});
    Solver solver({.gravity = {0, 0, -g}});
    run(solver, scene, 240);
    const BodyState state = scene.state(box);
    EXPECT_NEAR(state.position.z, 2.2, 2e-3);
    EXPECT_NEAR(state.linear_velocity.x, 0.5, 1e-3);
    EXPECT_NEAR(state.linear_velocity.z, 0.25, 1e-3);
}

/// A walker with a capsule stumbles: what was pushed in the plane falls, and lies on the floor on its capsule.
TEST(Shapes, StayOnABodyThatGetsAnotherModel)
{
    Scene scene;
    scene.add_half_space({.friction = 0.5F});
    const Vec2<double> ends[] = {{1, -5}, {1, 5}};
    scene.add_wall({.points = ends});
    BodyDefinition walker{.model = BodyModel::planar, .position = {0, 0, 1}, .mass = 70};
    walker.linear_velocity = {3, 0, 0};
    const BodyId person = scene.add_body(walker);
    scene.add_capsule(
        {.body = person, .from = {0, -0.3F, 0}, .to = {0, 0.3F, 0}, .radius = 0.15F, .friction = 0.5F});
    Solver solver({.gravity = {0, 0, -g}});
    run(solver, scene, 60);
    EXPECT_LE(scene.state(person).position.x, 0.851);
    EXPECT_NEAR(scene.state(person).position.z, 1, 1e-12) << "a planar body does not fall";
    scene.change_body(person, {BodyModel::rigid, {4, 0, 0, 1, 0, 4}});
    run(solver, scene, 180);
    EXPECT_NEAR(scene.state(person).position.z, 0.15, 2e-3);
    EXPECT_GE(scene.shape_contacts_of(person).size(), 2U) << "it lies on both ends";
    BodyLoad load;
    scene.read_loads({&person, 1}, {}, StridedSpan<BodyLoad>(&load, 1));
    EXPECT_NEAR(load.net_force.z, 70 * g, 1);
    EXPECT_THROW(scene.change_body(person, {BodyModel::particle, {}}), InvalidInput)
        << "its capsule has ends";
}

/// What lies on a floor falls asleep, still bears its weight, and wakes when a ball rolls into it.
TEST(Shapes, SleepAndWakeByTheirContacts)
{
    Scene scene;
    scene.add_half_space({.friction = 0.5F});
    const BodyId lying = scene.add_body(rod_at({0, 0, 0.1}, 5, 0.5F, 0.1F));
    scene.add_capsule(
        {.body = lying, .from = {-0.5F, 0, 0}, .to = {0.5F, 0, 0}, .radius = 0.1F, .friction = 0.5F});
    SolverSettings settings;
    settings.gravity = {0, 0, -g};
    settings.sleep_speed = 0.01F;
    Solver solver(settings);
    run(solver, scene, 120);
    ASSERT_TRUE(scene.is_asleep(lying));
    BodyLoad load;
    scene.read_loads({&lying, 1}, {}, StridedSpan<BodyLoad>(&load, 1));
    EXPECT_NEAR(load.net_force.z, 5 * g, 0.01F * 5 * g);
    BodyDefinition thrown = sphere_at({0, -2, 0.1}, 2, 0.1F);
    thrown.linear_velocity = {0, 2, 0};
    const BodyId ball = scene.add_body(thrown);
    scene.add_capsule({.body = ball, .radius = 0.1F});
    const auto momentum = [&] {
        return 5 * scene.state(lying).linear_velocity.y + 2 * scene.state(ball).linear_velocity.y;
    };
    for (int step = 0; step < 70 && scene.is_asleep(lying); ++step) {
        EXPECT_NEAR(momentum(), 4, 1e-5F);
        run(solver, scene, 1);
    }
    EXPECT_FALSE(scene.is_asleep(lying));
    EXPECT_GT(scene.state(ball).position.y, -0.25) << "it woke long before the ball came";
    run(solver, scene, 4);
    EXPECT_GT(scene.state(lying).linear_velocity.y, 0.05F);
}

TEST(Shapes, LeaveWithTheirBodies)
{
    Scene scene;
    const BodyId platform = scene.add_body({.motion = BodyMotion::kinematic_body});
    const ShapeId floor = scene.add_half_space({.body = platform});
    const BodyId ball = scene.add_body(sphere_at({0, 0, 0.2}, 4, 0.2F)),
                 other = scene.add_body(sphere_at({1, 0, 0.2}, 4, 0.2F));
    const ShapeId first = scene.add_capsule({.body = ball, .radius = 0.2F}),
                  second = scene.add_capsule({.body = other, .radius = 0.2F});
    Solver solver({.gravity = {0, 0, -g}});
    run(solver, scene, 2);
    scene.remove_body(ball);
    EXPECT_FALSE(scene.is_alive(first));
    EXPECT_TRUE(scene.is_alive(second));
    EXPECT_EQ(scene.shape_contacts().size(), 1U);
    run(solver, scene, 1);
    EXPECT_EQ(scene.shape_contacts_of(other).size(), 1U);
    scene.remove_body(platform);
    EXPECT_FALSE(scene.is_alive(floor));
    run(solver, scene, 1);
    EXPECT_TRUE(scene.shape_contacts().empty());
    scene.remove_shape(second);
    EXPECT_FALSE(scene.is_alive(second));
    EXPECT_THROW(scene.remove_shape(second), InvalidInput);
    const ShapeId next = scene.add_capsule({.body = other, .radius = 0.2F});
    EXPECT_NE(next, second);
}

}  // namespace
}  // namespace motley
