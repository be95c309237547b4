// The definition of a pulley.
#pragma once

#include <limits>

#include "motley/core/ids.h"
#include "motley/core/vector.h"

#pragma GCC visibility push(default)
namespace motley {

/// A rope from an anchor p_a on a over two wheels fixed in the world to an anchor p_b on b. Keeps the length
/// |p_a - point_a| + ratio |p_b - point_b| from min_length to max_length; the ratio is that of a block and tackle on
/// b's side. Between bodies that stay in the plane (planar with planar, static or kinematic) only x and y count.
struct PulleyDefinition {
    BodyId body_a{};
    BodyId body_b{};
    Vec3<float> local_anchor_a{};  ///< m, -1e9 to 1e9, from a's centre of mass in its frame; particle: zero
    Vec3<float> local_anchor_b{};  ///< m, likewise of b
    Vec3<double> point_a{};        ///< m, world, -1e9 to 1e9: where the rope to a leaves its wheel
    Vec3<double> point_b{};        ///< m, world, likewise of the rope to b
    float ratio = 1;               ///< 1e-6 to 1e6
    float min_length = 0;  ///< m, 0 to max_length; equal to it: the rope pushes too, and is never slack
    float max_length = 1;  ///< m, to 1e9 or infinite
};

}  // namespace motley
#pragma GCC visibility pop
