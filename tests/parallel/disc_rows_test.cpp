// Bodies with discs are sorted in memory by place, and nobody sees it. That bits stay is in disc_bits_test.cpp.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "crowd/disc_finder.h"
#include "disc_crowd.h"
#include "scene/scene_core.h"

namespace motley {
namespace {

using testing::DiscCrowd;
using testing::Random;

constexpr float dt = 1.0F / 60;

/// Discs whose rows in memory follow each other in the order of the strips.
std::size_t rows_in_line(const DiscStore& discs)
{
    std::size_t in_line = 0;
    for (std::size_t i = 1; i < discs.rows_by_place.size(); ++i)
        in_line += discs.rows_by_place[i] == discs.rows_by_place[i - 1] + 1 ? 1 : 0;
    return in_line;
}

TEST(DiscRows, AreSortedByPlaceInMemory)
{
    std::vector<int> order(3000);
    std::iota(order.begin(), order.end(), 0);
    Random random;
    for (std::size_t i = order.size(); i > 1; --i)
        std::swap(order[i - 1], order[static_cast<std::size_t>(random.below(static_cast<int>(i)))]);
    DiscCrowd crowd({.people = 3000}, order);
    Solver solver(SolverSettings{});
    ASSERT_EQ(solver.step(crowd.scene, dt).status, StepStatus::done);
    const DiscStore& discs = core_of(crowd.scene).discs;
    EXPECT_TRUE(discs.wants_sorting);
    EXPECT_LT(rows_in_line(discs), 100U);
    // A body that is added, and one that is removed, before the rows are sorted.
    crowd.scene.remove_body(crowd.people[7]);
    crowd.people.erase(crowd.people.begin() + 7);
    crowd.discs.erase(crowd.discs.begin() + 7);
    BodyDefinition body;
    body.model = BodyModel::planar;
    body.inertia.zz = 1;
    body.position = {-3, 4, 0};
    const BodyId one = crowd.scene.add_body(body), two = crowd.scene.add_body(body);
    const auto speeds_of = [&] {
        std::vector<Vec3<float>> speeds(crowd.people.size());
        crowd.scene.read_velocities(crowd.people, std::span(speeds));
        return speeds;
    };
    const auto before = speeds_of();
    core_of(crowd.scene).sort_disc_rows();
    const auto after = speeds_of();
    EXPECT_TRUE(std::equal(before.begin(), before.end(), after.begin(),
                           [](const auto& v, const auto& w) { return v.x == w.x && v.y == w.y; }));
    EXPECT_FALSE(discs.wants_sorting);
    EXPECT_EQ(rows_in_line(discs), discs.rows_by_place.size() - 1);
    EXPECT_EQ(crowd.scene.state(one).position.x, -3);
    EXPECT_EQ(crowd.scene.state(two).position.y, 4);
    for (int step = 0; step < 30; ++step) {
        crowd.pull_together(20);
        ASSERT_EQ(solver.step(crowd.scene, dt).status, StepStatus::done);
    }
    EXPECT_FALSE(DiscFinder::are_rows_scattered(discs));
    EXPECT_LT(crowd.deepest_overlap(), 0.01);
}

}  // namespace
}  // namespace motley
