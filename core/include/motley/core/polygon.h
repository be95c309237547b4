// Areas of the plane with holes: rooms with pillars, which become walls, and places in which people are looked for.
#pragma once

#include <vector>

#include "motley/core/scene.h"
#include "motley/core/vector.h"

#pragma GCC visibility push(default)
namespace motley {

/// An area. Each ring is a chain of points, m, world, whose last point is joined with its first and does not repeat it;
/// in any sense of rotation.
struct Polygon {
    std::vector<Vec2<double>> outer;
    std::vector<std::vector<Vec2<double>>> holes;
};

/// Adds each ring of a polygon as a closed wall, or nothing, and returns the walls: that of the outer ring, then those
/// of the holes. `like` says what all of them have; its points stay empty. With a body, the points are in its frame.
///
/// Refuses rings of fewer than three points, coordinates beyond -1e12 to 1e12 m, neighbours less than 1e-6 m apart, a
/// ring that meets itself, rings that cross each other or share a part of an edge, a hole that is not in the outer ring,
/// and a hole in another hole. Rings may touch in points. The message names the ring, the point and its coordinates.
std::vector<WallId> add_polygon(Scene& scene, const Polygon& polygon, const WallDefinition& like = {});

}  // namespace motley
#pragma GCC visibility pop
