// The definition of a ball-socket joint.
#pragma once

#include "motley/core/ids.h"
#include "motley/core/vector.h"

#pragma GCC visibility push(default)
namespace motley {

/// Holds an anchor p_a of body a on an anchor p_b of body b: C = p_b - p_a = 0. Three rows, but only x and y between
/// bodies that stay in the plane (planar with planar, static or kinematic).
struct BallSocketDefinition {
    BodyId body_a{};
    BodyId body_b{};
    Vec3<float> local_anchor_a{};  ///< m, -1e9 to 1e9, from a's centre of mass in its frame; particle: zero
    Vec3<float> local_anchor_b{};  ///< m, likewise of b
};

}  // namespace motley
#pragma GCC visibility pop
