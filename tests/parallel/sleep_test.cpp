// Islands at rest: when they fall asleep, what they keep, and what wakes them (core/src/scene/sleep.h). Independent
// evidence: closed forms of friction, weight and collision, and the same scene with nobody asleep.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "disc_crowd.h"
#include "motley/core/snapshot.h"
#include "rig.h"

namespace motley {
namespace {

using testing::DiscCrowd;
using testing::person_at;

constexpr float dt = 1.0F / 60;
constexpr float radius = 0.2F;

SolverSettings sleepy(float speed = 0.01F, float after = 0.5F)
{
    SolverSettings settings;
    settings.sleep_speed = speed;
    settings.sleep_after = after;
    return settings;
}

void step(Solver& solver, Scene& scene, int steps = 1, std::span<const Contact> contacts = {})
{
    for (int i = 0; i < steps; ++i) {
        const StepReport report = solver.step(scene, dt, contacts);
        ASSERT_EQ(report.status, StepStatus::done) << report.error;
    }
}

/// Steps until a body sleeps, at most `most` times. Returns how often.
int steps_until_asleep(Solver& solver, Scene& scene, BodyId body, int most = 2000)
{
    int steps = 0;
    for (; steps < most && !scene.is_asleep(body); ++steps) step(solver, scene);
    return steps;
}

/// People in a row along x who are pressed against a wall at x = 0 by a force on the last one, N.
struct PressedRow {
    Scene scene;
    std::vector<BodyId> people;
    WallId wall;
    explicit PressedRow(int count = 5, float force = 400)
    {
        const Vec2<double> ends[] = {{0, -5}, {0, 5}};
        wall = scene.add_wall({.points = ends});
        const double gap = 1e-4;
        for (int i = 0; i < count; ++i)
            people.push_back(
                scene.add_body(person_at(static_cast<double>(radius) * (2 * i + 1) + gap * (i + 1), 0)));
        const std::vector<DiscDefinition> discs(people.size(), DiscDefinition{radius});
        scene.set_discs(people, std::span<const DiscDefinition>(discs));
        press(force);
    }
    void press(float force) { scene.set_force(people.back(), {-force, 0, 0}, {}); }
    [[nodiscard]] bool is_anyone(bool asleep) const
    {
        for (const BodyId body : people) {
            if (scene.is_asleep(body) == asleep) return true;
        }
        return false;
    }
};

/// Balls in a column on the ground, with a list of their contacts that follows their places.
struct Column {
    Scene scene;
    BodyId floor;
    std::vector<BodyId> balls;
    static constexpr double size = 0.5;
    explicit Column(int count = 4)
    {
        BodyDefinition ground;
        ground.motion = BodyMotion::kinematic_body;
        floor = scene.add_body(ground);
        for (int i = 0; i < count; ++i) {
            BodyDefinition ball;
            ball.mass = 2;
            ball.position = {0, size * (2 * i + 1), 0};
            balls.push_back(scene.add_body(ball));
        }
    }
    [[nodiscard]] std::vector<Contact> contacts() const
    {
        std::vector<Contact> list;
        for (std::size_t i = 0; i < balls.size(); ++i) {
            if (!scene.is_alive(balls[i])) continue;
            const bool on_floor = i == 0;
            if (!on_floor && !scene.is_alive(balls[i - 1])) continue;
            const double below =
                on_floor ? scene.state(floor).position.y - size : scene.state(balls[i - 1]).position.y;
            Contact contact;
            contact.body_a = on_floor ? floor : balls[i - 1];
            contact.body_b = balls[i];
            contact.key = i + 1;
            contact.normal = {0, 1, 0};
            contact.separation = static_cast<float>(scene.state(balls[i]).position.y - below - 2 * size);
            if (!on_floor) contact.arm_a = {0, static_cast<float>(size), 0};
            contact.arm_b = {0, -static_cast<float>(size), 0};
            list.push_back(contact);
        }
        return list;
    }
    SolverSettings settings() const
    {
        SolverSettings s = sleepy();
        s.gravity = {0, -10, 0};
        return s;
    }
    void step(Solver& solver, int steps = 1)
    {
        for (int i = 0; i < steps; ++i) motley::step(solver, scene, 1, contacts());
    }
    [[nodiscard]] bool all(bool asleep) const
    {
        for (const BodyId ball : balls) {
            if (scene.is_alive(ball) && scene.is_asleep(ball) != asleep) return false;
        }
        return true;
    }
};

TEST(Sleep, IsOffByDefault)
{
    Scene scene;
    const BodyId body = scene.add_body({});
    Solver solver;
    step(solver, scene, 300);
    EXPECT_FALSE(scene.is_asleep(body));
}

TEST(Sleep, ABodyAtRestFallsAsleepAtTheStatedTime)
{
    for (const float after : {0.0F, 0.2F, 0.5F, 1.5F}) {
        Scene scene;
        const BodyId body = scene.add_body({});
        Solver solver(sleepy(0.01F, after));
        const int expected = std::max(1, static_cast<int>(std::lround(after / dt)));
        EXPECT_EQ(steps_until_asleep(solver, scene, body), expected) << after << " s";
    }
}

/// A disc that rubs along a wall with mu F / m slows down from v to the speed of sleep after (v - speed) m / (mu F). Its
/// spin is held by inertia: without a torque it would begin to roll.
TEST(Sleep, ABodyThatSlowsByFrictionFallsAsleepOnceItHasBeenSlow)
{
    Scene scene;
    BodyDefinition floor;
    floor.motion = BodyMotion::static_body;
    const BodyId ground = scene.add_body(floor);
    BodyDefinition block;
    block.model = BodyModel::particle;
    block.mass = 3;
    block.linear_velocity = {1, 0, 0};
    const BodyId body = scene.add_body(block);
    Contact contact;
    contact.body_a = ground;
    contact.body_b = body;
    contact.key = 1;
    contact.normal = {0, 1, 0};
    contact.friction = 0.2F;
    SolverSettings settings = sleepy(0.01F, 0.5F);
    settings.gravity = {0, -10, 0};
    Solver solver(settings);
    int steps = 0;
    for (; steps < 1000 && !scene.is_asleep(body); ++steps) {
        contact.separation = static_cast<float>(scene.state(body).position.y);
        step(solver, scene, 1, {&contact, 1});
    }
    const double slows = (1 - 0.01) / (0.2 * 10);  // s
    EXPECT_NEAR(steps * static_cast<double>(dt), slows + 0.5, 3 * static_cast<double>(dt));
    EXPECT_NEAR(scene.state(body).position.x, 1.0 / (2 * 0.2 * 10), 0.01);
}

TEST(Sleep, ASpinningBodyIsNotAtRest)
{
    // The root mean square speed of a disc of radius r that turns at w is w r / sqrt(2).
    for (const double share : {0.9, 1.1}) {
        Scene scene;
        BodyDefinition disc = person_at(0, 0, 80, radius);
        disc.angular_velocity.z = static_cast<float>(share * 0.01 * std::sqrt(2.0) / 0.2);
        const BodyId body = scene.add_body(disc);
        BodyDefinition ball;
        ball.mass = 2;
        ball.inertia = {0.02F, 0, 0, 0.02F, 0, 0.02F};  // radius of gyration 0.1 m
        ball.angular_velocity = {0, static_cast<float>(share * 0.01 / 0.1), 0};
        const BodyId rigid = scene.add_body(ball);
        Solver solver(sleepy());
        step(solver, scene, 60);
        EXPECT_EQ(scene.is_asleep(body), share < 1);
        EXPECT_EQ(scene.is_asleep(rigid), share < 1);
    }
}

TEST(Sleep, APressedRowFallsAsleepWholeAndBearsItsLoad)
{
    PressedRow row(5, 400);
    Solver solver(sleepy());
    ASSERT_LT(steps_until_asleep(solver, row.scene, row.people[0]), 1000);
    EXPECT_FALSE(row.is_anyone(false)) << "an island falls asleep as a whole";
    const auto loads_of = [&] {
        std::vector<BodyLoad> loads(row.people.size());
        row.scene.read_loads(row.people, {}, std::span(loads));
        return loads;
    };
    const std::vector<BodyLoad> at_first = loads_of();
    const std::uint64_t hash = row.scene.state_hash();
    const std::vector<DiscContact> contacts = row.scene.disc_contacts();
    EXPECT_EQ(contacts.size(), row.people.size());
    for (const DiscContact& contact : contacts) EXPECT_NEAR(contact.normal_force, 400, 4);
    step(solver, row.scene, 500);
    EXPECT_EQ(row.scene.state_hash(), hash) << "sleepers stay put to the bit";
    const std::vector<BodyLoad> later = loads_of();
    for (std::size_t i = 0; i < later.size(); ++i) {
        EXPECT_EQ(later[i].normal_force, at_first[i].normal_force);
        EXPECT_NEAR(later[i].normal_force, i + 1 < later.size() ? 800 : 400, 8);
    }
    EXPECT_EQ(row.scene.disc_contacts().size(), contacts.size());
}

TEST(Sleep, ARestingColumnReportsItsWeight)
{
    Column column;
    Solver solver(column.settings());
    column.step(solver, 400);
    ASSERT_TRUE(column.all(true));
    const std::vector<Contact> contacts = column.contacts();
    const std::uint64_t hash = column.scene.state_hash();
    for (const float seconds : {dt, dt / 2, 1.3F * dt}) {
        for (int i = 0; i < 3; ++i)
            ASSERT_EQ(solver.step(column.scene, seconds, contacts).status, StepStatus::done);
        for (std::size_t i = 0; i < column.balls.size(); ++i) {
            const double weight = 2.0 * 10 * static_cast<double>(column.balls.size() - i);
            const double force =
                static_cast<double>(column.scene.contact_impulses()[i].normal / column.scene.last_step());
            EXPECT_NEAR(force, weight, 0.02 * weight) << "in steps of " << seconds;
            EXPECT_NEAR(column.scene.contact_report(contacts, i).force.y, weight, 0.02 * weight);
        }
    }
    EXPECT_EQ(column.scene.state_hash(), hash);
}

TEST(Sleep, FilesKeepWhoSleepsAndWhatTheyBear)
{
    Column column;
    Solver solver(column.settings());
    column.step(solver, 400);
    const std::vector<Contact> contacts = column.contacts();
    Scene read = load_scene(save_scene(column.scene));
    for (const BodyId ball : column.balls) EXPECT_TRUE(read.is_asleep(ball));
    step(solver, read, 2, contacts);
    step(solver, column.scene, 2, contacts);
    EXPECT_EQ(read.state_hash(), column.scene.state_hash());
    EXPECT_GT(read.contact_impulses()[0].normal, 0);
    EXPECT_EQ(read.contact_impulses()[0].normal, column.scene.contact_impulses()[0].normal);
    // The file remembers which contacts bore them.
    Scene again = load_scene(save_scene(column.scene));
    step(solver, again, 1, std::span(contacts).subspan(1));
    for (const BodyId ball : column.balls) EXPECT_FALSE(again.is_asleep(ball));
}

TEST(Sleep, AJointOfSleepersReportsWhatItBears)
{
    Scene scene;
    BodyDefinition ball;
    ball.mass = 3;
    ball.position = {0, -1, 0};
    const BodyId body = scene.add_body(ball);
    const ConstraintId joint =
        scene.add_joint(BallSocketDefinition{scene.ground(), body, {0, 0, 0}, {0, 1, 0}});
    SolverSettings settings = sleepy();
    settings.gravity = {0, -10, 0};
    Solver solver(settings);
    ASSERT_LT(steps_until_asleep(solver, scene, body), 300);
    for (const float seconds : {dt, dt / 2}) {
        ASSERT_EQ(solver.step(scene, seconds).status, StepStatus::done);
        EXPECT_NEAR(scene.joint_report(joint).force.y, 30, 0.3);
    }
}

TEST(Sleep, AJointThatChangesAndAHandThatMovesWake)
{
    const auto joint_of = [](BodyId hand, BodyId ball, float arm) {
        return BallSocketDefinition{hand, ball, {0, 0, 0}, {0, arm, 0}};
    };
    for (const char* name : {"set_joint", "remove_joint", "the hand moves", "the hand is set elsewhere"}) {
        Scene scene;
        BodyDefinition hand;
        hand.motion = BodyMotion::kinematic_body;
        const BodyId above = scene.add_body(hand);
        BodyDefinition ball;
        ball.position = {0, -1, 0};
        const BodyId body = scene.add_body(ball);
        const ConstraintId joint = scene.add_joint(joint_of(above, body, 1));
        SolverSettings settings = sleepy();
        settings.gravity = {0, -10, 0};
        Solver solver(settings);
        ASSERT_LT(steps_until_asleep(solver, scene, body), 300);
        const std::string what = name;
        const Vec3<double> before = scene.state(body).position;
        if (what == "set_joint") scene.set_joint(joint, joint_of(above, body, 1.1F));
        if (what == "remove_joint") scene.remove_joint(joint);
        if (what == "the hand moves") scene.set_velocity(above, {0.1F, 0, 0}, {});
        if (what == "the hand is set elsewhere") scene.set_pose(above, {0.1, 0, 0}, {0, 0, 0, 1}, 0);
        step(solver, scene);
        EXPECT_FALSE(scene.is_asleep(body)) << name;
        const Vec3<double> moved = scene.state(body).position - before;
        EXPECT_GT(std::sqrt(dot(moved, moved)), 1e-4) << name;
    }
}

/// As WhoHitsASleeperKeepsMomentum, with a ball of a host's list.
TEST(Sleep, AListedContactThatIsAboutToTouchWakes)
{
    Scene scene;
    BodyDefinition ball;
    ball.mass = 2;
    const BodyId sleeper = scene.add_body(ball);
    ball.mass = 3;
    ball.position.x = -1.5;
    const BodyId other = scene.add_body(ball);
    Solver solver(sleepy());
    ASSERT_LT(steps_until_asleep(solver, scene, other), 100);
    ASSERT_TRUE(scene.is_asleep(sleeper));
    scene.set_velocity(other, {2, 0, 0}, {});
    for (int i = 0; i < 40; ++i) {
        Contact contact;
        contact.body_a = other;
        contact.body_b = sleeper;
        contact.key = 1;
        contact.normal = {1, 0, 0};
        const double gap = scene.state(sleeper).position.x - scene.state(other).position.x - 1;
        contact.separation = static_cast<float>(gap);
        contact.arm_a = {0.5F, 0, 0};
        contact.arm_b = {-0.5F, 0, 0};
        const bool reaches = gap <= 0.001 + 2.0 / 60;
        step(solver, scene, 1, {&contact, 1});
        EXPECT_TRUE(!reaches || !scene.is_asleep(sleeper)) << "step " << i;
        const double momentum = 2 * static_cast<double>(scene.state(sleeper).linear_velocity.x) +
                                3 * static_cast<double>(scene.state(other).linear_velocity.x);
        ASSERT_NEAR(momentum, 6, 1e-5) << "step " << i;
    }
    EXPECT_GT(scene.state(sleeper).linear_velocity.x, 1);
}

TEST(Sleep, ASleeperKeepsNobodyAwakeWhoStandsBesideIt)
{
    // A millimetre and a half is more than what wakes, and less than what ties an island.
    Scene scene;
    Solver solver(sleepy());
    const BodyId first = scene.add_body(person_at(0, 0));
    scene.set_disc(first, {radius});
    EXPECT_LT(steps_until_asleep(solver, scene, first), 60);
    const BodyId second = scene.add_body(person_at(2 * static_cast<double>(radius) + 0.0015, 0));
    scene.set_disc(second, {radius});
    EXPECT_LT(steps_until_asleep(solver, scene, second), 60);
    EXPECT_TRUE(scene.is_asleep(first));
}

TEST(Sleep, NobodySleepsWhileAnIslandMateMoves)
{
    // A chain of rods hangs at rest from a body that turns in its socket for longer than sleep_after.
    Scene scene;
    std::vector<BodyId> chain;
    BodyId above = scene.ground();
    for (int i = 0; i < 4; ++i) {
        BodyDefinition ball;
        ball.position = {0, -1.0 * (i + 1), 0};
        chain.push_back(scene.add_body(ball));
        scene.add_joint(BallSocketDefinition{
            above, chain.back(), {0, i == 0 ? 0.0F : -0.5F, 0}, {0, i == 0 ? 1.0F : 0.5F, 0}});
        above = chain.back();
    }
    SolverSettings settings = sleepy();
    settings.gravity = {0, -10, 0};
    Solver solver(settings);
    for (int i = 0; i < 200; ++i) {
        scene.set_velocity(chain.back(), {}, {0, 1, 0});
        step(solver, scene);
        for (const BodyId body : chain) ASSERT_FALSE(scene.is_asleep(body)) << "step " << i;
    }
    scene.set_velocity(chain.back(), {}, {});
    step(solver, scene, 100);
    for (const BodyId body : chain) EXPECT_TRUE(scene.is_asleep(body));
}

/// What wakes the row: one line a cause.
struct Cause {
    const char* name;
    std::function<void(PressedRow&)> happens;
    bool at_once;  ///< or when the next step begins
};

TEST(Sleep, EveryCauseWakesTheWholeIsland)
{
    const auto behind = [](const PressedRow& row) {
        return row.scene.state(row.people.back()).position.x + 2 * static_cast<double>(radius);
    };
    const std::vector<Cause> causes = {
        {"wake", [](PressedRow& row) { row.scene.wake(row.people[2]); }, true},
        {"a push", [](PressedRow& row) { row.press(500); }, false},
        {"a torque",
         [](PressedRow& row) {
             row.scene.set_force(row.people[1], {}, {0, 0, 1});
         },
         false},
        {"a speed",
         [](PressedRow& row) {
             row.scene.set_velocity(row.people[2], {0.1F, 0, 0}, {});
         },
         false},
        {"a pose",
         [](PressedRow& row) {
             row.scene.set_pose(row.people[2], {5, 5, 0}, {0, 0, 0, 1}, 0);
         },
         true},
        {"a mass",
         [](PressedRow& row) {
             row.scene.set_mass(row.people[2], 60, {0, 0, 0, 0, 0, 1.2F});
         },
         true},
        {"damping", [](PressedRow& row) { row.scene.set_damping(row.people[2], 1, 1); }, true},
        {"a disc", [](PressedRow& row) { row.scene.set_disc(row.people[2], {0.21F}); }, true},
        {"no disc", [](PressedRow& row) { row.scene.clear_disc(row.people[2]); }, true},
        {"a neighbour gone", [](PressedRow& row) { row.scene.remove_body(row.people[2]); }, true},
        {"a joint",
         [](PressedRow& row) {
             row.scene.add_joint(DistanceDefinition{.body_a = row.people[0], .body_b = row.people[1]});
         },
         true},
        {"a wall gone", [](PressedRow& row) { row.scene.remove_wall(row.wall); }, true},
        {"a new wall",
         [](PressedRow& row) {
             const Vec2<double> ends[] = {{-1, 0.15}, {9, 0.15}};
             row.scene.add_wall({.points = ends});
         },
         true},
        {"a person who walks into them",
         [&](PressedRow& row) {
             BodyDefinition person = person_at(behind(row) + 0.02, 0);
             person.linear_velocity.x = -1.5F;
             row.scene.set_disc(row.scene.add_body(person), {radius});
         },
         false},
    };
    for (const Cause& cause : causes) {
        PressedRow row;
        Solver solver(sleepy());
        ASSERT_LT(steps_until_asleep(solver, row.scene, row.people[0]), 1000);
        step(solver, row.scene, 3);
        cause.happens(row);
        std::erase_if(row.people, [&](BodyId body) { return !row.scene.is_alive(body); });
        EXPECT_TRUE(!cause.at_once || !row.is_anyone(true)) << cause.name;
        for (int i = 0; i < 3 && row.is_anyone(true); ++i) step(solver, row.scene);
        EXPECT_FALSE(row.is_anyone(true)) << cause.name;
    }
}

TEST(Sleep, SettingsWake)
{
    for (const bool falls : {true, false}) {
        Column column;
        Solver solver(column.settings());
        column.step(solver, 400);
        ASSERT_TRUE(column.all(true));
        SolverSettings settings = column.settings();
        if (falls) {
            settings.gravity.y = -9;
        } else {
            settings.sleep_speed = 0;
        }
        solver.set_settings(settings);
        column.step(solver);
        EXPECT_TRUE(column.all(false));
    }
}

TEST(Sleep, WhatBearsThemWakesThemWhenItMovesOrGoes)
{
    const std::vector<std::pair<const char*, std::function<void(Column&)>>> causes = {
        {"the floor sinks",
         [](Column& c) {
             c.scene.set_velocity(c.floor, {0, -0.01F, 0}, {});
         }},
        {"the floor is moved",
         [](Column& c) {
             c.scene.set_pose(c.floor, {0, -1, 0}, {0, 0, 0, 1}, 0);
         }},
        {"the floor is gone", [](Column& c) { c.scene.remove_body(c.floor); }},
        {"the lowest is gone", [](Column& c) { c.scene.remove_body(c.balls[0]); }},
    };
    for (const auto& [name, happens] : causes) {
        Column column;
        Solver solver(column.settings());
        column.step(solver, 400);
        ASSERT_TRUE(column.all(true));
        happens(column);
        for (int i = 0; i < 2; ++i) {
            std::vector<Contact> contacts;
            if (column.scene.is_alive(column.floor)) contacts = column.contacts();
            step(solver, column.scene, 1, contacts);
        }
        EXPECT_TRUE(column.all(false)) << name;
    }
    Column column;
    Solver solver(column.settings());
    column.step(solver, 400);
    std::vector<Contact> contacts = column.contacts();
    contacts.erase(contacts.begin());
    step(solver, column.scene, 1, contacts);
    EXPECT_TRUE(column.all(false)) << "a contact that pushed is not listed";
}

TEST(Sleep, AWallThatMovesWakesThem)
{
    PressedRow row;
    BodyDefinition door;
    door.motion = BodyMotion::kinematic_body;
    door.position = {0, 1, 0};
    const BodyId body = row.scene.add_body(door);
    const Vec2<double> ends[] = {{-1, 0}, {3, 0}};
    row.scene.add_wall({.points = ends, .body = body});
    Solver solver(sleepy());
    ASSERT_LT(steps_until_asleep(solver, row.scene, row.people[0]), 1000);
    row.scene.set_velocity(body, {0, -0.5F, 0}, {});
    int steps = 0;
    for (; steps < 200 && !row.is_anyone(false); ++steps) step(solver, row.scene);
    // It has 0.8 m to go at 0.5 m/s until it touches them.
    EXPECT_NEAR(steps * static_cast<double>(dt), 0.8 / 0.5, 2 * static_cast<double>(dt));
    EXPECT_FALSE(row.is_anyone(true));
}

/// Who walks into a sleeper pushes a body that moves: both together keep their momentum.
TEST(Sleep, WhoHitsASleeperKeepsMomentum)
{
    for (const double gap : {0.001, 0.01, 0.5}) {
        Scene scene;
        const BodyId sleeper = scene.add_body(person_at(0, 0, 60));
        scene.set_disc(sleeper, {radius});
        Solver solver(sleepy());
        ASSERT_LT(steps_until_asleep(solver, scene, sleeper), 100);
        BodyDefinition walker = person_at(-2 * static_cast<double>(radius) - gap - 0.05, 0, 80);
        walker.linear_velocity.x = 2;
        const BodyId other = scene.add_body(walker);
        scene.set_disc(other, {radius});
        for (int i = 0; i < 60; ++i) {
            step(solver, scene);
            const double momentum = 60 * static_cast<double>(scene.state(sleeper).linear_velocity.x) +
                                    80 * static_cast<double>(scene.state(other).linear_velocity.x);
            ASSERT_NEAR(momentum, 160, 1e-4) << "step " << i << ", gap " << gap;
        }
        EXPECT_FALSE(scene.is_asleep(sleeper));
        EXPECT_GT(scene.state(sleeper).linear_velocity.x, 1) << "it was pushed";
    }
}

TEST(Sleep, TheSameForceInEveryStepWakesNobody)
{
    PressedRow row(5, 400);
    Solver solver(sleepy());
    ASSERT_LT(steps_until_asleep(solver, row.scene, row.people[0]), 1000);
    for (int i = 0; i < 50; ++i) {
        // The threshold is a change of 0.01 m/s2, which is 0.8 N on 80 kg.
        row.press(i % 2 == 0 ? 400.0F : 400.7F);
        for (const BodyId body : row.people) row.scene.set_velocity(body, {}, {});
        step(solver, row.scene);
        ASSERT_FALSE(row.is_anyone(false)) << "step " << i;
    }
    // A force that creeps away wakes them once it has gone that far, however small its steps are.
    int steps = 0;
    for (; steps < 100 && !row.is_anyone(false); ++steps) {
        row.press(400 + 0.1F * static_cast<float>(steps));
        step(solver, row.scene);
    }
    EXPECT_EQ(steps, 10);  // the tenth has 400.9 N
}

/// A crowd that stops within half a second, as a host would steer it, and of which some are pushed now and then: so some
/// sleep while others move.
std::vector<std::uint64_t> run_shaken(DiscCrowd crowd, const SolverOptions& options, bool through_files,
                                      std::int64_t& most_asleep)
{
    Solver solver(sleepy(0.05F, 0.2F), options);
    std::vector<std::uint64_t> hashes;
    for (int i = 0; i < 240; ++i) {
        std::vector<Vec3<float>> forces(crowd.people.size());
        crowd.scene.read_velocities(crowd.people, std::span(forces));
        for (Vec3<float>& force : forces) force = -160.0F * force;
        crowd.scene.set_forces(crowd.people, std::span<const Vec3<float>>(forces));
        if (i % 60 == 59) {
            for (std::size_t k = 0; k < crowd.people.size(); k += 97)
                crowd.scene.set_velocity(crowd.people[k], {1, k % 2 == 0 ? 0.5F : -0.5F, 0}, {});
        }
        const StepReport report = solver.step(crowd.scene, dt);
        EXPECT_EQ(report.status, StepStatus::done) << report.error;
        most_asleep = std::max(most_asleep, report.bodies_asleep);
        hashes.push_back(crowd.scene.state_hash());
        if (through_files && i % 50 == 7) crowd.scene = load_scene(save_scene(crowd.scene));
        if (through_files && i % 50 == 20) crowd.scene = Scene(crowd.scene);
        if (through_files && i % 50 == 35) crowd.scene.renumber_bodies();
    }
    return hashes;
}

TEST(Sleep, BitsAreEqualForAnyInstructionSetThreadsFilesAndOrderOfRows)
{
    DiscCrowd crowd({.people = 600, .friction = 0.4F, .speed = 0.3F});
    std::int64_t most_asleep = 0;
    const std::vector<std::uint64_t> expected =
        run_shaken(crowd, {.threads = 1, .isa = Isa::scalar}, false, most_asleep);
    EXPECT_GT(most_asleep, 100) << "the test needs sleepers";
    for (const Isa isa : available_isas())
        EXPECT_EQ(run_shaken(crowd, {.threads = 1, .isa = isa}, false, most_asleep), expected)
            << isa_name(isa);
    EXPECT_EQ(run_shaken(crowd, {.threads = 2, .alone_below = 0}, false, most_asleep), expected);
    EXPECT_EQ(run_shaken(crowd, {.threads = 1}, true, most_asleep), expected);
}

/// Who sleeps beside a crowd that moves stays put, and is not lost when the contacts of all are found anew.
TEST(Sleep, ASleepingCrowdBesideAMovingOneStaysPut)
{
    PressedRow row(20, 400);
    std::vector<BodyId> moving;
    for (int i = 0; i < 100; ++i) {
        BodyDefinition person = person_at(30 + 0.6 * (i % 10), 0.6 * static_cast<double>(i / 10));
        person.linear_velocity = {i % 2 == 0 ? 0.4F : -0.4F, i % 3 == 0 ? 0.4F : -0.4F, 0};
        moving.push_back(row.scene.add_body(person));
        row.scene.set_disc(moving.back(), {radius});
    }
    Solver solver(sleepy());
    ASSERT_LT(steps_until_asleep(solver, row.scene, row.people[0]), 1000);
    const std::size_t people = row.people.size();
    std::vector<Vec3<double>> before(people), after(people);
    std::vector<BodyLoad> loads(people), later(people);
    row.scene.read_positions(row.people, std::span(before));
    row.scene.read_loads(row.people, {}, std::span(loads));
    step(solver, row.scene, 200);
    row.scene.read_positions(row.people, std::span(after));
    row.scene.read_loads(row.people, {}, std::span(later));
    for (std::size_t i = 0; i < people; ++i) {
        EXPECT_EQ(before[i].x, after[i].x);
        EXPECT_EQ(before[i].y, after[i].y);
        EXPECT_GT(loads[i].normal_force, 300);
        EXPECT_EQ(loads[i].normal_force, later[i].normal_force);
    }
    EXPECT_FALSE(row.is_anyone(false));
    for (const BodyId body : moving) EXPECT_FALSE(row.scene.is_asleep(body));
}

/// Woken contacts go on with the impulses that they had: nothing jumps.
TEST(Sleep, WhoWakesGoesOnAsIfNothingHadBeen)
{
    PressedRow row(5, 400);
    Solver solver(sleepy());
    ASSERT_LT(steps_until_asleep(solver, row.scene, row.people[0]), 1000);
    step(solver, row.scene, 50);
    row.scene.wake(row.people[0]);
    step(solver, row.scene);
    for (const DiscContact& contact : row.scene.disc_contacts()) EXPECT_NEAR(contact.normal_force, 400, 4);
    for (const BodyId body : row.people) EXPECT_LT(std::abs(row.scene.state(body).linear_velocity.x), 0.01F);
}

/// Every third of 90 moves on, at its speed, between others who sleep and stay as they are. Evidence: x = v t. Of rigid bodies
/// two are a figure, in lockstep or not.
TEST(Sleep, SleepersAmongOthersStayPutAndTheseMoveOn)
{
    for (const BodyModel model : {BodyModel::particle, BodyModel::planar, BodyModel::rigid}) {
        for (const bool in_lockstep : {false, true}) {
            Scene scene;
            std::vector<BodyId> bodies;
            for (int i = 0; i < 90; ++i) {
                BodyDefinition body;
                body.model = model;
                body.position = {0, 2.0 * i, 0};
                if (i % 3 == 0) body.linear_velocity = {1, 0, 0};
                bodies.push_back(scene.add_body(body));
                if (model == BodyModel::rigid && i % 3 == 2)
                    scene.add_joint(BallSocketDefinition{
                        bodies[bodies.size() - 2], bodies.back(), {0, 1, 0}, {0, -1, 0}});
            }
            SolverSettings settings = sleepy();
            settings.measures = !in_lockstep;  // what measures itself is swept by colour
            Solver solver(settings);
            step(solver, scene, 60);
            std::vector<BodyState> before;
            for (const BodyId body : bodies) before.push_back(scene.state(body));
            // In each step a sleeper is woken, who falls asleep again half a second later.
            for (std::size_t i = 0; i < 60; ++i) {
                scene.wake(bodies[i / 3 * 3 + 1]);
                step(solver, scene);
            }
            for (std::size_t i = 0; i < bodies.size(); ++i) {
                const BodyState now = scene.state(bodies[i]);
                if (i % 3 == 0) {
                    EXPECT_NEAR(now.position.x - before[i].position.x, 1, 1e-5) << i;
                } else {
                    EXPECT_EQ(now.position.x, before[i].position.x) << i;
                    EXPECT_EQ(now.position.y, before[i].position.y) << i;
                    EXPECT_EQ(now.orientation.w, before[i].orientation.w) << i;
                }
            }
        }
    }
}

TEST(Sleep, FiguresSleepInLockstepAndWithExactJoints)
{
    for (const bool exact : {false, true}) {
        Scene scene;
        std::vector<BodyId> ends;
        for (int copy = 0; copy < 20; ++copy) {
            BodyId above = scene.ground();
            for (int i = 0; i < 3; ++i) {
                BodyDefinition ball;
                ball.position = {2.0 * copy, -1.0 * (i + 1), 0};
                const BodyId body = scene.add_body(ball);
                const Vec3<float> anchor =
                    i == 0 ? Vec3<float>{2.0F * static_cast<float>(copy), 0, 0} : Vec3<float>{0, -0.5F, 0};
                scene.add_joint(BallSocketDefinition{above, body, anchor, {0, i == 0 ? 1.0F : 0.5F, 0}});
                above = body;
            }
            ends.push_back(above);
        }
        SolverSettings settings = sleepy();
        settings.gravity = {0, -10, 0};
        settings.exact_joints = exact;
        Solver solver(settings);
        for (int i = 0; i < 100; ++i) {
            scene.set_velocity(ends[3], {0, 0, 0.5F}, {});
            step(solver, scene);
        }
        for (std::size_t i = 0; i < ends.size(); ++i) EXPECT_EQ(scene.is_asleep(ends[i]), i != 3);
        EXPECT_EQ(solver.step(scene, dt).bodies_asleep, 57);
        scene.wake(ends[5]);
        scene.set_velocity(ends[5], {0, 0, 0.5F}, {});
        step(solver, scene, 30);
        EXPECT_GT(std::abs(scene.state(ends[5]).position.z), 0.01) << "it swings";
        EXPECT_EQ(scene.state(ends[6]).position.z, 0);
    }
}

}  // namespace
}  // namespace motley
