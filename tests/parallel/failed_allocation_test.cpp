// What happens when memory runs out: the call is refused and has changed nothing, and the same call with enough
// memory then gives the usual result. Independent evidence: the same calls where memory never ran out. Every
// allocation fails once.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "allocator.h"
#include "disc_crowd.h"
#include "fallen_figures.h"
#include "lattice_crowd.h"
#include "mixed_scene.h"
#include "shape_crowd.h"

namespace motley {
namespace {

using testing::FailingAllocator;
using testing::MixedScene;

constexpr float dt = 1.0F / 60;

struct Way {
    const char* name;
    SolverSettings settings;
    int threads;
};

std::vector<Way> ways()
{
    SolverSettings soft;
    soft.gravity = {0, -9.81F, 0};
    SolverSettings exact = soft;
    exact.exact_joints = true;
    SolverSettings careful = soft;
    careful.tolerance = 1e-3F;
    careful.measures = true;
    SolverSettings sleepy = soft;
    sleepy.sleep_speed = 0.2F;
    sleepy.sleep_after = 0;
    SolverSettings contacts = soft;
    contacts.exact_contacts = true;
    SolverSettings direct = soft;
    direct.method = Method::direct;
    direct.substeps = 1;
    return {{"soft", soft, 1},     {"soft", soft, 2},         {"exact", exact, 2},  {"careful", careful, 2},
            {"sleepy", sleepy, 2}, {"contacts", contacts, 2}, {"direct", direct, 1}};
}

/// The first contacts of a list. A step with few contacts comes first, so that everything grows in the next one.
std::span<const Contact> first_of(const std::vector<Contact>& contacts, std::size_t count)
{
    return std::span(contacts).first(std::min(count, contacts.size()));
}

/// A step with three contacts; then a step with all contacts, in which memory runs out; then two more. Returns the
/// hash. `ran_out` tells whether an allocation failed.
std::uint64_t hash_after_steps(const Way& way, long successes, bool for_good, bool& ran_out)
{
    MixedScene mixed(4);
    Solver solver(way.settings, {.threads = way.threads, .alone_below = 0});
    for (int step = 0; step < 12; ++step) mixed.contacts();
    const std::vector<Contact> few(first_of(mixed.contacts(), 3).begin(),
                                   first_of(mixed.contacts(), 3).end());
    EXPECT_EQ(solver.step(mixed.scene, dt, few).status, StepStatus::done);
    // One more joint, so that joints are laid out anew.
    mixed.scene.set_break_limit(
        mixed.scene.add_joint(DistanceDefinition{mixed.balls[0], mixed.balls[5], {}, {}, 0, 2}), {1, 1});
    std::vector<Contact> contacts = mixed.contacts();
    for (std::size_t i = 0; i < mixed.balls.size(); ++i) {
        Contact contact;
        contact.body_a = mixed.scene.ground();
        contact.body_b = mixed.balls[i];
        contact.key = std::uint64_t{1} << 50 | i;
        contact.normal = {0, 1, 0};
        contact.separation = 1;
        contacts.push_back(contact);
    }
    const std::uint64_t before = mixed.scene.state_hash();
    StepReport report;
    {
        const FailingAllocator failing(successes, for_good);
        report = solver.step(mixed.scene, dt, contacts);
        ran_out = FailingAllocator::has_failed();
    }
    if (report.status == StepStatus::refused) {
        EXPECT_EQ(report.error, "out of memory");
        EXPECT_EQ(mixed.scene.state_hash(), before) << way.name << ", allocation " << successes;
        EXPECT_TRUE(ran_out);
        report = solver.step(mixed.scene, dt, contacts);
    }
    EXPECT_EQ(report.status, StepStatus::done) << report.error;
    for (int step = 0; step < 2; ++step)
        EXPECT_EQ(solver.step(mixed.scene, dt, contacts).status, StepStatus::done);
    return mixed.scene.state_hash();
}

TEST(FailedAllocation, AStepWithoutMemoryIsRefusedAndTheNextOneIsAsIfNothingHadBeen)
{
    for (const Way& way : ways()) {
        bool ran_out = false;
        const std::uint64_t expected = hash_after_steps(way, testing::never, false, ran_out);
        // Sanitizers let every fifth allocation fail.
        const long stride = testing::long_run(10) < 10 ? 5 : 1;
        for (const bool for_good : {false, true}) {
            long successes = 0;
            for (ran_out = true; ran_out; successes += stride) {
                ASSERT_EQ(hash_after_steps(way, successes, for_good, ran_out), expected)
                    << way.name << " on " << way.threads << " threads, allocation " << successes;
            }
            EXPECT_GT(successes, 10) << way.name;
        }
    }
}

/// A step with three contacts; then one with all of them, in which memory runs out; then two more.
TEST(FailedAllocation, FiguresOnAFloorWithoutMemoryAreRefusedAndTheNextStepIsAsIfNothingHadBeen)
{
    testing::FallenFigures fallen({.copies = 20, .all_touches = true});
    {
        Solver solver(testing::with_gravity({0, -9.81F, 0}));
        for (int step = 0; step < 70; ++step) solver.step(fallen.scene, dt, fallen.contacts());
    }
    const std::vector<Contact> contacts = fallen.contacts();
    for (const Way& way : {ways()[1], ways()[2]}) {
        const auto hash_after_steps = [&](long successes, bool& ran_out) {
            Scene scene = fallen.scene;
            Solver solver(way.settings, {.threads = way.threads, .alone_below = 0});
            EXPECT_EQ(solver.step(scene, dt, first_of(contacts, 3)).status, StepStatus::done);
            const std::uint64_t before = scene.state_hash();
            StepReport report;
            {
                const FailingAllocator failing(successes, false);
                report = solver.step(scene, dt, contacts);
                ran_out = FailingAllocator::has_failed();
            }
            if (report.status == StepStatus::refused) {
                EXPECT_EQ(scene.state_hash(), before) << way.name << ", allocation " << successes;
                report = solver.step(scene, dt, contacts);
            }
            EXPECT_EQ(report.status, StepStatus::done) << report.error;
            for (int step = 0; step < 2; ++step) {
                report = solver.step(scene, dt, contacts);
                EXPECT_EQ(report.joints_in_lockstep,
                          testing::Ragdoll::joints * (way.settings.exact_joints ? 20 : 16));
            }
            return scene.state_hash();
        };
        bool ran_out = false;
        const std::uint64_t expected = hash_after_steps(testing::never, ran_out);
        long successes = 0;
        for (ran_out = true; ran_out; ++successes)
            ASSERT_EQ(hash_after_steps(successes, ran_out), expected) << way.name << ", " << successes;
        EXPECT_GT(successes, 10) << way.name;
    }
}

TEST(FailedAllocation, PatchesWithoutMemoryAreRefusedAndTheNextOnesDone)
{
    testing::LatticeCrowd crowd;
    const std::vector<Contact> contacts = crowd.contacts();
    const auto hash_after = [&](long successes, bool& ran_out) {
        Scene scene = crowd.scene;
        Solver solver(SolverSettings{}, {.threads = 2});
        {
            const FailingAllocator failing(successes, false);
            const StepReport report = solver.step(scene, dt, contacts);
            ran_out = FailingAllocator::has_failed();
            if (report.status == StepStatus::done) return scene.state_hash();
            EXPECT_EQ(report.error, "out of memory");
        }
        EXPECT_EQ(solver.step(scene, dt, contacts).status, StepStatus::done);
        return scene.state_hash();
    };
    bool ran_out = false;
    const std::uint64_t expected = hash_after(testing::never, ran_out);
    ran_out = true;
    // Only every seventh allocation: those that a small scene makes as well have failed in the test above.
    for (long successes = 0; ran_out; successes += 7)
        ASSERT_EQ(hash_after(successes, ran_out), expected) << "allocation " << successes;
}

TEST(FailedAllocation, CapsulesWithoutMemoryAreNotLost)
{
    const testing::ShapeCrowd crowd(8, 20);
    const auto hash_after = [&](long successes, bool& ran_out) {
        Scene scene = crowd.scene;
        Solver solver({.gravity = {0, 0, -9.81F}}, {.threads = 2, .alone_below = 0});
        StepReport report;
        {
            const FailingAllocator failing(successes, false);
            report = solver.step(scene, dt);
            ran_out = FailingAllocator::has_failed();
        }
        if (report.status == StepStatus::refused) {
            EXPECT_EQ(report.error, "out of memory");
            EXPECT_EQ(scene.state_hash(), crowd.scene.state_hash());
            EXPECT_EQ(solver.step(scene, dt).status, StepStatus::done);
        }
        for (int step = 0; step < 3; ++step) EXPECT_EQ(solver.step(scene, dt).status, StepStatus::done);
        return scene.state_hash();
    };
    bool ran_out = false;
    const std::uint64_t expected = hash_after(testing::never, ran_out);
    ran_out = true;
    for (long successes = 0; ran_out; ++successes)
        ASSERT_EQ(hash_after(successes, ran_out), expected) << "allocation " << successes;
}

TEST(FailedAllocation, ASceneWithoutMemoryRefusesAndIsAsItWas)
{
    const std::vector<std::pair<const char*, std::function<void(MixedScene&)>>> calls = {
        {"add_body", [](MixedScene& m) { m.scene.add_body({}); }},
        {"add_bodies",
         [](MixedScene& m) {
             static const std::vector<BodyDefinition> many(200);
             static std::vector<BodyId> ids(200);
             m.scene.add_bodies(many, ids);
         }},
        {"remove_bodies", [](MixedScene& m) { m.scene.remove_bodies(std::span(m.balls).first(6)); }},
        {"add_joint",
         [](MixedScene& m) {
             m.scene.add_joint(
                 PulleyDefinition{m.balls[0], m.balls[1], {}, {}, {0, 9, 0}, {1, 9, 0}, 1, 0, 20});
         }},
        {"remove_joint", [](MixedScene& m) { m.scene.remove_joint(m.joints[1]); }},
        {"set_break_limit",
         [](MixedScene& m) {
             m.scene.set_break_limit(m.joints[1], {1, 1});
         }},
        {"set_island_iterations", [](MixedScene& m) { m.scene.set_island_iterations(m.balls[3], 7); }},
        {"set_user_data", [](MixedScene& m) { m.scene.set_user_data(m.balls[3], 7); }},
        {"set_mass",
         [](MixedScene& m) {
             m.scene.set_mass(m.balls[5], 7, {1, 0, 0, 1, 0, 1});
         }},
        {"change_body",
         [](MixedScene& m) {
             m.scene.change_body(m.balls[5], {BodyModel::planar, {1, 0, 0, 1, 0, 1}});
         }},
        {"renumber_bodies", [](MixedScene& m) { m.scene.renumber_bodies(); }},
    };
    for (const auto& [name, call] : calls) {
        MixedScene expected(3);
        call(expected);
        Solver solver({.gravity = {0, -9.81F, 0}});
        for (int step = 0; step < 3; ++step) solver.step(expected.scene, dt);
        bool ran_out = true;
        for (long successes = 0; ran_out; ++successes) {
            MixedScene mixed(3);
            const std::uint64_t before = mixed.scene.state_hash();
            const std::size_t bodies = mixed.scene.body_count(), joints = mixed.scene.joint_count();
            try {
                const FailingAllocator failing(successes, false);
                call(mixed);
                ran_out = FailingAllocator::has_failed();
            } catch (const std::bad_alloc&) {
                EXPECT_EQ(mixed.scene.state_hash(), before) << name << ", allocation " << successes;
                EXPECT_EQ(mixed.scene.body_count(), bodies) << name;
                EXPECT_EQ(mixed.scene.joint_count(), joints) << name;
                call(mixed);
            }
            for (int step = 0; step < 3; ++step)
                ASSERT_EQ(solver.step(mixed.scene, dt).status, StepStatus::done) << name;
            ASSERT_EQ(mixed.scene.state_hash(), expected.scene.state_hash())
                << name << ", allocation " << successes;
        }
    }
}

/// Calls call(allocation) with one allocation more that succeeds each time, until none fails; after each failure
/// look().
template <class Call, class Look>
void fail_each_allocation(const Call& call, const Look& look)
{
    long successes = 0;
    for (bool ran_out = true; ran_out; ++successes) {
        try {
            const FailingAllocator failing(successes, false);
            call();
            ran_out = FailingAllocator::has_failed();
        } catch (const std::bad_alloc&) {
            look();
        }
    }
    EXPECT_GT(successes, 3);
}

TEST(FailedAllocation, APolygonWithoutMemoryAddsNoWall)
{
    const Polygon room{{{0, 0}, {9, 0}, {9, 9}, {0, 9}},
                       {{{1, 1}, {2, 1}, {2, 2}}, {{5, 5}, {6, 5}, {6, 6}}}};
    Scene scene;
    WallIndex index;
    std::vector<WallId> walls;
    fail_each_allocation([&] { walls = add_polygon(scene, room); },
                         [&] {
                             index.build(scene);
                             ASSERT_EQ(index.size(), std::size_t{0});
                         });
    EXPECT_EQ(walls.size(), std::size_t{3});
    EXPECT_EQ(walls[0].slot, 1U) << "no slot was lost on the way";
}

TEST(FailedAllocation, IndicesWithoutMemoryAreEmptyAndTheNextOnesRight)
{
    const testing::DiscCrowd crowd({.people = 100});
    std::vector<BodyId> found;
    CrowdIndex people;
    WallIndex walls;
    fail_each_allocation([&] { people.build(crowd.scene); },
                         [&] {
                             EXPECT_EQ(people.size(), std::size_t{0});
                             people.centres_within({5, 5}, 1e3, found);
                             EXPECT_TRUE(found.empty());
                         });
    people.centres_within({5, 5}, 1e3, found);
    EXPECT_EQ(found.size(), crowd.people.size());
    fail_each_allocation([&] { walls.build(crowd.scene); },
                         [&] {
                             EXPECT_TRUE(walls.is_free({-1e3, 1}, {1e3, 1}));
                         });
    EXPECT_FALSE(walls.is_free({-1e3, 1}, {1e3, 1}));
}

TEST(FailedAllocation, EventsWithoutMemoryAreThoseOfTheUpdateBefore)
{
    testing::DiscCrowd crowd({.people = 400, .speed = 3, .spacing = 0.42});
    Solver solver(SolverSettings{});
    ContactEvents events;
    for (int step = 0; step < 5; ++step) solver.step(crowd.scene, dt);
    events.update(crowd.scene);
    const std::size_t began = events.began().size(), pushing = events.pushing();
    for (int step = 0; step < 5; ++step) solver.step(crowd.scene, dt);
    ContactEvents expected = events;
    expected.update(crowd.scene);
    fail_each_allocation([&] { events.update(crowd.scene); },
                         [&] {
                             EXPECT_EQ(events.began().size(), began);
                             EXPECT_EQ(events.pushing(), pushing);
                         });
    const auto same = [](std::span<const ContactPair> x, std::span<const ContactPair> y) {
        return std::equal(x.begin(), x.end(), y.begin(), y.end());
    };
    EXPECT_TRUE(same(events.began(), expected.began()));
    EXPECT_TRUE(same(events.ended(), expected.ended()));
    EXPECT_GT(events.ended().size(), std::size_t{10});
}

}  // namespace
}  // namespace motley
