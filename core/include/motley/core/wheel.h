// A wheel on its suspension: it slides along one axis of the chassis, spins about another, and may be steered.
#pragma once

#include <limits>

#include "motley/core/scene.h"

namespace motley {

/// A wheel b on a chassis a. It is composed: a point on the line of the suspension, its axle parallel to the one on the
/// chassis, a spring with stops along the suspension, a motor or brake about the axle; each only if asked for.
struct WheelDefinition {
    BodyId chassis{};
    BodyId wheel{};
    Vec3<float> position{};  ///< m, chassis frame: where the wheel's centre is with the suspension at 0
    Vec3<float> suspension{0, 1, 0};  ///< chassis frame, any length but 0: the way that the wheel moves up
    Vec3<float> axle{0, 0, 1};        ///< chassis frame, across the suspension, any length but 0
    Vec3<float> wheel_axle{0, 0, 1};  ///< wheel frame, any length but 0: what it spins about

    float lower = -std::numeric_limits<float>::infinity();  ///< m, stops of the suspension
    float upper = std::numeric_limits<float>::infinity();
    float spring_hertz = 0;  ///< 0: no spring; on the effective mass of the pair along the suspension
    float spring_damping_ratio = 0.7F;
    float spring_target = 0;  ///< m, where the spring rests

    float motor_speed = 0;       ///< rad/s about the axle, of the wheel against the chassis
    float motor_max_torque = 0;  ///< N m; 0: free; with speed 0 a brake
};

/// The joints of a wheel; those not asked for are null.
struct Wheel {
    ConstraintId line{}, axle{}, spring{}, motor{};
};

/// Adds a wheel. Refuses what the definition and its joints refuse; then nothing is added.
Wheel add_wheel(Scene& scene, const WheelDefinition& definition);

/// Turns the axle about the suspension by `angle`, rad, from where `definition` has it; and with it the motor.
void steer(Scene& scene, const Wheel& wheel, const WheelDefinition& definition, float angle);

}  // namespace motley
