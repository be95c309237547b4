// Where walls are now.
#pragma once

#include <vector>

#include "scene/scene_core.h"

namespace motley {

/// Writes where the ends of the segments of walls are, m, world, two a segment. Allocates only what the vector lacks.
void find_wall_ends(const SceneCore& scene, std::vector<Vec2<double>>& ends);

}  // namespace motley
