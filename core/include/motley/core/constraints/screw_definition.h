// The definition of a screw.
#pragma once

#include "motley/core/ids.h"
#include "motley/core/vector.h"

#pragma GCC visibility push(default)
namespace motley {

/// Couples the motion of b along an axis of a to its rotation about that axis: `pitch` metres for every turn. Used
/// together with joints that keep b on the axis: a point on a line and parallel axes. There is no friction, so a nut
/// runs down under its weight. Turns are counted from when the joint was added or one of its bodies was teleported. Not
/// for particles, which do not turn.
struct ScrewDefinition {
    BodyId body_a{};
    BodyId body_b{};
    Vec3<float> local_anchor_a{};  ///< m, -1e9 to 1e9: on the axis, frame of a, from its centre of mass
    Vec3<float> local_anchor_b{};  ///< m, likewise of b
    Vec3<float> axis_a{1, 0, 0};   ///< in the frame of a, length 1e-6 to 1e6
    float pitch = 0.01F;           ///< m a turn, -1e6 to 1e6; > 0: right-handed; 0: b turns but cannot slide
};

}  // namespace motley
#pragma GCC visibility pop
