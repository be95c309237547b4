// What a host says of a distance joint.
#pragma once

#include <cstdint>

#include "motley/core/ids.h"
#include "motley/core/vector.h"

namespace motley {

/// How a distance joint answers C = |p_b - p_a| - length.
enum class DistanceMode : std::uint8_t {
    rod,     ///< C = 0: pushes and pulls
    rope,    ///< C <= 0: pulls only
    spring,  ///< a damped spring of its own stiffness
};

/// Holds, limits or springs the distance between two anchors.
/// Between bodies that stay in the plane (planar with planar or fixed) only x and y count.
struct DistanceDefinition {
    BodyId body_a{};
    BodyId body_b{};
    Vec3<float>
        local_anchor_a{};  ///< m, in the frame of a, from its centre of mass; a particle's must be zero
    Vec3<float> local_anchor_b{};  ///< m, in the frame of b, likewise
    DistanceMode mode = DistanceMode::rod;
    float length = 1;         ///< m, >= 0: of the rod, the longest of the rope, the rest length of the spring
    float hertz = 1;          ///< spring only: natural frequency on the joint's effective mass, > 0
    float damping_ratio = 0;  ///< spring only: 1 is critical, >= 0
};

}  // namespace motley
