// The definitions of servos: a bounded force or torque towards a target, in all directions at once.
#pragma once

#include <limits>

#include "motley/core/constraints/frame_joint_definition.h"

#pragma GCC visibility push(default)
namespace motley {

/// Pulls an anchor on b to an anchor on a, like a rubber band of a given stiffness and strength: a mouse that drags a
/// body (a is then the ground), or a follower. With hertz = 0 it is a motor for the velocity, or dry friction against a
/// floor seen from above. For any pair of bodies; between bodies that stay in the plane only x and y count.
struct PointServoDefinition {
    BodyId body_a{};
    BodyId body_b{};
    Vec3<float> local_anchor_a{};   ///< m, -1e9 to 1e9, from a's centre of mass in its frame; particle: zero
    Vec3<float> local_anchor_b{};   ///< m, likewise of b
    float hertz = 5;                ///< Hz, to 1e6, on the pair's own effective mass; 0: velocity only
    float damping_ratio = 1;        ///< 0 to 1e6; 1 is critical
    Vec3<float> target_velocity{};  ///< m/s, world, -1e9 to 1e9: of b's anchor relative to a's
    float max_force = std::numeric_limits<float>::infinity();  ///< N, >= 0, or infinite
};

/// Turns frame b towards frame a with a given stiffness and strength: holds a relative orientation, or, with hertz = 0,
/// drives the relative angular velocity. Only the rotations of the frames matter. Not for particles, which do not turn.
struct AngularServoDefinition {
    BodyId body_a{};
    BodyId body_b{};
    JointFrame frame_a{};
    JointFrame frame_b{};
    float hertz = 5;                ///< Hz, to 1e6, on the pair's own effective inertia; 0: velocity only
    float damping_ratio = 1;        ///< 0 to 1e6; 1 is critical
    Vec3<float> target_velocity{};  ///< rad/s, world, -1e9 to 1e9: of b relative to a
    float max_torque = std::numeric_limits<float>::infinity();  ///< N m, >= 0, or infinite
};

}  // namespace motley
#pragma GCC visibility pop
