// What a host says of a drive: limits, a motor and a spring on one free axis of a joint.
#pragma once

#include <limits>

#include "motley/core/constraints/frame_joint_definition.h"

namespace motley {

/// Which coordinate a drive acts on.
enum class DriveAxis : std::uint8_t {
    slide,  ///< m: how far b's frame is along x of a's frame; forces in N
    twist,  ///< rad, -pi to pi: how far b's frame is turned about the axis x that the frames share; torques in N m
    euler  ///< rad, -pi to pi: one of the three EulerAngles; torques in N m
};

/// Angles of b's frame in a's: first about x, then about the y that this has turned, then about the z that both have turned
/// (x-y'-z'', R = R_x R_y R_z), as a chain of three hinges has them. Where y comes to a right angle x and z are the same axis, and
/// beyond it both are half a turn off: let limits keep y from there.
enum class EulerAngle : std::uint8_t {
    x,  ///< -pi to pi
    y,  ///< -pi/2 to pi/2
    z   ///< -pi to pi
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

    // A spring, as a frequency of the mass that it moves or as a stiffness; not both.
    float spring_hertz = 0;          ///< 0: none; to 1e6 (Hz), on the drive's own effective mass
    float spring_damping_ratio = 0;  ///< 0 to 1e6
    /// N/m or N m/rad, 0 to 1e12, whatever hangs on it: springs that follow one another through light bodies add up as they
    /// should. Implicit: no stiffness is too much for a substep, but what swings faster than it is damped.
    float spring_stiffness = 0;
    float spring_damping = 0;  ///< N s/m or N m s/rad, 0 to 1e12; without a stiffness a damper
    float spring_target = 0;   ///< m or rad, finite; twist: -pi to pi
    float spring_max_force = std::numeric_limits<float>::infinity();  ///< N or N m, >= 0

    /// kg or kg m2, 0 to 1e10: of a rotor that moves as the coordinate does, as the coordinate sees it (its own inertia times
    /// the square of the gear ratio). It has no weight, and its reaction is on both bodies. Up to about 1e4 times the inertia that it
    /// moves: beyond that floats lose what other forces do to so light a body.
    float armature = 0;

    EulerAngle angle = EulerAngle::x;  ///< read by an Euler drive alone

    [[nodiscard]] bool has_spring() const
    {
        return spring_hertz > 0 || spring_stiffness > 0 || spring_damping > 0;
    }
};

using SlideDriveDefinition = DriveDefinition<DriveAxis::slide>;
using TwistDriveDefinition = DriveDefinition<DriveAxis::twist>;
using EulerDriveDefinition = DriveDefinition<DriveAxis::euler>;

}  // namespace motley
