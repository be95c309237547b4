// How close people stand: on each square metre, and around each person.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "motley/motley.h"
#include "worlds/bench_scene.h"
#include "worlds/view.h"

namespace motley::bench {

/// The people on each square metre of a grid.
struct DensityField {
    Vec2<double> low{};  ///< m, world, the corner of the first cell
    std::int32_t columns = 0, rows = 0;
    std::vector<double> people;  ///< by cell, row by row from low y
    [[nodiscard]] double at(std::int32_t column, std::int32_t row) const
    {
        return people[static_cast<std::size_t>(row * columns + column)];
    }
};
/// Cells begin at whole metres.
DensityField density_field(std::span<const Vec2<double>> people);

/// 1/m2, of each person: one over the area nearer to this person than to anybody else (G. Voronoi's cell; B. Steffen and
/// A. Seyfried, "Methods for measuring pedestrian density, flow, speed and direction with minimal scatter", 2010), at most
/// `reach` m away and on this side of the walls. A wall that reaches into
/// a cell bounds it along its whole line. The cut-off is a polygon of 32 corners.
std::vector<double> voronoi_densities(const View& view, double reach, Executor& executor);

/// m: the cut-off with which densities are told and drawn.
inline constexpr double density_reach = 1;

/// Mean, 95th percentile and highest density on the square metres that have anybody, and around each person, each with its name.
std::vector<Figure> density_figures(const View& view, Executor& executor);

}  // namespace motley::bench
