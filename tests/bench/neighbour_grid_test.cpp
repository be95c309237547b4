// The neighbour search by itself. Independent evidence: the test of every pair against every other, in double, on uniform
// crowds, clumps, discs at one point, discs in one line and a few discs far away.
#include "worlds/neighbour_grid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "mixed_scene.h"
#include "thread_executor.h"

namespace motley::bench {
namespace {

using motley::testing::Random;
using motley::testing::ThreadExecutor;

constexpr float margin = 0.03F;

struct Discs {
    const char* name;
    std::vector<Vec3<double>> positions;
    std::vector<float> radii;

    void add(double x, double y, float radius = 0.2F)
    {
        positions.push_back({x, y, 0});
        radii.push_back(radius);
    }
};

/// People in a square at 5 per m2, of different sizes.
Discs crowd(int count, Vec2<double> corner = {0, 0})
{
    Discs discs{"a crowd", {}, {}};
    Random random;
    const double side = std::sqrt(count / 5.0);
    for (int i = 0; i < count; ++i) {
        discs.add(corner.x + side * (random.symmetric() + 1) / 2,
                  corner.y + side * (random.symmetric() + 1) / 2,
                  static_cast<float>(0.2 + 0.05 * random.symmetric()));
    }
    return discs;
}

std::vector<Discs> every_kind()
{
    std::vector<Discs> all;
    all.push_back({"nobody", {}, {}});
    all.push_back({"one disc", {}, {}});
    all.back().add(3, -4);
    all.push_back(crowd(3000));
    Random random(7);
    all.push_back({"clumps", {}, {}});
    for (int clump = 0; clump < 12; ++clump) {
        const double x = 40 * random.symmetric(), y = 40 * random.symmetric();
        for (int i = 0; i < 120; ++i)
            all.back().add(x + 0.3 * random.symmetric(), y + 0.3 * random.symmetric());
    }
    all.push_back({"discs at one point", {}, {}});
    for (int i = 0; i < 150; ++i) all.back().add(5, 5);
    for (int i = 0; i < 150; ++i) all.back().add(7, 5);
    all.push_back({"one large disc among small ones", {}, {}});
    all.back().add(0, 0, 4);
    for (int i = 0; i < 1500; ++i) all.back().add(10 * random.symmetric(), 10 * random.symmetric(), 0.1F);
    all.push_back({"a line", {}, {}});
    for (int i = 0; i < 2500; ++i) all.back().add(0.41 * i + 0.02 * random.symmetric(), 0);
    all.push_back({"a line across rows, more of them than bands", {}, {}});
    for (int i = 0; i < 2500; ++i) all.back().add(0, 0.41 * i + 0.02 * random.symmetric());
    for (const double far : {3e2, 1e4, 1e6}) {
        for (const double sign : {-1.0, 1.0}) {
            all.push_back(crowd(1500));
            all.back().name = "a crowd and a few far away";
            all.back().add(sign * far, 3);
            all.back().add(sign * far, 3.3);
            all.back().add(4, sign * far);
            all.back().add(-sign * far, sign * far);
        }
    }
    return all;
}

struct Found {
    std::vector<std::pair<std::int32_t, std::int32_t>> pairs;  ///< in the order of the search
    std::int64_t chunks = 0;
    std::size_t room = 0;  ///< the most pairs that a chunk made room for
};

/// Sorts and searches on so many threads.
Found search(const Discs& discs, int threads)
{
    ThreadExecutor executor(threads, threads - 1);
    NeighbourGrid grid;
    grid.sort(discs.positions, discs.radii, margin, executor);
    Found found;
    found.chunks = grid.chunk_count();
    std::vector<std::vector<NeighbourGrid::Pair>> lists(static_cast<std::size_t>(found.chunks));
    std::vector<std::size_t> counts(lists.size());
    parallel_for(executor, found.chunks, 1, [&](std::int64_t chunk, std::int64_t) {
        const auto c = static_cast<std::size_t>(chunk);
        counts[c] = grid.find_pairs(chunk, lists[c]);
    });
    for (std::size_t c = 0; c < lists.size(); ++c) {
        found.room = std::max(found.room, lists[c].size());
        for (std::size_t i = 0; i < counts[c]; ++i) found.pairs.emplace_back(lists[c][i].a, lists[c][i].b);
    }
    return found;
}

/// How far rounding may move the distance of two discs in the grid, which keeps floats from its corner: half a unit in
/// the last place of each of four coordinates, and as much again for the sums.
double rounding(const Discs& discs)
{
    double low = 1e300, high = -1e300;
    for (const Vec3<double>& p : discs.positions) {
        low = std::min({low, p.x, p.y});
        high = std::max({high, p.x, p.y});
    }
    return 1e-6 + 8 * std::ldexp(std::max(0.0, high - low), -24);
}

TEST(NeighbourGrid, FindsThePairsThatComparingAllWithAllFinds)
{
    for (const Discs& discs : every_kind()) {
        const Found found = search(discs, 1);
        std::set<std::pair<std::int32_t, std::int32_t>> listed;
        for (const auto& [a, b] : found.pairs) {
            ASSERT_NE(a, b) << discs.name;
            EXPECT_TRUE(listed.emplace(std::min(a, b), std::max(a, b)).second)
                << discs.name << ": a pair twice";
        }
        const double blur = rounding(discs);
        std::size_t near = 0;
        for (std::size_t a = 0; a < discs.positions.size(); ++a) {
            for (std::size_t b = a + 1; b < discs.positions.size(); ++b) {
                const double gap = std::hypot(discs.positions[a].x - discs.positions[b].x,
                                              discs.positions[a].y - discs.positions[b].y) -
                                   static_cast<double>(discs.radii[a]) - static_cast<double>(discs.radii[b]);
                const bool is_listed =
                    listed.contains({static_cast<std::int32_t>(a), static_cast<std::int32_t>(b)});
                near += gap < static_cast<double>(margin) ? 1 : 0;
                // Rounding may hide a pair by a hundredth of the margin at most: beyond that the search reaches farther.
                const double missed_from = std::min(blur, 0.01 * static_cast<double>(margin));
                if (gap < static_cast<double>(margin) - missed_from) {
                    ASSERT_TRUE(is_listed)
                        << discs.name << ": " << a << " and " << b << " have a gap of " << gap;
                } else if (gap > static_cast<double>(margin) + 2 * blur) {
                    ASSERT_FALSE(is_listed)
                        << discs.name << ": " << a << " and " << b << " have a gap of " << gap;
                }
            }
        }
        if (discs.positions.size() > 1) {
            EXPECT_GT(near, discs.positions.size() / 4) << discs.name << ": else nothing was tested";
        }
    }
}

TEST(NeighbourGrid, ListsPairsInAnOrderThatThreadsDoNotChange)
{
    for (const Discs& discs : every_kind()) {
        const Found alone = search(discs, 1);
        for (const int threads : {2, 3, 5})
            EXPECT_EQ(search(discs, threads).pairs, alone.pairs) << discs.name;
    }
    // Of several chunks of discs, bands of rows and chunks of cells.
    const Discs large = crowd(40'000);
    const Found alone = search(large, 1);
    EXPECT_GT(alone.chunks, 10);
    EXPECT_EQ(search(large, 4).pairs, alone.pairs);
}

TEST(NeighbourGrid, SomebodyFarAwayCostsNoMemory)
{
    // With cells of a kilometre the whole crowd is in one, and its pairs must not get room as if all were near all.
    Discs discs = crowd(4000);
    discs.add(5e6, 5e6);
    const Found found = search(discs, 1);
    EXPECT_GT(found.pairs.size(), 4000U);
    EXPECT_LT(found.room, 2 * (found.pairs.size() + discs.positions.size()) + 1024);
    // Along a line an area has no cells, but the line itself has.
    Discs line{"a line", {}, {}};
    line.add(0, 0);
    line.add(0.3, 0);
    line.add(1e9, 0);
    const Found few = search(line, 1);
    EXPECT_EQ(few.pairs.size(), 1U);
    EXPECT_LT(few.chunks, 1 << 24);
}

TEST(NeighbourGrid, VisitsEveryDiscInABoxOnce)
{
    const Discs discs = crowd(2000);
    ThreadExecutor executor(1, 0);
    NeighbourGrid grid;
    grid.sort(discs.positions, discs.radii, margin, executor);
    const Vec2<double> low{3, 5}, high{11, 6};
    std::vector<int> visits(discs.positions.size());
    for (std::int64_t chunk = 0; chunk < grid.chunk_count(); ++chunk)
        grid.for_each_disc_in(chunk, low, high,
                              [&](std::int32_t i) { ++visits[static_cast<std::size_t>(i)]; });
    for (std::size_t i = 0; i < visits.size(); ++i) {
        const Vec3<double>& p = discs.positions[i];
        const bool inside = p.x >= low.x && p.x <= high.x && p.y >= low.y && p.y <= high.y;
        EXPECT_LE(visits[i], 1);
        if (inside) {
            EXPECT_EQ(visits[i], 1) << p.x << ", " << p.y;
        }
    }
}

}  // namespace
}  // namespace motley::bench
