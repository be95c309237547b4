// The definitions of joints of the C interface beside those of C++. Adding a type: its fields here.
#pragma once

#include "handles.h"
#include "motley/c/joint_definitions.h"
#include "motley/core/joint_definitions.h"

namespace motley::c {

template <>
inline constexpr int value_count<EulerAngle> = 3;
static_assert(static_cast<int>(EulerAngle::x) == MOTLEY_EULER_X);
static_assert(static_cast<int>(EulerAngle::y) == MOTLEY_EULER_Y);
static_assert(static_cast<int>(EulerAngle::z) == MOTLEY_EULER_Z);

template <>
struct Mirror<motley_joint_frame, JointFrame> : Pair<motley_joint_frame, JointFrame> {
    static constexpr auto fields = std::tuple(MOTLEY_FIELD(position), MOTLEY_FIELD(rotation));
};
template <>
struct Mirror<motley_joint_stiffness, JointStiffness> : Pair<motley_joint_stiffness, JointStiffness> {
    static constexpr auto fields = std::tuple(MOTLEY_FIELD(hertz), MOTLEY_FIELD(damping_ratio));
};
template <>
struct Mirror<motley_manifold_point, ManifoldPoint> : Pair<motley_manifold_point, ManifoldPoint> {
    static constexpr auto fields = std::tuple(MOTLEY_FIELD(local_anchor_a), MOTLEY_FIELD(local_anchor_b));
};

template <>
struct Mirror<motley_ball_socket_definition, BallSocketDefinition>
    : Pair<motley_ball_socket_definition, BallSocketDefinition> {
    static constexpr const char* name = "motley_ball_socket_definition";
    static constexpr auto fields = std::tuple(MOTLEY_FIELD(body_a), MOTLEY_FIELD(body_b),
                                              MOTLEY_FIELD(local_anchor_a), MOTLEY_FIELD(local_anchor_b));
};
template <>
struct Mirror<motley_distance_definition, DistanceDefinition>
    : Pair<motley_distance_definition, DistanceDefinition> {
    static constexpr const char* name = "motley_distance_definition";
    static constexpr auto fields = std::tuple(
        MOTLEY_FIELD(body_a), MOTLEY_FIELD(body_b), MOTLEY_FIELD(local_anchor_a),
        MOTLEY_FIELD(local_anchor_b), MOTLEY_FIELD(min_length), MOTLEY_FIELD(max_length),
        MOTLEY_FIELD(spring_hertz), MOTLEY_FIELD(spring_damping_ratio), MOTLEY_FIELD(rest_length),
        MOTLEY_FIELD(spring_max_force), MOTLEY_FIELD(spring_stiffness), MOTLEY_FIELD(spring_damping));
};
template <LinearLock linear, AngularLock angular>
struct Mirror<motley_frame_joint_definition, FrameJointDefinition<linear, angular>>
    : Pair<motley_frame_joint_definition, FrameJointDefinition<linear, angular>> {
    using C = motley_frame_joint_definition;
    using Cpp = FrameJointDefinition<linear, angular>;
    static constexpr const char* name = "motley_frame_joint_definition";
    static constexpr auto fields =
        std::tuple(MOTLEY_FIELD(body_a), MOTLEY_FIELD(body_b), MOTLEY_FIELD(frame_a), MOTLEY_FIELD(frame_b),
                   MOTLEY_FIELD(stiffness));
};
template <DriveAxis axis>
struct Mirror<motley_drive_definition, DriveDefinition<axis>>
    : Pair<motley_drive_definition, DriveDefinition<axis>> {
    using C = motley_drive_definition;
    using Cpp = DriveDefinition<axis>;
    static constexpr const char* name = "motley_drive_definition";
    static constexpr auto fields = std::tuple(
        MOTLEY_FIELD(body_a), MOTLEY_FIELD(body_b), MOTLEY_FIELD(frame_a), MOTLEY_FIELD(frame_b),
        MOTLEY_FIELD(lower), MOTLEY_FIELD(upper), MOTLEY_FIELD(motor_speed), MOTLEY_FIELD(motor_max_force),
        MOTLEY_FIELD(spring_hertz), MOTLEY_FIELD(spring_damping_ratio), MOTLEY_FIELD(spring_stiffness),
        MOTLEY_FIELD(spring_damping), MOTLEY_FIELD(spring_target), MOTLEY_FIELD(spring_max_force),
        MOTLEY_FIELD(armature), MOTLEY_FIELD(angle));
};
template <>
struct Mirror<motley_swing_limit_definition, SwingLimitDefinition>
    : Pair<motley_swing_limit_definition, SwingLimitDefinition> {
    static constexpr const char* name = "motley_swing_limit_definition";
    static constexpr auto fields =
        std::tuple(MOTLEY_FIELD(body_a), MOTLEY_FIELD(body_b), MOTLEY_FIELD(frame_a), MOTLEY_FIELD(frame_b),
                   MOTLEY_FIELD(max_angle));
};
template <>
struct Mirror<motley_point_servo_definition, PointServoDefinition>
    : Pair<motley_point_servo_definition, PointServoDefinition> {
    static constexpr const char* name = "motley_point_servo_definition";
    static constexpr auto fields =
        std::tuple(MOTLEY_FIELD(body_a), MOTLEY_FIELD(body_b), MOTLEY_FIELD(local_anchor_a),
                   MOTLEY_FIELD(local_anchor_b), MOTLEY_FIELD(hertz), MOTLEY_FIELD(damping_ratio),
                   MOTLEY_FIELD(target_velocity), MOTLEY_FIELD(max_force));
};
template <>
struct Mirror<motley_angular_servo_definition, AngularServoDefinition>
    : Pair<motley_angular_servo_definition, AngularServoDefinition> {
    static constexpr const char* name = "motley_angular_servo_definition";
    static constexpr auto fields =
        std::tuple(MOTLEY_FIELD(body_a), MOTLEY_FIELD(body_b), MOTLEY_FIELD(frame_a), MOTLEY_FIELD(frame_b),
                   MOTLEY_FIELD(hertz), MOTLEY_FIELD(damping_ratio), MOTLEY_FIELD(target_velocity),
                   MOTLEY_FIELD(max_torque));
};
template <>
struct Mirror<motley_gear_definition, GearDefinition> : Pair<motley_gear_definition, GearDefinition> {
    static constexpr const char* name = "motley_gear_definition";
    static constexpr auto fields =
        std::tuple(MOTLEY_FIELD(body_a), MOTLEY_FIELD(body_b), MOTLEY_FIELD(axis_a), MOTLEY_FIELD(axis_b),
                   MOTLEY_FIELD(ratio));
};
template <>
struct Mirror<motley_rack_and_pinion_definition, RackAndPinionDefinition>
    : Pair<motley_rack_and_pinion_definition, RackAndPinionDefinition> {
    static constexpr const char* name = "motley_rack_and_pinion_definition";
    static constexpr auto fields =
        std::tuple(MOTLEY_FIELD(body_a), MOTLEY_FIELD(body_b), MOTLEY_FIELD(axis_a), MOTLEY_FIELD(axis_b),
                   MOTLEY_FIELD(travel));
};
template <>
struct Mirror<motley_pulley_definition, PulleyDefinition> : Pair<motley_pulley_definition, PulleyDefinition> {
    static constexpr const char* name = "motley_pulley_definition";
    static constexpr auto fields =
        std::tuple(MOTLEY_FIELD(body_a), MOTLEY_FIELD(body_b), MOTLEY_FIELD(local_anchor_a),
                   MOTLEY_FIELD(local_anchor_b), MOTLEY_FIELD(point_a), MOTLEY_FIELD(point_b),
                   MOTLEY_FIELD(ratio), MOTLEY_FIELD(min_length), MOTLEY_FIELD(max_length));
};
template <>
struct Mirror<motley_manifold_definition, ManifoldDefinition>
    : Pair<motley_manifold_definition, ManifoldDefinition> {
    static constexpr const char* name = "motley_manifold_definition";
    static constexpr auto fields = std::tuple(
        MOTLEY_FIELD(body_a), MOTLEY_FIELD(body_b), MOTLEY_FIELD(normal), MOTLEY_FIELD(point_count),
        MOTLEY_FIELD(points), MOTLEY_FIELD(friction), MOTLEY_FIELD(restitution),
        MOTLEY_FIELD(torsional_radius), MOTLEY_FIELD(rolling_radius), MOTLEY_FIELD(surface_velocity));
};
template <>
struct Mirror<motley_screw_definition, ScrewDefinition> : Pair<motley_screw_definition, ScrewDefinition> {
    static constexpr const char* name = "motley_screw_definition";
    static constexpr auto fields =
        std::tuple(MOTLEY_FIELD(body_a), MOTLEY_FIELD(body_b), MOTLEY_FIELD(local_anchor_a),
                   MOTLEY_FIELD(local_anchor_b), MOTLEY_FIELD(axis_a), MOTLEY_FIELD(pitch));
};

}  // namespace motley::c
