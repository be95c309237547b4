// Where walls are now, and how fast they move.
#pragma once

#include <vector>

#include "scene/scene_core.h"

namespace motley {

/// A position without its height.
inline Vec2<double> in_plane(const Vec3<PoseReal>& at)
{
    return {static_cast<double>(at.x), static_cast<double>(at.y)};
}

/// Writes where the ends of the segments of walls are, m, world, two a segment. Allocates only what the vector lacks.
void find_wall_ends(const SceneCore& scene, std::vector<Vec2<double>>& ends);
/// The speed of the fastest end of a wall, m/s.
double fastest_wall_end(const SceneCore& scene);

}  // namespace motley
