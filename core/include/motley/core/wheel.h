// A wheel on its suspension: it slides along one axis of the chassis, spins about another, and may be steered.
#pragma once

#include <limits>

#include "motley/core/scene.h"

#pragma GCC visibility push(default)
namespace motley {

/// A wheel b on a chassis a, composed of joints: its centre on the line of the suspension, its axle parallel to the one
/// on the chassis, and, only if asked for, a spring with stops along the suspension and a motor or brake about the
/// axle. Ranges as in PointOnLineDefinition, ParallelAxesDefinition, SlideDriveDefinition and TwistDriveDefinition.
struct WheelDefinition {
    BodyId chassis{};
    BodyId wheel{};
    Vec3<float> position{};           ///< m, chassis frame: the centre of the wheel at suspension travel 0
    Vec3<float> suspension{0, 1, 0};  ///< chassis frame, length 1e-6 to 1e6: direction of positive travel, up
    Vec3<float> axle{0, 0, 1};        ///< chassis frame, length 1e-6 to 1e6, perpendicular to the suspension
    Vec3<float> wheel_axle{0, 0, 1};  ///< wheel frame, length 1e-6 to 1e6: its spin axis

    float lower = -std::numeric_limits<float>::infinity();  ///< m, lower stop; infinite: none
    float upper = std::numeric_limits<float>::infinity();   ///< m, upper stop, likewise
    float spring_hertz = 0;  ///< Hz, on the effective mass of the pair along the suspension; 0: no spring
    float spring_damping_ratio = 0.7F;  ///< 0 to 1e6; 1 is critical
    float spring_target = 0;            ///< m, travel at which the spring rests

    float motor_speed = 0;       ///< rad/s about the axle, of the wheel relative to the chassis
    float motor_max_torque = 0;  ///< N m; 0: no motor; with speed 0 a brake
};

/// The joints of a wheel. `spring` (which also has the stops) and `motor` are null handles if not asked for.
struct Wheel {
    ConstraintId line{}, axle{}, spring{}, motor{};
};

/// Adds the joints of a wheel. Refuses an axle that is not perpendicular to the suspension (a cosine of 0.01 or more),
/// and what the joints refuse; then nothing is added.
Wheel add_wheel(Scene& scene, const WheelDefinition& definition);

/// Steers: turns the axle, and the axis of the motor with it, about the suspension by `angle` (rad, -pi to pi) from
/// where `definition`, which the wheel was added with, has it.
void steer(Scene& scene, const Wheel& wheel, const WheelDefinition& definition, float angle);

}  // namespace motley
#pragma GCC visibility pop
