// What a host says of a swing limit.
#pragma once

#include "motley/core/constraints/frame_joint_definition.h"

namespace motley {

/// Keeps the x axis of frame b within a cone about the x axis of frame a: the reach of a shoulder or hip, beside a
/// ball-socket and perhaps a twist drive. Positions of the frames do not matter. Bodies that turn; no particles.
struct SwingLimitDefinition {
    BodyId body_a{};
    BodyId body_b{};
    JointFrame frame_a{};
    JointFrame frame_b{};
    float max_angle = 1;  ///< rad, 0 to pi: half the opening of the cone
};

}  // namespace motley
