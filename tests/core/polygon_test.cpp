// Polygons with holes as walls: what they become, and what is refused. Independent evidence: polygons drawn by hand.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "motley/motley.h"

namespace motley {
namespace {

using Ring = std::vector<Vec2<double>>;

Ring square(double x, double y, double size)
{
    return {{x, y}, {x + size, y}, {x + size, y + size}, {x, y + size}};
}

/// What add_polygon says, and that it has added nothing if it refuses.
std::string verdict_on(const Polygon& polygon, const WallDefinition& like = {})
{
    Scene scene;
    WallIndex index;
    std::string message = "accepted";
    try {
        add_polygon(scene, polygon, like);
    } catch (const InvalidInput& refused) {
        message = refused.what();
    }
    index.build(scene);
    std::size_t points = polygon.outer.size();
    for (const Ring& hole : polygon.holes) points += hole.size();
    EXPECT_EQ(index.size(), message == "accepted" ? points : 0);
    return message;
}

TEST(Polygon, BecomesAClosedWallForEachRing)
{
    Scene scene;
    const Vec2<double> other[] = {{50, 0}, {51, 0}};
    const WallId before = scene.add_wall({.points = other});
    const std::vector<WallId> walls = add_polygon(
        scene, {square(0, 0, 10), {square(2, 2, 1), square(5, 5, 2)}}, {.friction = 0.5F, .category = 4});
    ASSERT_EQ(walls.size(), std::size_t{3});
    WallIndex index;
    index.build(scene);
    EXPECT_EQ(index.size(), std::size_t{13});
    EXPECT_EQ(index.first_hit({1, 1}, {-1, 1})->wall, walls[0]);
    EXPECT_EQ(index.first_hit({2.5, 1}, {2.5, 9}, 4)->wall, walls[1]);
    EXPECT_EQ(index.first_hit({6, 9}, {6, 1}, 4)->wall, walls[2]);
    EXPECT_TRUE(index.is_free({6, 9}, {6, 1}, ~4U));
    EXPECT_TRUE(scene.is_alive(before));
    scene.remove_wall(walls[1]);
    EXPECT_FALSE(scene.is_alive(walls[1]));
    EXPECT_TRUE(scene.is_alive(walls[2]));
}

TEST(Polygon, MayTouchItsHolesInPoints)
{
    const Ring room = square(0, 0, 10);
    EXPECT_EQ(verdict_on({room, {}}), "accepted");
    EXPECT_EQ(verdict_on({room, {{{0, 5}, {2, 4}, {2, 6}}}}), "accepted") << "in the middle of an edge";
    EXPECT_EQ(verdict_on({room, {{{0, 0}, {2, 1}, {1, 2}}}}), "accepted") << "in a corner";
    EXPECT_EQ(verdict_on({room, {square(2, 2, 1), square(3, 3, 1)}}), "accepted") << "each other";
    // On slanted edges the point of contact is rounded.
    const Ring slanted{{0, 0}, {10, 3}, {7, 11}};
    for (int k = 1; k < 100; ++k) {
        const double t = k / 100.0;
        const Vec2<double> on{10 * t, 3 * t};
        EXPECT_EQ(verdict_on({slanted, {{on, {6, 4}, {6.5, 5}}}}), "accepted") << t;
    }
    EXPECT_EQ(verdict_on({{{0, 10}, {10, 10}, {10, 0}, {0, 0}}, {square(1, 1, 1)}}), "accepted")
        << "clockwise";
}

TEST(Polygon, IsRefusedByRingPointAndPlace)
{
    const Ring room = square(0, 0, 10);
    EXPECT_EQ(verdict_on({{{0, 0}, {1, 0}}, {}}), "Polygon.outer.size() is 2; expected 3 or more points");
    EXPECT_EQ(verdict_on({room, {{}}}), "Polygon.holes[0].size() is 0; expected 3 or more points");
    EXPECT_EQ(verdict_on({{{0, 0}, {NAN, 0}, {0, 1}}, {}}),
              "Polygon.outer[1].x is nan; expected a finite value from -1e12 to 1e12 (m)");
    EXPECT_EQ(verdict_on({{{0, 0}, {1, 0}, {1, 1}, {0, 0}}, {}}),
              "Polygon.outer[3] is at the next point; expected neighbours at least 1e-6 m apart");
    EXPECT_EQ(
        verdict_on({{{0, 0}, {2, 2}, {2, 0}, {0, 2}}, {}}),
        "Polygon.outer[2] is (2 0), from where an edge meets that from Polygon.outer[0] at (1 1); expected a "
        "ring that does not meet itself");
    EXPECT_EQ(
        verdict_on({{{0, 0}, {4, 0}, {4, 4}, {2, 0}, {0, 4}}, {}}),
        "Polygon.outer[2] is (4 4), from where an edge meets that from Polygon.outer[0] at (2 0); expected a "
        "ring that does not meet itself");
    EXPECT_EQ(
        verdict_on({{{0, 0}, {4, 0}, {1, 0}, {1, 4}}, {}}),
        "Polygon.outer[1] is (4 0), from where an edge meets that from Polygon.outer[0] at (4 0); expected a "
        "ring that does not meet itself")
        << "an edge that runs back";
    EXPECT_EQ(verdict_on({room, {square(9, 4, 2)}}),
              "Polygon.holes[0][0] is (9 4), from where an edge meets that from Polygon.outer[1] at (10 4); "
              "expected "
              "rings that meet in points only");
    EXPECT_EQ(verdict_on({room, {square(8, 4, 2)}}),
              "Polygon.holes[0][1] is (10 4), from where an edge meets that from Polygon.outer[1] at (10 4); "
              "expected "
              "rings that meet in points only");
    EXPECT_EQ(verdict_on({room, {square(1, 1, 1), square(20, 4, 2)}}),
              "Polygon.holes[1][0] is (20 4), outside the outer ring; expected holes in the outer ring");
    EXPECT_EQ(verdict_on({room, {{{10, 5}, {12, 4}, {12, 6}}}}),
              "Polygon.holes[0][0] is (10 5), outside the outer ring; expected holes in the outer ring");
    EXPECT_EQ(verdict_on({room, {square(2, 2, 4), square(3, 3, 1)}}),
              "Polygon.holes[1][0] is (3 3), in Polygon.holes[0]; expected holes outside each other");
    EXPECT_EQ(verdict_on({room, {}}, {.friction = -1}), "WallDefinition.friction is -1; expected 0 to 1e9");
    EXPECT_EQ(verdict_on({room, {}}, {.points = room}),
              "add_polygon.like.points.size() is 4; expected no points");
}

/// A comb of n teeth, and the same with one point drawn across a gap, wherever that is.
TEST(Polygon, OfThousandsOfPointsIsCheckedWhole)
{
    const auto comb = [](int teeth) {
        Ring ring;
        for (int i = 0; i < teeth; ++i) {
            ring.push_back({static_cast<double>(i), 0});
            ring.push_back({i + 0.5, 5});
        }
        ring.push_back({static_cast<double>(teeth), -1});
        ring.push_back({0, -1});
        return ring;
    };
    EXPECT_EQ(verdict_on({comb(20000), {}}), "accepted");
    for (int k = 1; k < 20; ++k) {
        Ring bad = comb(1000);
        bad[static_cast<std::size_t>(2 * 50 * k)].x += 1.7;
        EXPECT_NE(verdict_on({bad, {}}).find("a ring that does not meet itself"), std::string::npos) << k;
    }
}

}  // namespace
}  // namespace motley
