// What a host says of a pulley.
#pragma once

#include <limits>

#include "motley/core/ids.h"
#include "motley/core/vector.h"

namespace motley {

/// A rope from an anchor on a over a wheel fixed in the world, to a second wheel and down to an anchor on b. Keeps
/// |p_a - point_a| + ratio |p_b - point_b| from min_length to max_length; ratio is that of a block and tackle.
/// Between bodies that stay in the plane only x and y count.
struct PulleyDefinition {
    BodyId body_a{};
    BodyId body_b{};
    Vec3<float> local_anchor_a{};  ///< m, in the frame of a; a particle's must be zero
    Vec3<float> local_anchor_b{};  ///< m, in the frame of b, likewise
    Vec3<double> point_a{};        ///< m, world, each coordinate within 1e9: where a's end leaves its wheel
    Vec3<double> point_b{};        ///< m, world, likewise
    float ratio = 1;               ///< 1e-6 to 1e6
    float min_length = 0;          ///< m, 0 to max_length; equal: a rope that never goes slack
    float max_length = 1;          ///< m, to 1e9 or infinite
};

}  // namespace motley
