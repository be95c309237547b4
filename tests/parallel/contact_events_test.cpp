// Which contacts of discs began and ended to push. Independent evidence: the difference of the sets that disc_contacts()
// gives, and a disc that is driven to and fro.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <tuple>
#include <vector>

#include "disc_crowd.h"
#include "rig.h"
#include "shape_crowd.h"

namespace motley {
namespace {

using testing::DiscCrowd;
using testing::person_at;
using testing::Random;

constexpr float dt = 1.0F / 60;

std::vector<ContactPair> list_of(std::span<const ContactPair> pairs)
{
    return {pairs.begin(), pairs.end()};
}
using Pairs = std::vector<ContactPair>;

/// What distinguishes pairs, in the order in which events are listed.
using Name = std::tuple<bool, std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t>;
Name name_of(const ContactPair& pair)
{
    const bool wall = pair.wall.slot != 0;
    return {wall, wall ? pair.wall.slot : pair.a.slot, pair.b.slot,
            wall ? pair.wall.generation : pair.a.generation, pair.b.generation};
}

/// The pairs that disc_contacts() lists.
std::map<Name, ContactPair> pushing_pairs(const Scene& scene)
{
    std::map<Name, ContactPair> pairs;
    for (const DiscContact& contact : scene.disc_contacts()) {
        ContactPair pair{contact.a, contact.b, contact.wall};
        if (contact.wall.slot != 0) {
            pair.a = {};
        } else if (pair.b.slot < pair.a.slot) {
            std::swap(pair.a, pair.b);
        }
        pairs[name_of(pair)] = pair;
    }
    return pairs;
}

Pairs missing(const std::map<Name, ContactPair>& these, const std::map<Name, ContactPair>& those)
{
    Pairs pairs;
    for (const auto& [name, pair] : these) {
        if (those.count(name) == 0) pairs.push_back(pair);
    }
    return pairs;
}

TEST(ContactEvents, TellWhenADiscTouchesAWallAndAnotherDiscAndLeavesThem)
{
    Scene scene;
    const Vec2<double> corner[] = {{1, -1}, {1, 1}, {-5, 1}};
    const WallId wall = scene.add_wall({.points = corner});
    const BodyId person = scene.add_body(person_at(0, 0)), other = scene.add_body(person_at(-1, 0));
    for (const BodyId disc : {person, other}) scene.set_disc(disc, {.radius = 0.2F});
    scene.add_joint(BallSocketDefinition{scene.ground(), other, {-1, 0, 0}, {}});
    Solver solver;
    ContactEvents events;
    int walls_began = 0, walls_ended = 0, discs_began = 0, discs_ended = 0;
    double touched_at = 0;
    for (int step = 0; step < 600; ++step) {
        // To the wall for the first half of every two seconds, then to the other disc.
        scene.set_velocity(person, {step % 120 < 60 ? 2.0F : -2.0F, 0, 0}, {});
        ASSERT_EQ(solver.step(scene, dt).status, StepStatus::done);
        events.update(scene);
        for (const ContactPair& pair : events.began()) {
            EXPECT_EQ(pair.b, pair.wall == wall ? person : other);
            EXPECT_EQ(pair.a, pair.wall == wall ? BodyId{} : person);
            ++(pair.wall == wall ? walls_began : discs_began);
            touched_at = scene.state(person).position.x;
            EXPECT_NEAR(touched_at, pair.wall == wall ? 0.8 : -0.6, 0.02);
        }
        for (const ContactPair& pair : events.ended()) ++(pair.wall == wall ? walls_ended : discs_ended);
        EXPECT_EQ(events.pushing(), scene.disc_contacts().size());
    }
    EXPECT_EQ(walls_began, 5);
    EXPECT_EQ(walls_ended, 5);
    EXPECT_EQ(discs_began, 5);
    EXPECT_EQ(discs_ended, 4) << "the last one still pushes";
}

TEST(ContactEvents, OfWhatIsRemovedEndUnderItsOldHandle)
{
    Scene scene;
    const Vec2<double> ends[] = {{1, -9}, {1, 9}};
    const WallId wall = scene.add_wall({.points = ends});
    std::vector<BodyId> people;
    for (const double x : {0.8, 0.4, 0.0}) {
        people.push_back(scene.add_body(person_at(x, 0)));
        scene.set_disc(people.back(), {.radius = 0.2F});
        scene.set_force(people.back(), {100, 0, 0}, {});
    }
    Solver solver;
    ContactEvents events;
    const auto step = [&] {
        ASSERT_EQ(solver.step(scene, dt).status, StepStatus::done);
        events.update(scene);
    };
    for (int i = 0; i < 60; ++i) step();
    ASSERT_EQ(events.pushing(), std::size_t{3});
    EXPECT_TRUE(events.began().empty() && events.ended().empty());
    const ContactPair at_wall{{}, people[0], wall}, front{people[0], people[1], {}},
        back{people[1], people[2], {}};

    // The middle one leaves, and another takes the slot, the row and the place.
    scene.remove_body(people[1]);
    const BodyId heir = scene.add_body(person_at(0.4, 0));
    ASSERT_EQ(heir.slot, people[1].slot);
    scene.set_disc(heir, {.radius = 0.2F});
    scene.set_force(heir, {100, 0, 0}, {});
    EXPECT_EQ(scene.disc_contacts().size(), std::size_t{1}) << "the heir took no part in the last step";
    EXPECT_TRUE(scene.disc_contacts_of(heir).empty());
    ContactEvents without_a_step = events;
    without_a_step.update(scene);
    EXPECT_EQ(list_of(without_a_step.ended()), (Pairs{front, back}));
    EXPECT_TRUE(without_a_step.began().empty());
    step();
    EXPECT_EQ(list_of(events.ended()), (Pairs{front, back}));
    EXPECT_FALSE(scene.is_alive(events.ended()[0].b));
    EXPECT_EQ(list_of(events.began()), (Pairs{{people[0], heir, {}}, {heir, people[2], {}}}));

    // The wall goes, and another takes its slot and place.
    scene.remove_wall(wall);
    const WallId next_wall = scene.add_wall({.points = ends});
    ASSERT_EQ(next_wall.slot, wall.slot);
    step();
    EXPECT_EQ(list_of(events.ended()), Pairs{at_wall});
    EXPECT_FALSE(scene.is_alive(events.ended()[0].wall));
    EXPECT_EQ(list_of(events.began()), (Pairs{{{}, people[0], next_wall}}));

    events.clear();
    EXPECT_EQ(events.pushing(), std::size_t{0});
    events.update(scene);
    EXPECT_EQ(events.began().size(), std::size_t{3});
    events.update(scene);
    EXPECT_TRUE(events.began().empty() && events.ended().empty()) << "no step in between";
}

/// A crowd that jostles, from which some are removed, and some change place.
template <class Look>
void run_crowd(const SolverOptions& options, const Look& look)
{
    static const DiscCrowd start({.people = 2500, .friction = 0.3F, .speed = 2, .spacing = 0.43});
    DiscCrowd crowd = start;  // so that handles are the same in every run
    const Vec2<double> across[] = {{3, 3}, {9, 9}, {9, 4}};
    WallId wall = crowd.scene.add_wall({.points = across});
    Solver solver(SolverSettings{}, options);
    Random random;
    for (int step = 0; step < testing::long_run(60); ++step) {
        if (step % 10 == 0) crowd.pull_together(300);
        if (step % 10 == 5) {
            for (int i = 0; i < 20; ++i) {
                const auto who =
                    static_cast<std::size_t>(random.below(static_cast<int>(crowd.people.size())));
                const Vec3<double> at = crowd.scene.state(crowd.people[who]).position;
                crowd.scene.remove_body(crowd.people[who]);
                crowd.people[who] = crowd.scene.add_body(person_at(at.x, at.y));
                crowd.scene.set_disc(crowd.people[who], {.radius = 0.2F});
            }
            crowd.scene.remove_wall(wall);
            wall = crowd.scene.add_wall({.points = across});
        }
        if (step % 20 == 7) crowd.scene.renumber_bodies();
        ASSERT_EQ(solver.step(crowd.scene, dt).status, StepStatus::done);
        look(crowd.scene);
    }
}

TEST(ContactEvents, AreTheDifferenceOfWhatPushedInTwoSteps)
{
    ContactEvents events;
    std::map<Name, ContactPair> before;
    std::size_t began = 0, ended = 0;
    run_crowd({.threads = 2, .alone_below = 0}, [&](const Scene& scene) {
        const std::map<Name, ContactPair> now = pushing_pairs(scene);
        events.update(scene);
        EXPECT_EQ(list_of(events.began()), missing(now, before));
        EXPECT_EQ(list_of(events.ended()), missing(before, now));
        EXPECT_EQ(events.pushing(), now.size());
        began += events.began().size();
        ended += events.ended().size();
        before = now;
    });
    EXPECT_GT(began, std::size_t{3000});
    EXPECT_GT(ended, std::size_t{1000});
}

TEST(ContactEvents, AreTheSameForEveryInstructionSetAndNumberOfThreads)
{
    const auto events_of = [](const SolverOptions& options) {
        ContactEvents events;
        std::vector<Pairs> all;
        run_crowd(options, [&](const Scene& scene) {
            events.update(scene);
            all.push_back(list_of(events.began()));
            all.push_back(list_of(events.ended()));
        });
        return all;
    };
    const std::vector<Pairs> scalar = events_of({.isa = Isa::scalar});
    for (const Isa isa : available_isas()) {
        for (const int threads : {1, 2})
            EXPECT_EQ(events_of({.threads = threads, .alone_below = 0, .isa = isa}), scalar)
                << isa_name(isa) << " x " << threads;
    }
}

/// Capsules, half-spaces and walls: the pairs are those of shape_contacts() with a force.
TEST(ContactEvents, AreThoseOfCapsulesToo)
{
    testing::ShapeCrowd crowd;
    Solver solver({.gravity = {0, 0, -9.81F}});
    ContactEvents events;
    using Key = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>;
    const auto key_of = [](BodyId a, BodyId b, WallId wall) {
        if (wall != WallId{}) return Key{0, b.slot, wall.slot};
        return Key{std::min(a.slot, b.slot), std::max(a.slot, b.slot), 0};
    };
    std::set<Key> pushing;
    for (int step = 0; step < 120; ++step) {
        ASSERT_EQ(solver.step(crowd.scene, 1.0F / 60).status, StepStatus::done);
        events.update(crowd.scene);
        std::set<Key> now, began, ended;
        for (const ShapeContact& c : crowd.scene.shape_contacts())
            if (c.normal_force > 0) now.insert(key_of(c.a, c.b, c.wall));
        for (const DiscContact& c : crowd.scene.disc_contacts()) now.insert(key_of(c.a, c.b, c.wall));
        for (const ContactPair& pair : events.began()) began.insert(key_of(pair.a, pair.b, pair.wall));
        for (const ContactPair& pair : events.ended()) ended.insert(key_of(pair.a, pair.b, pair.wall));
        for (const Key& key : now) EXPECT_EQ(began.count(key), 1 - pushing.count(key)) << "step " << step;
        for (const Key& key : pushing) EXPECT_EQ(ended.count(key), 1 - now.count(key)) << "step " << step;
        EXPECT_EQ(events.pushing(), now.size());
        EXPECT_EQ(began.size() + pushing.size(), ended.size() + now.size());
        pushing = now;
    }
    EXPECT_GT(pushing.size(), 50U);
}

}  // namespace
}  // namespace motley
