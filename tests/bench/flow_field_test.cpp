// Flow fields, and the crowd that follows them. Independent evidence: distances that are known, and the places of people.
#include "worlds/flow_field.h"

#include <gtest/gtest.h>

#include <cmath>

#include "measuring/runner.h"

namespace motley::bench {
namespace {

using Cell = FlowField::Cell;

/// A goal in a corner of an open square: distances are those of a king with diagonal steps of the square root of two.
TEST(FlowField, OfAnOpenSquareLeadsStraight)
{
    constexpr int side = 20;
    std::vector<Cell> cells(side * side, Cell::open);
    cells[0] = Cell::goal;
    const FlowField field(side, cells);
    for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
            const Vec2<double> at{x + 0.5, y + 0.5};
            const double expected = std::max(x, y) + (std::sqrt(2.0) - 1) * std::min(x, y);
            EXPECT_NEAR(field.distance(at), expected, 1e-4);
            const Vec2<float> direction = field.direction(at);
            if (x + y == 0) {
                EXPECT_EQ(dot(direction, direction), 0);
                continue;
            }
            EXPECT_NEAR(dot(direction, direction), 1, 1e-5);
            // Within an eighth of a turn of the straight line.
            const double towards =
                -(static_cast<double>(direction.x) * x + static_cast<double>(direction.y) * y);
            EXPECT_GT(towards, std::cos(3.14159265 / 4) * std::hypot(x, y) - 1e-5);
        }
    }
}

/// A wall across the square with a gap at one end: whoever follows the field comes through the gap to the goal.
TEST(FlowField, LeadsAroundWalls)
{
    constexpr int side = 15;
    std::vector<Cell> cells(side * side, Cell::open);
    for (int x = 0; x < side - 2; ++x) cells[static_cast<std::size_t>(7 * side + x)] = Cell::closed;
    cells[0] = Cell::goal;
    const FlowField field(side, cells);
    EXPECT_EQ(field.distance({3.5, 7.5}), INFINITY);
    Vec2<double> at{0.5, 14.5};
    double walked = 0;
    while (field.distance(at) > 0 && walked < 60) {
        const Vec2<float> direction = field.direction(at);
        at =
            at + Vec2<double>{0.1 * static_cast<double>(direction.x), 0.1 * static_cast<double>(direction.y)};
        walked += 0.1;
        const bool is_in_wall = at.y >= 7 && at.y < 8 && at.x < side - 2 && at.x > side - 2.2;
        ASSERT_TRUE(is_in_wall || field.distance(at) < INFINITY) << "at " << at.x << ", " << at.y;
        if (is_in_wall) at.x = side - 2;  // the wall holds who cuts its corner
    }
    EXPECT_EQ(field.distance(at), 0) << "at " << at.x << ", " << at.y;
    EXPECT_LT(walked, 40);
}

/// People walk, none of them through a wall or a pillar, and threads do not change a bit.
TEST(Flow, EverybodyWalksAndNobodyThroughAWall)
{
    std::uint64_t hash = 0;
    for (const double density : {2.0, 5.0}) {
        for (const int threads : {1, 2}) {
            RunOptions options;
            options.agents = 3000;
            options.seconds = 4;
            options.density = density;
            options.solver = {.threads = threads, .alone_below = 0};
            RunOutputs quiet;
            quiet.progress = false;
            const RunResult result = run_scene(*find_scene("flow"), options, quiet);
            for (const Mark& mark : result.marks)
                EXPECT_TRUE(mark.passes()) << mark.name << ": " << mark.value;
            ASSERT_EQ(result.figures[0].first, "speed, mean (m/s)");
            EXPECT_GT(result.figures[0].second, density == 2 ? 0.2 : 0.1);
            if (threads == 1) hash = result.state_hash;
            EXPECT_EQ(result.state_hash, hash);
        }
    }
}

}  // namespace
}  // namespace motley::bench
