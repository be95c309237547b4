// What a host says of gears, and of a rack and its pinion.
#pragma once

#include "motley/core/ids.h"
#include "motley/core/vector.h"

namespace motley {

/// Turns b about its axis by `ratio` times what a turns about its own: two gears that mesh have a negative one. Stands
/// beside the hinges that hold the gears. Turns are counted from when the joint was added, or either body teleported,
/// and against the world: what carries the gears shall not itself turn about their axes. Bodies that turn; no particles.
struct GearDefinition {
    BodyId body_a{};
    BodyId body_b{};
    Vec3<float> axis_a{1, 0, 0};  ///< in the frame of a, any length but 0
    Vec3<float> axis_b{1, 0, 0};  ///< in the frame of b, likewise
    float ratio = -1;             ///< -1e6 to 1e6
};

/// Moves the rack b along its axis by `travel` metres for every radian that the pinion a turns about its own: the
/// pinion's radius, negative to move against it. Stands beside a hinge and a slider. Counts as a gear does.
struct RackAndPinionDefinition {
    BodyId body_a{};
    BodyId body_b{};
    Vec3<float> axis_a{1, 0, 0};  ///< of the pinion, in the frame of a, any length but 0
    Vec3<float> axis_b{1, 0, 0};  ///< along the rack, in the frame of b, likewise
    float travel = 1;             ///< m/rad, -1e6 to 1e6
};

}  // namespace motley
