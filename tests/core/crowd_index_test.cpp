// Who is near a point or in an area. Independent evidence: every person is asked, in long double, and areas by the angle
// that their rings turn about a person.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "mixed_scene.h"

namespace motley {
namespace {

using testing::Random;

struct Known {
    BodyId body;
    Vec2<double> at;
    double radius;
};

/// A scene beside the host's own list of who is where.
struct Town {
    Scene scene;
    std::vector<Known> people;

    void add(const Vec2<double>& at, float radius = 0.2F)
    {
        BodyDefinition body;
        body.model = BodyModel::planar;
        body.position = {at.x, at.y, 0};
        people.push_back({scene.add_body(body), at, static_cast<double>(radius)});
        scene.set_disc(people.back().body, {.radius = radius});
    }
};

enum class Spread { square, clumps, line, far_outliers, one_place, rows, count };

Vec2<double> place_in(Spread spread, Random& random, int i)
{
    const Vec2<double> at{20 * random.symmetric(), 20 * random.symmetric()};
    switch (spread) {
        case Spread::clumps:
            return {100 * (i % 5) + 0.05 * at.x, -300 * (i % 3) + 0.05 * at.y};
        case Spread::line:
            return {7, 50 * at.y};
        case Spread::far_outliers:
            return i % 50 == 0 ? 5e4 * at : at;
        case Spread::one_place:
            return i % 4 == 0 ? at : Vec2<double>{3, 4};
        case Spread::rows:
            return {static_cast<double>(i % 30), static_cast<double>(i / 30)};
        default:
            return at;
    }
}

Town town_of(Spread spread, int people, std::uint64_t seed)
{
    Town town;
    Random random(seed);
    for (int i = 0; i < people; ++i)
        town.add(place_in(spread, random, i),
                 static_cast<float>(0.2 + (i % 37 == 0 ? 3 : 0.05) * std::abs(random.symmetric())));
    return town;
}

long double distance(const Vec2<double>& a, const Vec2<double>& b)
{
    const long double x = static_cast<long double>(a.x) - b.x, y = static_cast<long double>(a.y) - b.y;
    return std::sqrt(x * x + y * y);
}

/// Those of whom `is_meant` is true, in the order of their slots.
std::vector<BodyId> all_of(const Town& town, const std::function<bool(const Known&)>& is_meant)
{
    std::vector<BodyId> all;
    for (const Known& person : town.people) {
        if (is_meant(person)) all.push_back(person.body);
    }
    std::sort(all.begin(), all.end(), [](const BodyId& a, const BodyId& b) { return a.slot < b.slot; });
    return all;
}

/// How often the rings turn about a point, modulo 2.
bool rings_turn_about(const Polygon& area, const Vec2<double>& at)
{
    const auto turns = [&](const std::vector<Vec2<double>>& ring) {
        long double angle = 0;
        for (std::size_t i = 0; i < ring.size(); ++i) {
            const Vec2<double> a = ring[i] - at, b = ring[(i + 1) % ring.size()] - at;
            angle += std::atan2(static_cast<long double>(cross(a, b)), static_cast<long double>(dot(a, b)));
        }
        return std::lround(angle / (2 * 3.141592653589793238L));
    };
    long sum = turns(area.outer);
    for (const std::vector<Vec2<double>>& hole : area.holes) sum += turns(hole);
    return sum % 2 != 0;
}

std::vector<Vec2<double>> star(const Vec2<double>& middle, double size, int points, Random& random)
{
    std::vector<Vec2<double>> ring;
    for (int i = 0; i < points; ++i) {
        const double angle = 6.283185307 * i / points, radius = size * (1 + 0.6 * random.symmetric());
        ring.push_back(middle + radius * Vec2<double>{std::cos(angle), std::sin(angle)});
    }
    return ring;
}

/// Compares every query about random places with the same question to everybody.
void expect_right_answers(const Town& town, const CrowdIndex& index, std::uint64_t seed)
{
    ASSERT_EQ(index.size(), town.people.size());
    Random random(seed);
    std::vector<BodyId> found;
    std::vector<NearPerson> near;
    for (int query = 0; query < 40; ++query) {
        Vec2<double> point{30 * random.symmetric(), 30 * random.symmetric()};
        if (query % 3 == 0 && !town.people.empty())
            point =
                town.people[static_cast<std::size_t>(random.below(static_cast<int>(town.people.size())))].at;
        const double radius = query % 7 == 0 ? 0 : query % 5 == 0 ? 2e6 : 5 * std::abs(random.symmetric());
        index.centres_within(point, radius, found);
        EXPECT_EQ(found, all_of(town, [&](const Known& k) { return distance(k.at, point) <= radius; }));
        index.discs_within(point, radius, found);
        EXPECT_EQ(found,
                  all_of(town, [&](const Known& k) { return distance(k.at, point) <= radius + k.radius; }));

        std::vector<NearPerson> all;
        const double furthest = query % 2 == 0 ? INFINITY : radius;
        for (const Known& k : town.people) {
            if (distance(k.at, point) <= furthest)
                all.push_back({k.body, static_cast<double>(distance(k.at, point))});
        }
        std::sort(all.begin(), all.end(), [](const NearPerson& a, const NearPerson& b) {
            return a.distance != b.distance ? a.distance < b.distance : a.body.slot < b.body.slot;
        });
        const std::size_t count = query % 4 == 0 ? 1 : query % 4 == 1 ? 16 : query % 4 == 2 ? 1000000 : 0;
        all.resize(std::min(all.size(), count));
        index.nearest(point, count, near, furthest);
        ASSERT_EQ(near.size(), all.size());
        for (std::size_t i = 0; i < near.size(); ++i) {
            EXPECT_DOUBLE_EQ(near[i].distance, all[i].distance);
            // In long double those at the same distance may seem not to be: then only the distances are compared.
            if ((i == 0 || all[i].distance > all[i - 1].distance * (1 + 1e-14)) &&
                (i + 1 == all.size() ? count != all.size()
                                     : all[i + 1].distance > all[i].distance * (1 + 1e-14))) {
                EXPECT_EQ(near[i].body, all[i].body);
            }
            if (i > 0 && near[i].distance == near[i - 1].distance) {
                EXPECT_LT(near[i - 1].body.slot, near[i].body.slot);
            }
        }

        const double size = 0.5 + 15 * std::abs(random.symmetric());
        Polygon area{star(point, size, 3 + random.below(40), random), {}};
        for (int hole = 0; hole < query % 3; ++hole)
            area.holes.push_back(
                star(point + Vec2<double>{size * random.symmetric(), 0}, 0.2 * size, 5, random));
        index.inside(area, found);
        EXPECT_EQ(found, all_of(town, [&](const Known& k) { return rings_turn_about(area, k.at); }));
    }
}

TEST(CrowdIndex, FindsWhomASearchOfEverybodyFindsHoweverTheyAreSpread)
{
    for (int spread = 0; spread < static_cast<int>(Spread::count); ++spread) {
        for (const int people : {0, 1, 2, 17, 300, 5000}) {
            const Town town =
                town_of(static_cast<Spread>(spread), people, 7 + static_cast<std::uint64_t>(people));
            CrowdIndex index;
            index.build(town.scene);
            SCOPED_TRACE("spread " + std::to_string(spread) + ", people " + std::to_string(people));
            expect_right_answers(town, index, 99 + static_cast<std::uint64_t>(spread));
        }
    }
}

TEST(CrowdIndex, IsRightAfterStepsRemovalsAdditionsAndTeleports)
{
    Town town = town_of(Spread::square, 2000, 3);
    Solver solver(SolverSettings{}, {.threads = 2});
    CrowdIndex index;
    Random random(5);
    for (int round = 0; round < 6; ++round) {
        ASSERT_EQ(solver.step(town.scene, 1.0F / 60).status, StepStatus::done);
        for (Known& person : town.people) {
            const Vec3<double> at = town.scene.state(person.body).position;
            person.at = {at.x, at.y};
        }
        for (int i = 0; i < 100; ++i) {
            const auto who = static_cast<std::size_t>(random.below(static_cast<int>(town.people.size())));
            town.scene.remove_body(town.people[who].body);
            town.people.erase(town.people.begin() + static_cast<std::ptrdiff_t>(who));
        }
        for (int i = 0; i < 50; ++i) town.add({20 * random.symmetric(), 20 * random.symmetric()}, 0.3F);
        for (int i = 0; i < 50; ++i) {
            Known& person =
                town.people[static_cast<std::size_t>(random.below(static_cast<int>(town.people.size())))];
            person.at = {1000 * random.symmetric(), 5};
            town.scene.set_pose(person.body, {person.at.x, person.at.y, 0}, {0, 0, 0, 1}, 0);
        }
        // Of no interest: bodies without discs.
        town.scene.clear_disc(town.people.back().body);
        town.people.pop_back();
        if (round == 3) town.scene.renumber_bodies();
        EXPECT_FALSE(index.is_current(town.scene));
        index.build(town.scene);
        EXPECT_TRUE(index.is_current(town.scene));
        expect_right_answers(town, index, static_cast<std::uint64_t>(round));
    }
}

TEST(CrowdIndex, IsCurrentUntilSomebodyMoves)
{
    Town town = town_of(Spread::square, 100, 1);
    CrowdIndex index;
    EXPECT_FALSE(index.is_current(town.scene));
    EXPECT_TRUE(index.is_current(Scene()));
    index.build(town.scene);
    EXPECT_TRUE(index.is_current(town.scene));
    const CrowdIndex copy = index;
    town.scene.set_disc(town.people[50].body, {.radius = 0.21F});
    EXPECT_FALSE(index.is_current(town.scene));
    index.build(town.scene);
    const Known& who = town.people[70];
    town.scene.set_pose(who.body, {who.at.x, who.at.y + 1e-9, 0}, {0, 0, 0, 1}, 0);
    EXPECT_FALSE(index.is_current(town.scene));
    index.build(town.scene);
    town.scene.remove_body(who.body);
    EXPECT_FALSE(index.is_current(town.scene));
    // What was built answers for its own moment.
    std::vector<BodyId> found;
    copy.centres_within(who.at, 0, found);
    EXPECT_EQ(found, std::vector<BodyId>{who.body});
}

TEST(CrowdIndex, GivesTheNearestOfEqualDistanceInTheOrderOfTheirSlots)
{
    Town town;
    // Eight people on a circle, by multiples of 3-4-5, added in a shuffled order.
    for (const Vec2<double>& at :
         {Vec2<double>{3, 4}, {-5, 0}, {4, -3}, {0, 5}, {-3, -4}, {5, 0}, {-4, 3}, {0, -5}})
        town.add(at);
    CrowdIndex index;
    index.build(town.scene);
    for (std::size_t count = 0; count <= 8; ++count) {
        std::vector<NearPerson> near;
        index.nearest({0, 0}, count, near, 5);
        ASSERT_EQ(near.size(), count);
        for (std::size_t i = 0; i < count; ++i) {
            EXPECT_EQ(near[i].body, town.people[i].body);
            EXPECT_EQ(near[i].distance, 5);
        }
    }
}

TEST(CrowdIndex, RefusesWhatIsNoPlaceByName)
{
    const CrowdIndex index;
    std::vector<BodyId> found{BodyId{1, 1}};
    std::vector<NearPerson> near;
    const auto message_of = [](const auto& call) -> std::string {
        try {
            call();
        } catch (const InvalidInput& refused) {
            return refused.what();
        }
        return "accepted";
    };
    EXPECT_EQ(message_of([&] {
                  index.centres_within({NAN, 0}, 1, found);
              }),
              "centres_within.point.x is nan; expected a finite value from -1e12 to 1e12 (m)");
    EXPECT_EQ(message_of([&] {
                  index.discs_within({0, 0}, -1, found);
              }),
              "discs_within.radius is -1; expected 0 or more (m)");
    EXPECT_EQ(message_of([&] {
                  index.nearest({0, 0}, 1, near, NAN);
              }),
              "nearest.furthest is nan; expected 0 or more (m)");
    EXPECT_EQ(message_of([&] {
                  index.inside({{{0, 0}, {1, 0}, {1, 1}}, {{{0, 0}}}}, found);
              }),
              "Polygon.holes[0].size() is 1; expected 3 or more points");
    EXPECT_EQ(message_of([&] {
                  index.inside({{{0, 0}, {1, 0}, {1, 2e12}}, {}}, found);
              }),
              "Polygon.outer[2].y is 2e+12; expected a finite value from -1e12 to 1e12 (m)");
    EXPECT_EQ(found.size(), std::size_t{1}) << "a refused call changes nothing";
    index.centres_within({0, 0}, 1, found);
    EXPECT_TRUE(found.empty());
}

}  // namespace
}  // namespace motley
