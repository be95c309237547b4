// Polygons of the C interface.
#pragma once

#include "handles.h"
#include "motley/c/crowd.h"
#include "motley/core/polygon.h"

namespace motley::c {

inline std::vector<Vec2<double>> points_of(const motley_ring& ring)
{
    const auto points = array<const Vec2<double>>(ring.points, ring.point_count, "motley_ring.points");
    return {points.begin(), points.end()};
}

/// The first ring is the outline, the others are holes.
inline Polygon polygon_of(const motley_ring* rings, std::size_t count)
{
    if (count == 0) refuse("ring_count", 0, "1 or more: the outline, then the holes");
    check_array(rings, count, sizeof *rings, sizeof *rings, alignof(motley_ring), "rings");
    Polygon polygon{.outer = points_of(rings[0]), .holes = {}};
    for (std::size_t i = 1; i < count; ++i) polygon.holes.push_back(points_of(rings[i]));
    return polygon;
}

}  // namespace motley::c
