// What a host says of a drive: limits, a motor and a spring on one free axis of a joint.
#pragma once

#include <limits>

#include "motley/core/constraints/frame_joint_definition.h"

namespace motley {

/// Which coordinate a drive acts on.
enum class DriveAxis : std::uint8_t {
    slide,  ///< m: how far b's frame is along x of a's frame; forces in N
    twist  ///< rad, -pi to pi: how far b's frame is turned about the axis x that the frames share; torques in N m
};

/// Limits, a motor and a spring on one coordinate; each is there only if asked for, and all share one row. Stands
/// beside the joint that locks the other axes: a hinge with a twist drive, a slider with a slide drive. Bodies that
/// turn; no particles.
template <DriveAxis axis>
struct DriveDefinition {
    BodyId body_a{};
    BodyId body_b{};
    JointFrame frame_a{};
    JointFrame frame_b{};

    float lower =
        -std::numeric_limits<float>::infinity();  ///< <= upper; equal: a lock. twist: -pi to pi or infinite
    float upper = std::numeric_limits<float>::infinity();

    float motor_speed = 0;      ///< m/s or rad/s that the motor wants, finite
    float motor_max_force = 0;  ///< N or N m, 0 to 1e12; 0: no motor. With speed 0 a brake, or dry friction

    float spring_hertz = 0;          ///< 0: no spring; to 1e6 (Hz), on the drive's own effective mass
    float spring_damping_ratio = 0;  ///< 0 to 1e6
    float spring_target = 0;         ///< m or rad, finite; twist: -pi to pi
    float spring_max_force = std::numeric_limits<float>::infinity();  ///< N or N m, >= 0
};

using SlideDriveDefinition = DriveDefinition<DriveAxis::slide>;
using TwistDriveDefinition = DriveDefinition<DriveAxis::twist>;

}  // namespace motley
