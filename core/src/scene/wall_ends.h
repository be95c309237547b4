// Where walls are now, and how fast they move.
#pragma once

#include <algorithm>
#include <utility>

#include "scene/scene_core.h"
#include "stores/array.h"

namespace motley {

/// A position without its height.
inline Vec2<double> in_plane(const Vec3<PoseReal>& at)
{
    return {static_cast<double>(at.x), static_cast<double>(at.y)};
}

/// The square of the distance of a point from a segment, m2.
inline double distance2(const Vec2<double>& point, const Vec2<double>& from, const Vec2<double>& to)
{
    const Vec2<double> along = to - from;
    const double t = std::clamp(dot(along, point - from) / dot(along, along), 0.0, 1.0);
    const Vec2<double> apart = point - (from + t * along);
    return dot(apart, apart);
}

/// Where the ends of a segment are, m, world.
std::pair<Vec2<double>, Vec2<double>> wall_ends_of(const SceneCore& scene, const WallSegment& segment);
/// Writes where the ends of the segments of walls are, m, world, two a segment. Allocates only what the vector lacks.
void find_wall_ends(const SceneCore& scene, Array<Vec2<double>>& ends);
/// The speed of the faster end of a segment, m/s, and of the fastest end of all walls.
double speed_of_wall(const SceneCore& scene, const WallSegment& segment);
double fastest_wall_end(const SceneCore& scene);

}  // namespace motley
