// What a host says of a servo: a bounded pull or turn towards a target, in all directions at once.
#pragma once

#include <limits>

#include "motley/core/constraints/frame_joint_definition.h"

namespace motley {

/// Pulls an anchor on b to an anchor on a, like a rubber band of a given stiffness and strength: the mouse that drags a
/// body (a is then the ground), a follower, or, without stiffness, a motor for the velocity, or friction against a
/// floor seen from above. Any pair of bodies; in the plane only x and y count.
struct PointServoDefinition {
    BodyId body_a{};
    BodyId body_b{};
    Vec3<float> local_anchor_a{};   ///< m, in the frame of a; a particle's must be zero
    Vec3<float> local_anchor_b{};   ///< m, in the frame of b, likewise
    float hertz = 5;                ///< 0: velocity alone; to 1e6 (Hz), on the pair's own effective mass
    float damping_ratio = 1;        ///< 0 to 1e6
    Vec3<float> target_velocity{};  ///< m/s, world, of b's anchor from a's; finite
    float max_force = std::numeric_limits<float>::infinity();  ///< N, >= 0
};

/// Turns frame b into frame a with a given stiffness and strength: holds an orientation, or, without stiffness, drives
/// the angular velocity. Positions of the frames do not matter. Bodies that turn; no particles.
struct AngularServoDefinition {
    BodyId body_a{};
    BodyId body_b{};
    JointFrame frame_a{};
    JointFrame frame_b{};
    float hertz = 5;                ///< 0: velocity alone; to 1e6 (Hz), on the pair's own effective inertia
    float damping_ratio = 1;        ///< 0 to 1e6
    Vec3<float> target_velocity{};  ///< rad/s, world, of b against a; finite
    float max_torque = std::numeric_limits<float>::infinity();  ///< N m, >= 0
};

}  // namespace motley
