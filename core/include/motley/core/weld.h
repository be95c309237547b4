// A weld: a fixed joint that may give, in translation and in rotation by stiffnesses of their own.
#pragma once

#include "motley/core/scene.h"

#pragma GCC visibility push(default)
namespace motley {

/// Holds frame b on frame a, in translation and in rotation. Of these a part whose frequency is 0 is rigid, as the locks of other
/// joints are; the other is a spring in every method. Frequencies are those of the pair's own mass and inertia, as in
/// JointStiffness. Frames and bodies as in FixedDefinition.
struct WeldDefinition {
    BodyId body_a{};
    BodyId body_b{};
    JointFrame frame_a{};
    JointFrame frame_b{};
    float linear_hertz = 0;           ///< Hz, 0 to 1e6, capped at 0.25 / substep; 0: rigid
    float linear_damping_ratio = 1;   ///< 0 to 1e6; 1 is critical; read where linear_hertz is above 0
    float angular_hertz = 0;          ///< Hz, likewise of the rotation
    float angular_damping_ratio = 1;  ///< likewise
};

/// The joints of a weld: a FixedDefinition, of which `rotation` is a null handle, where both of its parts are rigid; else a
/// PointServoDefinition or BallSocketDefinition, and a RotationLockDefinition.
struct Weld {
    ConstraintId position{}, rotation{};
};

/// Adds the joints of a weld. Refuses values out of the ranges above, and what the joints refuse; then nothing is added.
Weld add_weld(Scene& scene, const WeldDefinition& definition);

}  // namespace motley
#pragma GCC visibility pop
