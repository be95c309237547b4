// The definition of a distance joint.
#pragma once

#include <limits>

#include "motley/core/ids.h"
#include "motley/core/vector.h"

#pragma GCC visibility push(default)
namespace motley {

/// Keeps the distance between two anchors from min_length to max_length, with a spring along it if asked for. Equal
/// lengths make a rod, 0 and a length a rope, 0 and infinity a spring without limits. Between bodies that stay in the
/// plane (planar with planar, static or kinematic) only x and y count.
struct DistanceDefinition {
    BodyId body_a{};
    BodyId body_b{};
    Vec3<float> local_anchor_a{};  ///< m, -1e9 to 1e9, from a's centre of mass in its frame; particle: zero
    Vec3<float> local_anchor_b{};  ///< m, likewise of b
    float min_length = 1;          ///< m, 0 to max_length
    float max_length = 1;          ///< m, to 1e9 or infinite

    // A spring, given either by a frequency of the mass that it moves, or by a stiffness and a damping; not by both.
    float spring_hertz = 0;          ///< Hz, to 1e6, on the joint's own effective mass; 0: none
    float spring_damping_ratio = 0;  ///< 0 to 1e6; 1 is critical
    /// N/m, 0 to 1e12; independent of the masses. Integrated implicitly: stable at any stiffness, but oscillations faster than
    /// a substep are damped.
    float spring_stiffness = 0;
    float spring_damping = 0;  ///< N s/m, 0 to 1e12; without a stiffness a damper
    float rest_length = 1;     ///< m, 0 to 1e9: where the spring rests
    float spring_max_force = std::numeric_limits<float>::infinity();  ///< N, >= 0, or infinite

    [[nodiscard]] bool has_spring() const
    {
        return spring_hertz > 0 || spring_stiffness > 0 || spring_damping > 0;
    }
};

}  // namespace motley
#pragma GCC visibility pop
