// What walls hide. Independent evidence: every piece of every wall is asked, in long double, and closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "mixed_scene.h"

namespace motley {
namespace {

using testing::Random;

struct KnownWall {
    WallId wall;
    std::vector<Vec2<double>> points;  ///< world
    std::uint32_t category;
};

/// The fraction at which the way from p to q meets the piece from a to b, or nothing; by Cramer's rule.
std::optional<long double> meeting(const Vec2<double>& p, const Vec2<double>& q, const Vec2<double>& a,
                                   const Vec2<double>& b)
{
    const long double dx = static_cast<long double>(q.x) - p.x, dy = static_cast<long double>(q.y) - p.y;
    const long double ex = static_cast<long double>(b.x) - a.x, ey = static_cast<long double>(b.y) - a.y;
    const long double fx = static_cast<long double>(a.x) - p.x, fy = static_cast<long double>(a.y) - p.y;
    const long double determinant = dx * ey - dy * ex;
    const long double t = (fx * ey - fy * ex) / determinant, u = (fx * dy - fy * dx) / determinant;
    if (!(t >= 0 && t <= 1 && u >= 0 && u <= 1)) return {};
    return t;
}

struct Maze {
    Scene scene;
    std::vector<KnownWall> walls;

    void add(std::vector<Vec2<double>> points, bool closed, std::uint32_t category = 1)
    {
        const WallId wall = scene.add_wall({.points = points, .closed = closed, .category = category});
        if (closed) points.push_back(points[0]);
        walls.push_back({wall, points, category});
    }
};

/// Long walls among short ones, and some far away.
Maze maze_of(int walls, std::uint64_t seed)
{
    Maze maze;
    Random random(seed);
    for (int i = 0; i < walls; ++i) {
        const double size = i % 20 == 0 ? 100 : i % 31 == 0 ? 1e5 : 1;
        std::vector<Vec2<double>> points{{50 * random.symmetric(), 50 * random.symmetric()}};
        if (i % 40 == 39) points[0] = 2e4 * points[0];
        for (int k = 0; k < 2 + i % 4; ++k)
            points.push_back(points.back() +
                             Vec2<double>{size * random.symmetric(), size * random.symmetric()});
        maze.add(points, i % 3 == 0, 1U << i % 5);
    }
    return maze;
}

void expect_right_answers(const Maze& maze, const WallIndex& index, std::uint64_t seed)
{
    Random random(seed);
    for (int query = 0; query < 2000; ++query) {
        const double reach = query % 3 == 0 ? 3 : 60;
        const Vec2<double> from{60 * random.symmetric(), 60 * random.symmetric()};
        const Vec2<double> to = from + Vec2<double>{reach * random.symmetric(), reach * random.symmetric()};
        const std::uint32_t mask = query % 2 == 0 ? UINT32_MAX : 5;
        std::optional<long double> first;
        WallId wall;
        for (const KnownWall& known : maze.walls) {
            if ((known.category & mask) == 0) continue;
            for (std::size_t i = 0; i + 1 < known.points.size(); ++i) {
                const auto met = meeting(from, to, known.points[i], known.points[i + 1]);
                if (met && (!first || *met < *first)) {
                    first = met;
                    wall = known.wall;
                }
            }
        }
        const std::optional<WallHit> hit = index.first_hit(from, to, mask);
        EXPECT_EQ(index.is_free(from, to, mask), !first);
        ASSERT_EQ(hit.has_value(), first.has_value());
        if (!hit) continue;
        EXPECT_EQ(hit->wall, wall);
        EXPECT_NEAR(hit->fraction, static_cast<double>(*first), 1e-9);
    }
}

TEST(WallIndex, FindsTheFirstWallThatASearchOfAllFinds)
{
    for (const int walls : {0, 1, 5, 40, 2000}) {
        const Maze maze = maze_of(walls, 11 + static_cast<std::uint64_t>(walls));
        WallIndex index;
        index.build(maze.scene);
        SCOPED_TRACE(walls);
        expect_right_answers(maze, index, 1);
    }
}

TEST(WallIndex, IsRightAfterWallsAreRemovedAndAdded)
{
    Maze maze = maze_of(200, 4);
    WallIndex index;
    index.build(maze.scene);
    for (int round = 0; round < 5; ++round) {
        for (int i = 0; i < 20; ++i) {
            const std::size_t which = static_cast<std::size_t>(i * 7 + round) % maze.walls.size();
            maze.scene.remove_wall(maze.walls[which].wall);
            maze.walls.erase(maze.walls.begin() + static_cast<std::ptrdiff_t>(which));
        }
        maze.add({{-40.0 + round, -30}, {20, 35.0 + round}}, false);
        EXPECT_FALSE(index.is_current(maze.scene));
        index.build(maze.scene);
        EXPECT_TRUE(index.is_current(maze.scene));
        expect_right_answers(maze, index, static_cast<std::uint64_t>(round));
    }
}

TEST(WallIndex, LetsNothingPassWherePiecesMeet)
{
    Scene scene;
    Random random(9);
    std::vector<Vec2<double>> ring;
    for (int i = 0; i < 400; ++i) {
        const double angle = 6.283185307179586 * i / 400, radius = 10 + random.symmetric();
        ring.push_back({1e3 + radius * std::cos(angle), -2e3 + radius * std::sin(angle)});
    }
    scene.add_wall({.points = ring, .closed = true});
    WallIndex index;
    index.build(scene);
    for (const Vec2<double>& corner : ring) {
        // Straight through the corner, from the middle and to it.
        const Vec2<double> middle{1e3, -2e3}, beyond = middle + 1.7 * (corner - middle);
        EXPECT_FALSE(index.is_free(middle, beyond));
        EXPECT_FALSE(index.is_free(beyond, middle));
        EXPECT_FALSE(index.is_free(middle, corner));
        EXPECT_TRUE(index.is_free(middle, middle + 0.5 * (corner - middle)));
    }
}

TEST(WallIndex, CountsTouchingBeginningAndRunningAlong)
{
    Scene scene;
    const Vec2<double> bottom[] = {{0, 0}, {4, 0}}, side[] = {{4, 0}, {4, 4}};
    const WallId first = scene.add_wall({.points = bottom}), second = scene.add_wall({.points = side});
    WallIndex index;
    index.build(scene);
    const auto expect_hit = [&](const Vec2<double>& from, const Vec2<double>& to, WallId wall,
                                double fraction) {
        const std::optional<WallHit> hit = index.first_hit(from, to);
        ASSERT_TRUE(hit);
        EXPECT_EQ(hit->wall, wall);
        EXPECT_DOUBLE_EQ(hit->fraction, fraction);
        EXPECT_FALSE(index.is_free(from, to));
    };
    expect_hit({1, 1}, {1, -3}, first, 0.25);
    expect_hit({1, 1}, {1, 0}, first, 1);
    expect_hit({1, 0}, {1, 1}, first, 0);
    expect_hit({2, 0}, {2, 0}, first, 0);
    expect_hit({-4, 0}, {4, 0}, first, 0.5);   // along the wall
    expect_hit({8, 0}, {-8, 0}, first, 0.25);  // the corner is of both: the least slot
    expect_hit({3, 1}, {5, 1}, second, 0.5);
    EXPECT_TRUE(index.is_free({-4, 0}, {-1, 0}));
    EXPECT_TRUE(index.is_free({5, 0}, {9, 0}));
    EXPECT_TRUE(index.is_free({1, 1}, {1, 1}));
    EXPECT_TRUE(index.is_free({1, 1}, {3, 1e-9}));
    EXPECT_TRUE(index.is_free({1, 1}, {1, -1}, 2)) << "no wall has this category";
}

/// A door on a kinematic body hides what is behind it where the body is now.
TEST(WallIndex, FollowsBodiesThatMove)
{
    Scene scene;
    BodyDefinition hinge;
    hinge.motion = BodyMotion::kinematic_body;
    hinge.position = {10, 0, 0};
    const BodyId body = scene.add_body(hinge);
    const Vec2<double> door[] = {{0, 0}, {2, 0}};
    scene.add_wall({.points = door, .body = body});
    WallIndex index;
    index.build(scene);
    EXPECT_FALSE(index.is_free({11, -1}, {11, 1}));
    EXPECT_TRUE(index.is_free({9, 1}, {11, 1}));
    // A quarter turn.
    scene.set_pose(body, {10, 0, 0}, {0, 0, std::sqrt(0.5), std::sqrt(0.5)}, 0);
    EXPECT_FALSE(index.is_current(scene));
    index.build(scene);
    EXPECT_TRUE(index.is_free({11, -1}, {11, 1}));
    ASSERT_TRUE(index.first_hit({9, 1}, {11, 1}));
    EXPECT_NEAR(index.first_hit({9, 1}, {11, 1})->fraction, 0.5, 1e-12);
    scene.remove_body(body);
    EXPECT_FALSE(index.is_current(scene));
    index.build(scene);
    EXPECT_EQ(index.size(), std::size_t{0});
    EXPECT_TRUE(index.is_free({9, 1}, {11, 1}));
}

TEST(WallIndex, RefusesWhatIsNoPlaceByName)
{
    const WallIndex index;
    std::string message;
    try {
        (void)index.first_hit({0, 0}, {0, INFINITY});
    } catch (const InvalidInput& refused) {
        message = refused.what();
    }
    EXPECT_EQ(message, "first_hit.to.y is inf; expected a finite value from -1e12 to 1e12 (m)");
}

}  // namespace
}  // namespace motley
