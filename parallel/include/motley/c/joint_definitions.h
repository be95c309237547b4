// The definitions of all types of joints. Adding a type: its struct here, its name at the end of this file.
#ifndef MOTLEY_C_JOINT_DEFINITIONS_H
#define MOTLEY_C_JOINT_DEFINITIONS_H

#include "motley/c/types.h"

/// A frame on a body: its position and rotation in the frame of the body. This struct never changes.
typedef struct motley_joint_frame {
    motley_vec3f position;  ///< m, -1e9 to 1e9, from the centre of mass; default 0
    motley_quatf rotation;  ///< length 1e-6 to 1e6; its x axis is the axis of the joint; default the identity
} motley_joint_frame;

/// The stiffness of the locked rows of a joint. With a frequency the joint is a spring in every method. This struct never
/// changes.
typedef struct motley_joint_stiffness {
    float hertz;  ///< Hz, 0 to 1e6, capped at 0.25 / substep; 0, which is the default: as the settings say
    float damping_ratio;  ///< 0 to 1e6; 1 is critical; read where hertz is above 0; default 2
} motley_joint_stiffness;

/// Holds an anchor p_a of body a on an anchor p_b of body b: C = p_b - p_a = 0. Three rows, but only x and y between
/// bodies that stay in the plane (planar with planar, static or kinematic).
typedef struct motley_ball_socket_definition {
    size_t struct_size;  ///< set by motley_default_ball_socket_definition(), as in all that follow
    motley_body_id body_a, body_b;
    /// m, -1e9 to 1e9, from a's centre of mass in its frame; particle: zero; default 0
    motley_vec3f local_anchor_a;
    motley_vec3f local_anchor_b;  ///< m, likewise of b
} motley_ball_socket_definition;

/// Keeps the distance between two anchors from min_length to max_length, with a spring along it if asked for. Equal
/// lengths make a rod, 0 and a length a rope, 0 and infinity a spring without limits. Between bodies that stay in the
/// plane (planar with planar, static or kinematic) only x and y count.
typedef struct motley_distance_definition {
    size_t struct_size;
    motley_body_id body_a, body_b;
    /// m, -1e9 to 1e9, from a's centre of mass in its frame; particle: zero; default 0
    motley_vec3f local_anchor_a;
    motley_vec3f local_anchor_b;  ///< m, likewise of b
    float min_length;             ///< m, 0 to max_length; default 1
    float max_length;             ///< m, to 1e9 or infinite; default 1
    /// Hz, to 1e6, on the joint's own effective mass; 0, which is the default: no spring
    float spring_hertz;
    float spring_damping_ratio;  ///< 0 to 1e6; 1 is critical; default 0
    float rest_length;           ///< m, 0 to 1e9: where the spring rests; default 1
    float spring_max_force;      ///< N, >= 0, or infinite, which is the default
    float
        spring_stiffness;  ///< N/m, 0 to 1e12, instead of spring_hertz; independent of the masses; default 0
    float spring_damping;  ///< N s/m, 0 to 1e12; without a stiffness a damper; default 0
} motley_distance_definition;

/// Locks axes of a frame on b to those of a frame on a; which ones, the names below say. For rigid, planar, static and
/// kinematic bodies; not for particles, which do not turn.
typedef struct motley_frame_joint_definition {
    size_t struct_size;
    motley_body_id body_a, body_b;
    motley_joint_frame frame_a, frame_b;
    motley_joint_stiffness stiffness;
} motley_frame_joint_definition;
/// The origin of b at that of a, and all rotations: 6 rows.
typedef motley_frame_joint_definition motley_fixed_definition;
/// The origin of b at that of a, and x parallel to x, about which b turns: 5 rows.
typedef motley_frame_joint_definition motley_hinge_definition;
/// The origin of b on the x axis of a, along which it slides, and all rotations: 5 rows.
typedef motley_frame_joint_definition motley_slider_definition;
/// The origin of b in the y-z plane of a: 1 row.
typedef motley_frame_joint_definition motley_point_on_plane_definition;
/// The origin of b on the x axis of a: 2 rows. With parallel axes a cylindrical joint.
typedef motley_frame_joint_definition motley_point_on_line_definition;
/// All rotations: 3 rows.
typedef motley_frame_joint_definition motley_rotation_lock_definition;
/// x of b parallel to x of a: 2 rows.
typedef motley_frame_joint_definition motley_parallel_axes_definition;
/// y of b perpendicular to x of a: 1 row. With a ball-socket a universal joint.
typedef motley_frame_joint_definition motley_perpendicular_axes_definition;

/// One of the Euler angles of b's frame in a's frame: a rotation about x, then about the rotated y, then about the twice
/// rotated z. Where y is a right angle, x and z turn about the same axis, and beyond it both jump by half a turn: use
/// limits that keep y away from it.
typedef int32_t motley_euler_angle;
enum {
    MOTLEY_EULER_X = 0,  ///< -pi to pi
    MOTLEY_EULER_Y = 1,  ///< -pi/2 to pi/2
    MOTLEY_EULER_Z = 2   ///< -pi to pi
};

/// Limits, a motor and a spring on one coordinate, each only if asked for; they share one row. Used together with a joint
/// that locks the other axes: a twist drive with a hinge, a slide drive with a slider. Not for particles, which do not
/// turn. Units are m and N of a slide, rad and N m of a twist and of an Euler angle.
typedef struct motley_drive_definition {
    size_t struct_size;
    motley_body_id body_a, body_b;
    motley_joint_frame frame_a, frame_b;
    /// m or rad: slides from -1e9 to 1e9, angles from -pi to pi; <= upper; default -infinity: no limit
    float lower;
    float upper;            ///< m or rad, likewise; equal to lower: a lock; default infinity: no limit
    float motor_speed;      ///< m/s or rad/s, -1e9 to 1e9: the speed that the motor drives to; default 0
    float motor_max_force;  ///< N or N m, 0 to 1e12; 0, which is the default: no motor. With speed 0 a brake
    // A spring, given either by a frequency of the mass that it moves, or by a stiffness and a damping; not by both.
    float spring_hertz;  ///< Hz, to 1e6, on the drive's own effective mass; 0, which is the default: none
    float spring_damping_ratio;  ///< 0 to 1e6; 1 is critical; default 0
    float spring_stiffness;      ///< N/m or N m/rad, 0 to 1e12; independent of the masses; default 0
    float spring_damping;        ///< N s/m or N m s/rad, 0 to 1e12; without a stiffness a damper; default 0
    float spring_target;         ///< m, -1e9 to 1e9, or rad, -pi to pi: where the spring rests; default 0
    float spring_max_force;      ///< N or N m, >= 0, or infinite, which is the default
    /// kg or kg m2, 0 to 1e10: inertia of a rotor that is geared to the coordinate, reflected to it. Default 0.
    float armature;
    motley_euler_angle angle;  ///< read by an Euler drive only; default MOTLEY_EULER_X
} motley_drive_definition;
/// The position of b's frame along x of a's frame.
typedef motley_drive_definition motley_slide_drive_definition;
/// The rotation of b's frame about the x axis that the frames share, -pi to pi.
typedef motley_drive_definition motley_twist_drive_definition;
/// One of the Euler angles.
typedef motley_drive_definition motley_euler_drive_definition;

/// Keeps the x axis of frame b within a cone about the x axis of frame a: the range of a shoulder or hip, used together
/// with a ball-socket. Only the rotations of the frames matter. Not for particles, which do not turn.
typedef struct motley_swing_limit_definition {
    size_t struct_size;
    motley_body_id body_a, body_b;
    motley_joint_frame frame_a, frame_b;
    float max_angle;  ///< rad, 0 to pi: half the opening of the cone; default 1
} motley_swing_limit_definition;

/// Pulls an anchor on b to an anchor on a, like a rubber band of a given stiffness and strength. With hertz = 0 it is a
/// motor for the velocity, or dry friction against a floor seen from above. For any pair of bodies; between bodies that
/// stay in the plane only x and y count.
typedef struct motley_point_servo_definition {
    size_t struct_size;
    motley_body_id body_a, body_b;
    /// m, -1e9 to 1e9, from a's centre of mass in its frame; particle: zero; default 0
    motley_vec3f local_anchor_a;
    motley_vec3f local_anchor_b;  ///< m, likewise of b
    float hertz;          ///< Hz, to 1e6, on the pair's own effective mass; 0: velocity only; default 5
    float damping_ratio;  ///< 0 to 1e6; 1 is critical; default 1
    motley_vec3f target_velocity;  ///< m/s, world, -1e9 to 1e9: of b's anchor relative to a's; default 0
    float max_force;               ///< N, >= 0, or infinite, which is the default
} motley_point_servo_definition;

/// Turns frame b towards frame a with a given stiffness and strength: holds a relative orientation, or, with hertz = 0,
/// drives the relative angular velocity. Only the rotations of the frames matter. Not for particles, which do not turn.
typedef struct motley_angular_servo_definition {
    size_t struct_size;
    motley_body_id body_a, body_b;
    motley_joint_frame frame_a, frame_b;
    float hertz;          ///< Hz, to 1e6, on the pair's own effective inertia; 0: velocity only; default 5
    float damping_ratio;  ///< 0 to 1e6; 1 is critical; default 1
    motley_vec3f target_velocity;  ///< rad/s, world, -1e9 to 1e9: of b relative to a; default 0
    float max_torque;              ///< N m, >= 0, or infinite, which is the default
} motley_angular_servo_definition;

/// Turns b about its axis by `ratio` times the angle that a turns about its own: negative for two gears that mesh. Used
/// together with the hinges that hold the gears. Turns are counted from when the joint was added or one of its bodies was
/// teleported, and relative to the world. Not for particles, which do not turn.
typedef struct motley_gear_definition {
    size_t struct_size;
    motley_body_id body_a, body_b;
    motley_vec3f axis_a;  ///< in the frame of a, length 1e-6 to 1e6; default {1, 0, 0}
    motley_vec3f axis_b;  ///< in the frame of b, likewise
    float ratio;          ///< -1e6 to 1e6; default -1
} motley_gear_definition;

/// Moves the rack b along its axis by `travel` metres for every radian that the pinion a turns about its own axis. Used
/// together with a hinge and a slider. Turns are counted as those of a gear. Not for particles, which do not turn.
typedef struct motley_rack_and_pinion_definition {
    size_t struct_size;
    motley_body_id body_a, body_b;
    motley_vec3f axis_a;  ///< of the pinion, in the frame of a, length 1e-6 to 1e6; default {1, 0, 0}
    motley_vec3f axis_b;  ///< along the rack, in the frame of b, likewise
    float travel;         ///< m/rad, -1e6 to 1e6: the radius of the pinion, negative to reverse; default 1
} motley_rack_and_pinion_definition;

/// A rope from an anchor p_a on a over two wheels fixed in the world to an anchor p_b on b. Keeps the length
/// |p_a - point_a| + ratio |p_b - point_b| from min_length to max_length; the ratio is that of a block and tackle on
/// b's side. Between bodies that stay in the plane (planar with planar, static or kinematic) only x and y count.
typedef struct motley_pulley_definition {
    size_t struct_size;
    motley_body_id body_a, body_b;
    /// m, -1e9 to 1e9, from a's centre of mass in its frame; particle: zero; default 0
    motley_vec3f local_anchor_a;
    motley_vec3f local_anchor_b;  ///< m, likewise of b
    motley_vec3d point_a;         ///< m, world, -1e9 to 1e9: where the rope to a leaves its wheel; default 0
    motley_vec3d point_b;         ///< m, world, likewise of the rope to b
    float ratio;                  ///< 1e-6 to 1e6; default 1
    float min_length;             ///< m, 0 to max_length; equal to it: the rope is never slack; default 0
    float max_length;             ///< m, to 1e9 or infinite; default 1
} motley_pulley_definition;

/// A point where two surfaces face each other. This struct never changes.
typedef struct motley_manifold_point {
    motley_vec3f local_anchor_a;  ///< m, -1e9 to 1e9: on the surface of a, in its frame
    motley_vec3f local_anchor_b;  ///< m, -1e9 to 1e9: on the surface of b, in its frame
} motley_manifold_point;

/// Two bodies that touch, or soon will, at one to four points, with friction of the whole instead of each point. Unlike a
/// contact, which is given to every step, a manifold is a joint: the host adds it when a pair comes near, replaces it
/// with motley_scene_set_manifold() when it finds other points (impulses stay with the index of a point), and removes it
/// when the pair parts. Meanwhile the points move with their bodies. Not for particles, which do not turn.
typedef struct motley_manifold_definition {
    size_t struct_size;
    motley_body_id body_a, body_b;
    motley_vec3f normal;  ///< from a to b, in the frame of a, length 1e-6 to 1e6; default {1, 0, 0}
    int32_t point_count;  ///< 1 to 4; default 1
    motley_manifold_point points[4];  ///< the first point_count are read; default 0
    float friction;     ///< coefficient, 0 to 1e9: |tangential force| <= friction * normal force; default 0
    float restitution;  ///< coefficient, 0 to 1; default 0
    /// m, 0 to 1e9: moment about the normal <= friction * torsional_radius * normal force; of a uniformly
    /// loaded disc 2/3 of its radius; default 0
    float torsional_radius;
    float rolling_radius;  ///< m, 0 to 1e9: moment about tangents <= rolling_radius * normal force; default 0
    /// m/s, in the frame of a, -1e9 to 1e9: velocity of a's surface relative to a, as of a conveyor belt. Its component
    /// along the normal is not read. Default 0.
    motley_vec3f surface_velocity;
} motley_manifold_definition;

/// Couples the motion of b along an axis of a to its rotation about that axis: `pitch` metres for every turn. Used
/// together with a point on a line and parallel axes, which keep b on the axis. Turns are counted as those of a gear. Not
/// for particles, which do not turn.
typedef struct motley_screw_definition {
    size_t struct_size;
    motley_body_id body_a, body_b;
    /// m, -1e9 to 1e9: on the axis, frame of a, from its centre of mass; default 0
    motley_vec3f local_anchor_a;
    motley_vec3f local_anchor_b;  ///< m, likewise of b
    motley_vec3f axis_a;          ///< in the frame of a, length 1e-6 to 1e6; default {1, 0, 0}
    float pitch;  ///< m a turn, -1e6 to 1e6; > 0: right-handed; 0: b turns but cannot slide; default 0.01
} motley_screw_definition;

/// Calls X(NAME, DEFINITION) for every type: NAME_definition is its struct here, DEFINITION that of the C++ interface.
#define MOTLEY_JOINT_TYPES(X)                          \
    X(ball_socket, BallSocketDefinition)               \
    X(distance, DistanceDefinition)                    \
    X(fixed, FixedDefinition)                          \
    X(hinge, HingeDefinition)                          \
    X(slider, SliderDefinition)                        \
    X(point_on_plane, PointOnPlaneDefinition)          \
    X(point_on_line, PointOnLineDefinition)            \
    X(rotation_lock, RotationLockDefinition)           \
    X(parallel_axes, ParallelAxesDefinition)           \
    X(perpendicular_axes, PerpendicularAxesDefinition) \
    X(slide_drive, SlideDriveDefinition)               \
    X(twist_drive, TwistDriveDefinition)               \
    X(euler_drive, EulerDriveDefinition)               \
    X(swing_limit, SwingLimitDefinition)               \
    X(point_servo, PointServoDefinition)               \
    X(angular_servo, AngularServoDefinition)           \
    X(gear, GearDefinition)                            \
    X(rack_and_pinion, RackAndPinionDefinition)        \
    X(pulley, PulleyDefinition)                        \
    X(manifold, ManifoldDefinition)                    \
    X(screw, ScrewDefinition)

#endif
