// The definition of a swing limit.
#pragma once

#include "motley/core/constraints/frame_joint_definition.h"

#pragma GCC visibility push(default)
namespace motley {

/// Keeps the x axis of frame b within a cone about the x axis of frame a: the range of a shoulder or hip, used together
/// with a ball-socket and perhaps a twist drive. Only the rotations of the frames matter. Not for particles, which do
/// not turn.
struct SwingLimitDefinition {
    BodyId body_a{};
    BodyId body_b{};
    JointFrame frame_a{};
    JointFrame frame_b{};
    float max_angle = 1;  ///< rad, 0 to pi: half the opening of the cone
};

}  // namespace motley
#pragma GCC visibility pop
