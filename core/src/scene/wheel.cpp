// Splits a wheel into joints.
#include "motley/core/wheel.h"

#include <cmath>

#include "motley/core/invalid_input.h"
#include "scene/joint_checks.h"

namespace motley {
namespace {

/// The rotation whose x axis is `x`, a unit vector, and whose y axis is as near to `y` as that allows.
Quat<float> frame_of(const Vec3<float>& x, const Vec3<float>& y)
{
    const Vec3<float> z = unit(cross(x, y));
    const Vec3<float> up = cross(z, x);
    // Computed from its largest component: the scalar part, which the trace gives, is lost in rounding near half a
    // turn.
    const float trace = x.x + up.y + z.z;
    Quat<float> q{};
    if (trace > 0) {
        q = {up.z - z.y, z.x - x.z, x.y - up.x, 1 + trace};
    } else if (x.x > up.y && x.x > z.z) {
        q = {1 + x.x - up.y - z.z, x.y + up.x, z.x + x.z, up.z - z.y};
    } else if (up.y > z.z) {
        q = {x.y + up.x, 1 + up.y - x.x - z.z, up.z + z.y, z.x - x.z};
    } else {
        q = {z.x + x.z, up.z + z.y, 1 + z.z - x.x - up.y, x.y - up.x};
    }
    return unit(q);
}

/// A direction perpendicular to a unit vector.
Vec3<float> across(const Vec3<float>& v)
{
    return std::abs(v.x) < 0.6F ? Vec3<float>{0, v.z, -v.y} : Vec3<float>{-v.z, 0, v.x};
}

void check(const WheelDefinition& wheel)
{
    check_direction("WheelDefinition.suspension", wheel.suspension);
    check_direction("WheelDefinition.axle", wheel.axle);
    check_direction("WheelDefinition.wheel_axle", wheel.wheel_axle);
    const float cosine = dot(unit(wheel.suspension), unit(wheel.axle));
    if (!(std::abs(cosine) < 0.01F)) {
        refuse("WheelDefinition.axle", cosine, "across the suspension: a cosine within 0.01 (shown)");
    }
}

/// A joint whose x axes are the steered axle on the chassis and the axle on the wheel.
template <class Definition>
Definition about_axle(const WheelDefinition& wheel, float angle)
{
    const Vec3<float> up = unit(wheel.suspension), side = unit(wheel.axle), own = unit(wheel.wheel_axle);
    const Vec3<float> steered = std::cos(angle) * side + std::sin(angle) * cross(up, side);
    Definition joint;
    joint.body_a = wheel.chassis;
    joint.body_b = wheel.wheel;
    joint.frame_a.rotation = frame_of(steered, up);
    joint.frame_b.rotation = frame_of(own, across(own));
    return joint;
}

TwistDriveDefinition motor_of(const WheelDefinition& wheel, float angle)
{
    auto motor = about_axle<TwistDriveDefinition>(wheel, angle);
    motor.motor_speed = wheel.motor_speed;
    motor.motor_max_force = wheel.motor_max_torque;
    return motor;
}

}  // namespace

Wheel add_wheel(Scene& scene, const WheelDefinition& definition)
{
    check(definition);
    const Quat<float> upright = frame_of(unit(definition.suspension), unit(definition.axle));
    const JointFrame rail{definition.position, upright};
    Wheel wheel;
    try {
        wheel.line = scene.add_joint(PointOnLineDefinition{definition.chassis, definition.wheel, rail, {}});
        wheel.axle = scene.add_joint(about_axle<ParallelAxesDefinition>(definition, 0));
        const bool stops = !std::isinf(definition.lower) || !std::isinf(definition.upper);
        if (stops || definition.spring_hertz > 0) {
            SlideDriveDefinition spring{.body_a = definition.chassis, .body_b = definition.wheel};
            spring.frame_a = rail;
            spring.lower = definition.lower;
            spring.upper = definition.upper;
            spring.spring_hertz = definition.spring_hertz;
            spring.spring_damping_ratio = definition.spring_damping_ratio;
            spring.spring_target = definition.spring_target;
            wheel.spring = scene.add_joint(spring);
        }
        if (definition.motor_max_torque != 0) wheel.motor = scene.add_joint(motor_of(definition, 0));
    } catch (...) {
        for (const ConstraintId id : {wheel.line, wheel.axle, wheel.spring, wheel.motor}) {
            if (scene.is_alive(id)) scene.remove_joint(id);
        }
        throw;
    }
    return wheel;
}

void steer(Scene& scene, const Wheel& wheel, const WheelDefinition& definition, float angle)
{
    check(definition);
    check_range("steer.angle", angle, -3.14159275F, 3.14159275F, "-pi to pi (rad)");
    scene.set_joint(wheel.axle, about_axle<ParallelAxesDefinition>(definition, angle));
    if (scene.is_alive(wheel.motor)) scene.set_joint(wheel.motor, motor_of(definition, angle));
}

}  // namespace motley
