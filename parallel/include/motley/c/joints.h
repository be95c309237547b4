// Joints: adding, changing and removing them, what they bear, and definitions that make several of them.
#ifndef MOTLEY_C_JOINTS_H
#define MOTLEY_C_JOINTS_H

#include "motley/c/joint_definitions.h"

#ifdef __cplusplus
extern "C" {
#endif
#pragma GCC visibility push(default)

/// For every NAME of MOTLEY_JOINT_TYPES the initialisers of motley_NAME_definition, as in
/// motley_default_ball_socket_definition(), and two calls, as in motley_scene_add_ball_socket() and
/// motley_scene_set_ball_socket().
/// - add: adds a joint and writes its handle to `joint`. Refuses a definition out of the ranges stated there, and bodies
///   neither of which can move.
/// - set: replaces the definition of a joint: the speed of a motor, the target of a servo, a limit. Its accumulated
///   impulses are kept. Refuses what add refuses, and a joint of another type or of other bodies.
#define MOTLEY_DECLARE_JOINT(name, cpp_definition)                                                           \
    MOTLEY_DECLARE_DEFAULT(name##_definition)                                                                \
    motley_status motley_scene_add_##name(motley_scene* scene, const motley_##name##_definition* definition, \
                                          motley_constraint_id* joint);                                      \
    motley_status motley_scene_set_##name(motley_scene* scene, motley_constraint_id joint,                   \
                                          const motley_##name##_definition* definition);
MOTLEY_JOINT_TYPES(MOTLEY_DECLARE_JOINT)
#undef MOTLEY_DECLARE_JOINT

/// What a joint did in the last substep.
typedef uint8_t motley_joint_state;
enum {
    MOTLEY_JOINT_INACTIVE = 0,  ///< nothing: a limit or rope that is not reached
    MOTLEY_JOINT_ACTIVE = 1,    ///< it holds or drives, or its spring acts
    MOTLEY_JOINT_LOWER = 2,     ///< it is at its lower limit
    MOTLEY_JOINT_UPPER = 3      ///< it is at its upper limit; of a rope: taut
};

/// The mean force of a joint over the last step, and its position error now. This struct never changes.
typedef struct motley_joint_report {
    /// N, world, on body b at its anchor: the impulse of the whole step divided by its duration
    motley_vec3f force;
    motley_vec3f torque;       ///< N m, world, on body b about its anchor, likewise
    float error;               ///< m: norm of the linear part of C; of a limit how far it is exceeded
    float angle_error;         ///< rad, likewise of the angular part
    motley_joint_state state;  ///< followed by three bytes of no meaning
} motley_joint_report;

/// A joint whose mean force or torque over the last step was above its break limit. This struct never changes.
typedef struct motley_break_event {
    motley_constraint_id joint;
    float force;   ///< N, norm of motley_joint_report.force
    float torque;  ///< N m, norm of motley_joint_report.torque
} motley_break_event;

motley_status motley_scene_remove_joint(motley_scene* scene, motley_constraint_id joint);
motley_status motley_scene_is_joint_alive(const motley_scene* scene, motley_constraint_id joint,
                                          motley_bool* alive);
motley_status motley_scene_joint_count(const motley_scene* scene, size_t* count);
motley_status motley_scene_joint_report(const motley_scene* scene, motley_constraint_id joint,
                                        motley_joint_report* report);
/// The same of many joints: report i, `stride` bytes after the one before, is of joints[i].
motley_status motley_scene_read_joint_reports(const motley_scene* scene, size_t count,
                                              const motley_constraint_id* joints,
                                              motley_joint_report* reports, size_t stride);
/// Names the joint in motley_scene_break_events() after every step in which it bore more than `force` (N) or `torque`
/// (N m), both above 0; infinite: no limit. The joint holds all the same: the host breaks it by removing it.
motley_status motley_scene_set_break_limit(motley_scene* scene, motley_constraint_id joint, float force,
                                           float torque);
/// Writes where the events of the last step are to `events`, in the order in which the joints were first given a limit,
/// and their number to `count`. They are valid until the next step, or until the scene is destroyed.
motley_status motley_scene_break_events(const motley_scene* scene, const motley_break_event** events,
                                        size_t* count);
/// Sets the least number of sweeps of `solve` in each substep for one joint, 0 to 10000; 0: as the settings say. The up to
/// fifteen other constraints in its block of lanes are swept as often. Without effect on MOTLEY_DIRECT.
motley_status motley_scene_set_iterations(motley_scene* scene, motley_constraint_id joint, int32_t at_least);
/// The same for every joint and contact of the island that contains the body; islands are found anew in every step.
/// Dynamic bodies only.
motley_status motley_scene_set_island_iterations(motley_scene* scene, motley_body_id body, int32_t at_least);

/// The limits of one coordinate of a joint of six degrees of freedom, and what drives it. Ranges as in
/// motley_drive_definition. Default: locked. This struct never changes.
typedef struct motley_axis_setup {
    float lower;                 ///< m or rad, <= upper; both 0: locked; -infinity and infinity: free
    float upper;                 ///< m or rad
    float motor_speed;           ///< m/s or rad/s
    float motor_max_force;       ///< N or N m; 0: no motor
    float spring_hertz;          ///< Hz; 0: no spring
    float spring_damping_ratio;  ///< of a spring with spring_hertz; 1 is critical
    float spring_stiffness;      ///< N/m or N m/rad, instead of spring_hertz
    float spring_damping;        ///< N s/m or N m s/rad
    float spring_target;         ///< m or rad
    float spring_max_force;      ///< N or N m; default infinite
    float armature;              ///< kg or kg m2: of a rotor geared to the coordinate
} motley_axis_setup;

/// How the three rotations of a joint of six degrees of freedom are measured.
typedef int32_t motley_six_dof_rotation;
enum {
    MOTLEY_ABOUT_AXES = 0,   ///< 2 atan2(q_i, q_w), i = x, y, z, of the quaternion q from frame a to frame b
    MOTLEY_EULER_ANGLES = 1  ///< motley_euler_angle: the angles of a chain of three hinges
};

/// The position and rotation of frame b in frame a: three coordinates along the axes of a and three rotations, each
/// locked, limited, driven or free. In addition a cone may bound the angle between the x axes of the frames.
typedef struct motley_six_dof_definition {
    size_t struct_size;
    motley_body_id body_a, body_b;
    motley_joint_frame frame_a, frame_b;
    motley_axis_setup position[3];      ///< along x, y, z of frame a
    motley_axis_setup rotation[3];      ///< about x (the twist), y, z; limits from -pi to pi, or infinite
    motley_six_dof_rotation rotations;  ///< default MOTLEY_ABOUT_AXES
    float max_swing;  ///< rad, > 0 to pi: half the opening of the cone; pi, which is the default: none
    motley_joint_stiffness stiffness;  ///< of the locked coordinates
} motley_six_dof_definition;
MOTLEY_DECLARE_DEFAULT(six_dof_definition)

/// The most joints that one motley_six_dof_definition makes.
enum { MOTLEY_SIX_DOF_JOINTS = 16 };
/// Adds the joints that a definition needs, as few as possible, and writes their handles to `joints`, which has room for
/// MOTLEY_SIX_DOF_JOINTS, and their number to `count`. Refuses values out of their ranges and a joint that is free in
/// every coordinate; then nothing is added.
motley_status motley_scene_add_six_dof(motley_scene* scene, const motley_six_dof_definition* definition,
                                       motley_constraint_id* joints, size_t* count);

/// A fixed joint that may give, in translation and in rotation by stiffnesses of their own: where a frequency is above 0 it is a
/// spring. Frames and bodies as in motley_fixed_definition.
typedef struct motley_weld_definition {
    size_t struct_size;
    motley_body_id body_a, body_b;
    motley_joint_frame frame_a, frame_b;
    float linear_hertz;           ///< Hz, 0 to 1e6; 0, which is the default: rigid
    float linear_damping_ratio;   ///< 0 to 1e6; 1, which is the default, is critical
    float angular_hertz;          ///< Hz, likewise of the rotation
    float angular_damping_ratio;  ///< likewise
} motley_weld_definition;
MOTLEY_DECLARE_DEFAULT(weld_definition)

/// The joints of a weld. `rotation` is a null handle where both of its parts are rigid. This struct never changes.
typedef struct motley_weld {
    motley_constraint_id position, rotation;
} motley_weld;

/// Adds the joints of a weld. Refuses values out of the ranges above, and what the joints refuse; then nothing is added.
motley_status motley_scene_add_weld(motley_scene* scene, const motley_weld_definition* definition,
                                    motley_weld* weld);

/// A wheel b on a chassis a, composed of joints: its centre on the line of the suspension, its axle parallel to the one on
/// the chassis, and, only if asked for, a spring with stops along the suspension and a motor or brake about the axle.
typedef struct motley_wheel_definition {
    size_t struct_size;
    motley_body_id chassis, wheel;
    motley_vec3f position;  ///< m, chassis frame: the centre of the wheel at suspension travel 0; default 0
    /// Chassis frame, length 1e-6 to 1e6: of positive travel, up; default {0, 1, 0}.
    motley_vec3f suspension;
    motley_vec3f axle;        ///< chassis frame, length 1e-6 to 1e6, perpendicular to it; default {0, 0, 1}
    motley_vec3f wheel_axle;  ///< wheel frame, length 1e-6 to 1e6: its spin axis; default {0, 0, 1}
    float lower, upper;       ///< m, stops; infinite, which is the default: none
    /// Hz, on the effective mass along the suspension; 0, which is the default: no spring
    float spring_hertz;
    float spring_damping_ratio;  ///< 0 to 1e6; 1 is critical; default 0.7
    float spring_target;         ///< m, travel at which the spring rests; default 0
    float motor_speed;           ///< rad/s about the axle, of the wheel relative to the chassis; default 0
    float motor_max_torque;      ///< N m; 0, which is the default: no motor; with speed 0 a brake
} motley_wheel_definition;
MOTLEY_DECLARE_DEFAULT(wheel_definition)

/// The joints of a wheel. `spring` (which also has the stops) and `motor` are null handles if not asked for. This struct
/// never changes.
typedef struct motley_wheel {
    motley_constraint_id line, axle, spring, motor;
} motley_wheel;

/// Adds the joints of a wheel. Refuses an axle that is not perpendicular to the suspension (a cosine of 0.01 or more), and
/// what the joints refuse; then nothing is added.
motley_status motley_scene_add_wheel(motley_scene* scene, const motley_wheel_definition* definition,
                                     motley_wheel* wheel);
/// Turns the axle, and the axis of the motor with it, about the suspension by `angle` (rad, -pi to pi) from where
/// `definition`, which the wheel was added with, has it.
motley_status motley_scene_steer(motley_scene* scene, const motley_wheel* wheel,
                                 const motley_wheel_definition* definition, float angle);

#pragma GCC visibility pop
#ifdef __cplusplus
}
#endif
#endif
