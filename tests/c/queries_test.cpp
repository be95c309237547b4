// The queries of the C interface against a search of everybody, and against geometry drawn by hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>
#include <vector>

#include "disc_crowd.h"
#include "motley/c/motley.h"

namespace motley {
namespace {

/// A crowd in a box of walls, through the C interface.
class CQueries : public ::testing::Test {
  protected:
    motley_scene* scene = nullptr;
    motley_solver* solver = nullptr;
    std::vector<motley_body_id> people;
    std::vector<motley_vec3d> positions;

    void SetUp() override
    {
        const std::vector<std::byte> bytes = save_scene(testing::DiscCrowd({.people = 300}).scene);
        ASSERT_EQ(motley_scene_load(bytes.data(), bytes.size(), &scene), MOTLEY_DONE);
        ASSERT_EQ(motley_solver_create(nullptr, nullptr, &solver), MOTLEY_DONE);
        people.resize(300);
        positions.resize(300);
        std::size_t count = 0;
        ASSERT_EQ(motley_scene_read_bodies(scene, 300, people.data(), &count), MOTLEY_DONE);
        ASSERT_EQ(count, 300U);
        read_positions();
    }
    void TearDown() override
    {
        motley_solver_destroy(solver);
        motley_scene_destroy(scene);
    }
    void read_positions()
    {
        ASSERT_EQ(
            motley_scene_read_positions(scene, 300, people.data(), positions.data(), sizeof positions[0]),
            MOTLEY_DONE);
    }
    [[nodiscard]] double distance(std::size_t person, motley_vec2d from) const
    {
        return std::hypot(positions[person].x - from.x, positions[person].y - from.y);
    }
    static std::vector<std::uint32_t> slots(const motley_body_id* bodies, std::size_t count)
    {
        std::vector<std::uint32_t> all;
        for (std::size_t i = 0; i < count; ++i) all.push_back(bodies[i].slot);
        return all;
    }
};

TEST_F(CQueries, PeopleNearAPointAreThoseOfASearchOfEverybody)
{
    motley_crowd_index* index = nullptr;
    ASSERT_EQ(motley_crowd_index_create(&index), MOTLEY_DONE);
    ASSERT_EQ(motley_crowd_index_build(index, scene), MOTLEY_DONE);
    std::size_t count = 0;
    ASSERT_EQ(motley_crowd_index_size(index, &count), MOTLEY_DONE);
    EXPECT_EQ(count, 300U);
    for (const motley_vec2d at : {motley_vec2d{3, 4}, motley_vec2d{0, 0}, motley_vec2d{100, 0}}) {
        std::vector<std::uint32_t> expected, in_triangle;
        std::vector<double> distances;
        for (std::size_t i = 0; i < people.size(); ++i) {
            if (distance(i, at) <= 1.5) expected.push_back(people[i].slot);
            const double x = positions[i].x - at.x, y = positions[i].y - at.y;
            if (x > 0 && y > 0 && x + y < 3) in_triangle.push_back(people[i].slot);
            distances.push_back(distance(i, at));
        }
        std::sort(distances.begin(), distances.end());
        motley_body_id found[300];
        ASSERT_EQ(motley_crowd_index_centres_within(index, at, 1.5, 300, found, &count), MOTLEY_DONE);
        EXPECT_EQ(slots(found, count), expected);
        std::size_t discs = 0;
        ASSERT_EQ(motley_crowd_index_discs_within(index, at, 1.5, 0, nullptr, &discs), MOTLEY_DONE);
        EXPECT_GE(discs, count);
        motley_near_person near[7];
        ASSERT_EQ(motley_crowd_index_nearest(index, at, INFINITY, 7, near, &count), MOTLEY_DONE);
        ASSERT_EQ(count, 7U);
        for (std::size_t i = 0; i < 7; ++i) EXPECT_NEAR(near[i].distance, distances[i], 1e-12);
        const motley_vec2d corners[] = {at, {at.x + 3, at.y}, {at.x, at.y + 3}};
        const motley_ring triangle{corners, 3};
        ASSERT_EQ(motley_crowd_index_inside(index, 1, &triangle, 300, found, &count), MOTLEY_DONE);
        EXPECT_EQ(slots(found, count), in_triangle);
    }
    motley_bool current = 0;
    ASSERT_EQ(motley_crowd_index_is_current(index, scene, &current), MOTLEY_DONE);
    EXPECT_EQ(current, 1);
    ASSERT_EQ(motley_solver_step(solver, scene, 1.0F / 60, 0, nullptr, nullptr), MOTLEY_DONE);
    ASSERT_EQ(motley_crowd_index_is_current(index, scene, &current), MOTLEY_DONE);
    EXPECT_EQ(current, 0);
    EXPECT_EQ(motley_crowd_index_centres_within(index, {NAN, 0}, 1, 0, nullptr, &count), MOTLEY_REFUSED);
    EXPECT_EQ(motley_crowd_index_inside(index, 0, nullptr, 0, nullptr, &count), MOTLEY_REFUSED);
    motley_crowd_index_destroy(index);
}

TEST_F(CQueries, AWallHidesWhatIsBehindIt)
{
    motley_scene* empty = nullptr;
    motley_wall_index* index = nullptr;
    ASSERT_EQ(motley_scene_create(&empty), MOTLEY_DONE);
    ASSERT_EQ(motley_wall_index_create(&index), MOTLEY_DONE);
    const motley_vec2d corners[] = {{1, -1}, {1, 1}, {4, 1}};
    motley_wall_definition definition = motley_default_wall_definition();
    definition.points = corners;
    definition.point_count = 3;
    definition.category = 4;
    motley_wall_id wall;
    ASSERT_EQ(motley_scene_add_wall(empty, &definition, &wall), MOTLEY_DONE);
    ASSERT_EQ(motley_wall_index_build(index, empty), MOTLEY_DONE);
    std::size_t pieces = 0;
    ASSERT_EQ(motley_wall_index_size(index, &pieces), MOTLEY_DONE);
    EXPECT_EQ(pieces, 2U);
    motley_bool is_hit = 0;
    motley_wall_hit hit{};
    ASSERT_EQ(motley_wall_index_first_hit(index, {0, 0}, {4, 0}, UINT32_MAX, &is_hit, &hit), MOTLEY_DONE);
    EXPECT_EQ(is_hit, 1);
    EXPECT_EQ(hit.wall.slot, wall.slot);
    EXPECT_NEAR(hit.fraction, 0.25, 1e-12);
    ASSERT_EQ(motley_wall_index_first_hit(index, {0, 0}, {0, 5}, UINT32_MAX, &is_hit, nullptr), MOTLEY_DONE);
    EXPECT_EQ(is_hit, 0);
    ASSERT_EQ(motley_wall_index_first_hit(index, {0, 0}, {4, 0}, 3, &is_hit, &hit), MOTLEY_DONE);
    EXPECT_EQ(is_hit, 0);  // of another category
    motley_bool current = 0;
    ASSERT_EQ(motley_scene_remove_wall(empty, wall), MOTLEY_DONE);
    ASSERT_EQ(motley_wall_index_is_current(index, empty, &current), MOTLEY_DONE);
    EXPECT_EQ(current, 0);
    motley_wall_index_destroy(index);
    motley_scene_destroy(empty);
}

TEST_F(CQueries, EventsAreTheDifferenceOfTheContactsThatPush)
{
    using Touch = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>;
    const auto touches = [&] {
        std::vector<motley_disc_contact> contacts(3000);
        std::size_t count = 0;
        EXPECT_EQ(motley_scene_disc_contacts(scene, contacts.size(), contacts.data(), &count), MOTLEY_DONE);
        std::set<Touch> all;
        for (std::size_t i = 0; i < count; ++i) {
            const motley_disc_contact& c = contacts[i];
            if (!(c.normal_force > 0)) continue;
            if (c.wall.generation != 0) all.emplace(0, c.b.slot, c.wall.slot);
            if (c.wall.generation == 0)
                all.emplace(std::min(c.a.slot, c.b.slot), std::max(c.a.slot, c.b.slot), 0);
        }
        return all;
    };
    const auto as_set = [](const motley_contact_pair* pairs, std::size_t count) {
        std::set<Touch> all;
        for (std::size_t i = 0; i < count; ++i)
            all.emplace(pairs[i].a.slot, pairs[i].b.slot, pairs[i].wall.slot);
        return all;
    };
    motley_contact_events* events = nullptr;
    ASSERT_EQ(motley_contact_events_create(&events), MOTLEY_DONE);
    std::set<Touch> before;
    std::size_t ended_in_all = 0;
    for (int step = 0; step < 60; ++step) {
        ASSERT_EQ(motley_solver_step(solver, scene, 1.0F / 60, 0, nullptr, nullptr), MOTLEY_DONE);
        ASSERT_EQ(motley_contact_events_update(events, scene), MOTLEY_DONE);
        const std::set<Touch> now = touches();
        std::set<Touch> began, ended;
        std::set_difference(now.begin(), now.end(), before.begin(), before.end(),
                            std::inserter(began, began.end()));
        std::set_difference(before.begin(), before.end(), now.begin(), now.end(),
                            std::inserter(ended, ended.end()));
        const motley_contact_pair* pairs = nullptr;
        std::size_t count = 0;
        ASSERT_EQ(motley_contact_events_began(events, &pairs, &count), MOTLEY_DONE);
        EXPECT_EQ(as_set(pairs, count), began);
        ASSERT_EQ(motley_contact_events_ended(events, &pairs, &count), MOTLEY_DONE);
        EXPECT_EQ(as_set(pairs, count), ended);
        ASSERT_EQ(motley_contact_events_pushing(events, &count), MOTLEY_DONE);
        EXPECT_EQ(count, now.size());
        ended_in_all += ended.size();
        before = now;
    }
    EXPECT_GT(ended_in_all, 20U);
    ASSERT_EQ(motley_contact_events_clear(events), MOTLEY_DONE);
    std::size_t count = 1;
    ASSERT_EQ(motley_contact_events_pushing(events, &count), MOTLEY_DONE);
    EXPECT_EQ(count, 0U);
    motley_contact_events_destroy(events);
}

TEST_F(CQueries, NullPointersAreRefused)
{
    std::size_t count = 0;
    motley_bool is = 0;
    motley_crowd_index* index = nullptr;
    ASSERT_EQ(motley_crowd_index_create(&index), MOTLEY_DONE);
    EXPECT_EQ(motley_crowd_index_create(nullptr), MOTLEY_REFUSED);
    EXPECT_EQ(motley_crowd_index_build(index, nullptr), MOTLEY_REFUSED);
    EXPECT_EQ(motley_crowd_index_build(nullptr, scene), MOTLEY_REFUSED);
    EXPECT_EQ(motley_crowd_index_nearest(index, {0, 0}, 1, 5, nullptr, &count), MOTLEY_REFUSED);
    EXPECT_EQ(motley_crowd_index_nearest(index, {0, 0}, 1, 0, nullptr, nullptr), MOTLEY_REFUSED);
    EXPECT_EQ(motley_wall_index_first_hit(nullptr, {0, 0}, {1, 1}, 1, &is, nullptr), MOTLEY_REFUSED);
    EXPECT_EQ(motley_contact_events_update(nullptr, scene), MOTLEY_REFUSED);
    motley_crowd_index_destroy(index);
    motley_crowd_index_destroy(nullptr);
    motley_wall_index_destroy(nullptr);
    motley_contact_events_destroy(nullptr);
}

}  // namespace
}  // namespace motley
