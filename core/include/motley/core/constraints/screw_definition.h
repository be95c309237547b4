// What a host says of a screw.
#pragma once

#include "motley/core/ids.h"
#include "motley/core/vector.h"

namespace motley {

/// Moves b along an axis of a by `pitch` metres for every turn that it makes about that axis, and turns it as it is moved.
/// Stands beside what keeps b on the axis: a point on a line and parallel axes. Without friction, so a nut under its weight runs
/// down. Turns are counted from when the joint was added, or either body teleported. Bodies that turn; no particles.
struct ScrewDefinition {
    BodyId body_a{};
    BodyId body_b{};
    Vec3<float> local_anchor_a{};  ///< m, on the axis, in the frame of a from its centre of mass
    Vec3<float> local_anchor_b{};  ///< m, likewise of b
    Vec3<float> axis_a{1, 0, 0};   ///< in the frame of a, any length but 0
    float pitch =
        0.01F;  ///< m a turn, -1e6 to 1e6; positive: a right-handed thread; 0: b may turn and not slide
};

}  // namespace motley
