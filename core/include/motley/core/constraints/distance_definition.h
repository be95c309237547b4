// What a host says of a distance joint.
#pragma once

#include <limits>

#include "motley/core/ids.h"
#include "motley/core/vector.h"

namespace motley {

/// Keeps the distance between two anchors from min_length to max_length, with a spring in between if asked for. Equal
/// lengths are a rod; 0 and a length a rope; 0 and infinity leave the spring alone.
/// Between bodies that stay in the plane (planar with planar or fixed) only x and y count.
struct DistanceDefinition {
    BodyId body_a{};
    BodyId body_b{};
    Vec3<float>
        local_anchor_a{};  ///< m, in the frame of a, from its centre of mass; a particle's must be zero
    Vec3<float> local_anchor_b{};  ///< m, in the frame of b, likewise
    float min_length = 1;          ///< m, 0 to max_length
    float max_length = 1;          ///< m, to 1e9 or infinite

    float spring_hertz = 0;          ///< 0: no spring; to 1e6 (Hz), on the joint's own effective mass
    float spring_damping_ratio = 0;  ///< 0 to 1e6; 1 is critical
    float rest_length = 1;           ///< m, 0 to 1e9: where the spring rests
    float spring_max_force = std::numeric_limits<float>::infinity();  ///< N, >= 0
};

}  // namespace motley
