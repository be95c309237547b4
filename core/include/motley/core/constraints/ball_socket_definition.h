// What a host says of a ball-socket joint.
#pragma once

#include "motley/core/ids.h"
#include "motley/core/vector.h"

namespace motley {

/// Holds a point of a on a point of b: C = p_b - p_a = 0, one row an axis that the pair can move along.
/// Between bodies that stay in the plane (planar with planar or fixed) only x and y count.
struct BallSocketDefinition {
    BodyId body_a{};
    BodyId body_b{};
    Vec3<float>
        local_anchor_a{};  ///< m, in the frame of a, from its centre of mass; a particle's must be zero
    Vec3<float> local_anchor_b{};  ///< m, in the frame of b, likewise
};

}  // namespace motley
