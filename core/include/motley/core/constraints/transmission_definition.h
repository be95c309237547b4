// The definitions of gears, and of a rack and its pinion.
#pragma once

#include "motley/core/ids.h"
#include "motley/core/vector.h"

#pragma GCC visibility push(default)
namespace motley {

/// Turns b about its axis by `ratio` times the angle that a turns about its own: negative for two gears that mesh. Used
/// together with the hinges that hold the gears. Turns are counted from when the joint was added or one of its bodies
/// was teleported, and relative to the world: the body that carries the gears must not itself turn about their axes.
/// Not for particles, which do not turn.
struct GearDefinition {
    BodyId body_a{};
    BodyId body_b{};
    Vec3<float> axis_a{1, 0, 0};  ///< in the frame of a, length 1e-6 to 1e6
    Vec3<float> axis_b{1, 0, 0};  ///< in the frame of b, likewise
    float ratio = -1;             ///< -1e6 to 1e6
};

/// Moves the rack b along its axis by `travel` metres for every radian that the pinion a turns about its own axis: the
/// radius of the pinion, negative to reverse the direction. Used together with a hinge and a slider. Turns are counted
/// as those of a gear. Not for particles, which do not turn.
struct RackAndPinionDefinition {
    BodyId body_a{};
    BodyId body_b{};
    Vec3<float> axis_a{1, 0, 0};  ///< of the pinion, in the frame of a, length 1e-6 to 1e6
    Vec3<float> axis_b{1, 0, 0};  ///< along the rack, in the frame of b, likewise
    float travel = 1;             ///< m/rad, -1e6 to 1e6
};

}  // namespace motley
#pragma GCC visibility pop
