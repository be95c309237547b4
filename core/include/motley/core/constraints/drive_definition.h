// The definition of a drive: limits, a motor and a spring on one free coordinate of a joint.
#pragma once

#include <limits>

#include "motley/core/constraints/frame_joint_definition.h"

#pragma GCC visibility push(default)
namespace motley {

/// Which coordinate a drive acts on.
enum class DriveAxis : std::uint8_t {
    slide,  ///< m: position of b's frame along x of a's frame; forces in N
    twist,  ///< rad, -pi to pi: rotation of b's frame about the x axis that the frames share; torques in N m
    euler   ///< rad, -pi to pi: one of the three EulerAngles; torques in N m
};

/// The Euler angles of b's frame in a's frame: a rotation about x, then about the rotated y, then about the twice
/// rotated z (x-y'-z'', R = R_x R_y R_z), like a chain of three hinges. Where y is a right angle, x and z turn about
/// the same axis, and beyond it both jump by half a turn: use limits that keep y away from it.
enum class EulerAngle : std::uint8_t {
    x,  ///< -pi to pi
    y,  ///< -pi/2 to pi/2
    z   ///< -pi to pi
};

/// Limits, a motor and a spring on one coordinate, each only if asked for; they share one row. Used together with a
/// joint that locks the other axes: a twist drive with a hinge, a slide drive with a slider. Not for particles, which
/// do not turn.
template <DriveAxis axis>
struct DriveDefinition {
    BodyId body_a{};
    BodyId body_b{};
    JointFrame frame_a{};
    JointFrame frame_b{};

    // Limits, m or rad: slides from -1e9 to 1e9, angles from -pi to pi, or infinite.
    float lower =
        -std::numeric_limits<float>::infinity();  ///< <= upper; equal: a lock; -infinity: no lower limit
    float upper = std::numeric_limits<float>::infinity();  ///< infinity: no upper limit

    float motor_speed = 0;      ///< m/s or rad/s, -1e9 to 1e9: the speed that the motor drives to
    float motor_max_force = 0;  ///< N or N m, 0 to 1e12; 0: no motor. With speed 0 a brake, or dry friction

    // A spring, given either by a frequency of the mass that it moves, or by a stiffness and a damping; not by both.
    float spring_hertz = 0;          ///< Hz, to 1e6, on the drive's own effective mass; 0: none
    float spring_damping_ratio = 0;  ///< 0 to 1e6; 1 is critical
    /// N/m or N m/rad, 0 to 1e12; independent of the masses, so that springs in series through light bodies add up as
    /// they should. Integrated implicitly: stable at any stiffness, but oscillations faster than a substep are damped.
    float spring_stiffness = 0;
    float spring_damping = 0;  ///< N s/m or N m s/rad, 0 to 1e12; without a stiffness a damper
    float spring_target = 0;   ///< m, -1e9 to 1e9, or rad, -pi to pi: where the spring rests
    float spring_max_force = std::numeric_limits<float>::infinity();  ///< N or N m, >= 0, or infinite

    /// kg or kg m2, 0 to 1e10: inertia of a rotor that is geared to the coordinate, reflected to it (its own inertia
    /// times the square of the gear ratio). It has no weight, and its reaction acts on both bodies. Useful up to about
    /// 1e4 times the inertia that it moves: beyond that, float loses what other forces do to so light a body.
    float armature = 0;

    EulerAngle angle = EulerAngle::x;  ///< read by an Euler drive only

    [[nodiscard]] bool has_spring() const
    {
        return spring_hertz > 0 || spring_stiffness > 0 || spring_damping > 0;
    }
};

using SlideDriveDefinition = DriveDefinition<DriveAxis::slide>;
using TwistDriveDefinition = DriveDefinition<DriveAxis::twist>;
using EulerDriveDefinition = DriveDefinition<DriveAxis::euler>;

}  // namespace motley
#pragma GCC visibility pop
