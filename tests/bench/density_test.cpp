// Densities by square metres and by Voronoi cells. Independent evidence: lattices, and that the cells of a room make up the
// room.
#include "worlds/density.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "worlds/random.h"

namespace motley::bench {
namespace {

std::vector<double> densities_of(const View& view, double reach)
{
    Solver threads(SolverSettings{}, {.threads = 2});
    return voronoi_densities(view, reach, threads.executor());
}

TEST(Density, SquareMetresBeginAtWholeMetres)
{
    const Vec2<double> people[] = {{-0.5, 3.2}, {-0.01, 3.99}, {0, 3}, {2.5, 5.5}};
    const DensityField field = density_field(people);
    EXPECT_EQ(field.low.x, -1);
    EXPECT_EQ(field.low.y, 3);
    ASSERT_EQ(field.columns, 4);
    ASSERT_EQ(field.rows, 3);
    EXPECT_EQ(field.at(0, 0), 2);
    EXPECT_EQ(field.at(1, 0), 1);
    EXPECT_EQ(field.at(3, 2), 1);
    EXPECT_EQ(std::accumulate(field.people.begin(), field.people.end(), 0.0), 4);
    EXPECT_TRUE(density_field({}).people.empty());
}

/// The cell of a hexagonal lattice of pitch d is sqrt(3)/2 d^2, also across the seam of a period.
TEST(Density, OfALatticeIsThatOfItsCell)
{
    constexpr double pitch = 0.4;
    const double row = pitch * std::sqrt(3.0) / 2;
    View view;
    for (int i = 0; i < 12; ++i) {
        for (int k = 0; k < 20; ++k) view.people.push_back({row * i, pitch * (k + 0.5 * (i % 2))});
    }
    view.period_y = 20 * pitch;
    const std::vector<double> densities = densities_of(view, 1);
    for (std::size_t i = 4 * 20; i < 8 * 20; ++i) EXPECT_NEAR(densities[i], 1 / (row * pitch), 1e-9) << i;
}

/// The cells of all people in a convex room make up its area, whoever stands where.
TEST(Density, CellsOfARoomMakeUpTheRoom)
{
    Random random(5);
    for (const std::size_t count : {1U, 2U, 7U, 300U, 3000U}) {
        View view;
        const Vec2<double> corners[] = {{10, -3}, {16, -3}, {18, 2}, {16, 5}, {10, 5}};
        for (std::size_t i = 0; i < 5; ++i) view.walls.push_back({corners[i], corners[(i + 1) % 5]});
        while (view.people.size() < count)
            view.people.push_back({10 + 6 * random.uniform(), -3 + 8 * random.uniform()});
        double sum = 0;
        for (const double density : densities_of(view, 40)) sum += 1 / density;
        // 6 x 8, and a triangle of height 2 on a side of 8.
        EXPECT_NEAR(sum, 48 + 8, 1e-6) << count << " people";
    }
}

TEST(Density, OfOneAloneIsThatOfTheCutOff)
{
    View view;
    view.people = {{5, 5}};
    const double polygon = 16 * std::sin(2 * 3.14159265358979 / 32);
    EXPECT_NEAR(densities_of(view, 1)[0], 1 / polygon, 1e-9);
    view.walls = {{{4, 4.5}, {6, 4.5}}};
    EXPECT_GT(densities_of(view, 1)[0], 1.2 / polygon) << "a wall 0.5 m away takes a fifth";
    view.walls = {{{6, 4.5}, {8, 4.5}}};
    EXPECT_NEAR(densities_of(view, 1)[0], 1 / polygon, 1e-9) << "not beside the wall";
}

TEST(Density, PeopleOnOneSpotShareACell)
{
    View view;
    view.people = {{0, 0}, {0, 0}, {0.5, 0}};
    const std::vector<double> densities = densities_of(view, 1);
    EXPECT_EQ(densities[0], densities[1]);
    for (const double density : densities) EXPECT_TRUE(std::isfinite(density) && density > 0);
}

}  // namespace
}  // namespace motley::bench
