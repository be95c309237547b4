// Bodies: adding, reading and moving them, one by one and in bulk.
#ifndef MOTLEY_C_BODIES_H
#define MOTLEY_C_BODIES_H

#include "motley/c/types.h"

#ifdef __cplusplus
extern "C" {
#endif
#pragma GCC visibility push(default)

/// The degrees of freedom of a body. Those that a model lacks cost neither memory nor time.
typedef int32_t motley_body_model;
enum {
    MOTLEY_PARTICLE = 0,  ///< 3 linear degrees of freedom; no orientation
    MOTLEY_PLANAR = 1,    ///< x, y and yaw about +z; z and tilt are held
    MOTLEY_RIGID = 2      ///< 3 linear and 3 angular degrees of freedom, full inertia tensor
};

/// What moves a body.
typedef int32_t motley_body_motion;
enum {
    MOTLEY_DYNAMIC_BODY = 0,  ///< impulses, forces and gravity
    MOTLEY_KINEMATIC_BODY =
        1,  ///< its own velocity, which only the host changes; constraints never do. Against a
            ///< planar body only its motion in the plane counts: x, y and rotation about z
    MOTLEY_STATIC_BODY = 2  ///< nothing: it stays where it is
};

/// A body to be added to a scene: its state in the world frame, and its mass. SI units. An orientation is used by
/// rigid, kinematic and static bodies, a yaw by dynamic planar ones.
typedef struct motley_body_definition {
    size_t struct_size;         ///< set by motley_default_body_definition()
    motley_body_model model;    ///< default MOTLEY_RIGID
    motley_body_motion motion;  ///< default MOTLEY_DYNAMIC_BODY
    motley_vec3d position;      ///< centre of mass, m; each coordinate -1e12 to 1e12; default 0
    /// body to world; length 1e-6 to 1e6, normalised on entry; default the identity
    motley_quatd orientation;
    double yaw;                    ///< rad about +z, -1e9 to 1e9; default 0
    motley_vec3f linear_velocity;  ///< m/s, -1e9 to 1e9; planar: z = 0; static: zero; default 0
    /// rad/s, -1e9 to 1e9; planar: x = y = 0; particle, static: zero; default 0
    motley_vec3f angular_velocity;
    float mass;  ///< kg, 1e-10 to 1e10; read of dynamic bodies only; default 1
    /// About the centre of mass in the body frame, kg m2; read of dynamic bodies only. rigid: positive definite, with
    /// principal moments that obey the triangle inequality A + B >= C, and xx, yy and zz from 1e-20 to 1e20.
    /// planar: only zz is read, 1e-20 to 1e20. particle: not read. Default the identity.
    motley_sym3f inertia;
    /// 1/s, 0 to 1e6; read of dynamic bodies only: the medium slows the body by the force -mass * linear_damping *
    /// velocity and the torque -inertia * angular_damping * angular velocity. A particle has no angular damping. Default 0.
    float linear_damping;
    float angular_damping;
} motley_body_definition;
MOTLEY_DECLARE_DEFAULT(body_definition)

/// What a body becomes: see motley_scene_change_body().
typedef struct motley_body_change {
    size_t struct_size;       ///< set by motley_default_body_change()
    motley_body_model model;  ///< default MOTLEY_RIGID
    motley_sym3f inertia;     ///< as motley_body_definition.inertia, of the new model
} motley_body_change;
MOTLEY_DECLARE_DEFAULT(body_change)

/// The state of one body, in the world frame. This struct never changes.
typedef struct motley_body_state {
    motley_vec3d position;          ///< centre of mass, m
    motley_quatd orientation;       ///< body to world, unit; the identity for a particle
    double yaw;                     ///< rad about +z, not wrapped to a turn; planar bodies only
    motley_vec3f linear_velocity;   ///< m/s
    motley_vec3f angular_velocity;  ///< rad/s
} motley_body_state;

/// Adds a body and writes its handle to `body`. Refuses a definition out of the ranges stated above.
motley_status motley_scene_add_body(motley_scene* scene, const motley_body_definition* definition,
                                    motley_body_id* body);
/// Adds `count` bodies, whose definitions are `stride` bytes apart, and writes their handles to `bodies`: all or none.
motley_status motley_scene_add_bodies(motley_scene* scene, size_t count,
                                      const motley_body_definition* definitions, size_t stride,
                                      motley_body_id* bodies);
/// Removes a body and every joint, wall and shape on it. Refuses the ground.
motley_status motley_scene_remove_body(motley_scene* scene, motley_body_id body);
/// Removes many, or none: refuses a list that names a body twice, or the ground.
motley_status motley_scene_remove_bodies(motley_scene* scene, size_t count, const motley_body_id* bodies);
motley_status motley_scene_is_body_alive(const motley_scene* scene, motley_body_id body, motley_bool* alive);
/// The static body at the origin of the world, to which joints with the world are attached.
motley_status motley_scene_ground(const motley_scene* scene, motley_body_id* ground);
/// Number of bodies alive, without the ground.
motley_status motley_scene_body_count(const motley_scene* scene, size_t* count);
/// Writes the bodies alive without the ground, in the order of their slots, to `bodies`, but no more than `capacity` of
/// them, and how many there are to `count`. `bodies` may be null where `capacity` is 0.
motley_status motley_scene_read_bodies(const motley_scene* scene, size_t capacity, motley_body_id* bodies,
                                       size_t* count);

motley_status motley_scene_body_model(const motley_scene* scene, motley_body_id body,
                                      motley_body_model* model);
motley_status motley_scene_body_motion(const motley_scene* scene, motley_body_id body,
                                       motley_body_motion* motion);
motley_status motley_scene_body_state(const motley_scene* scene, motley_body_id body,
                                      motley_body_state* state);
/// Teleports a body: `position` of its centre of mass (m, each coordinate -1e12 to 1e12), `orientation` (of a length
/// from 1e-6 to 1e6; used by rigid, kinematic and static bodies) and `yaw` (rad, -1e9 to 1e9; used by planar ones), all
/// in the world. Velocities are kept. Joints on it lose their accumulated impulses and counted turns. Refuses the ground.
motley_status motley_scene_set_pose(motley_scene* scene, motley_body_id body, motley_vec3d position,
                                    motley_quatd orientation, double yaw);
/// Sets the velocity of a body, world, m/s and rad/s, each component -1e9 to 1e9. Refuses a velocity other than zero of a
/// static body, and of components that the model does not have. Without effect on a contained body.
motley_status motley_scene_set_velocity(motley_scene* scene, motley_body_id body, motley_vec3f linear,
                                        motley_vec3f angular);
/// Sets a force (N, at the centre of mass) and a torque (N m), world, finite, that act in every step until changed; on a
/// contained body only after it is revived. Dynamic bodies only.
motley_status motley_scene_set_force(motley_scene* scene, motley_body_id body, motley_vec3f force,
                                     motley_vec3f torque);
/// Changes the mass (kg, 1e-10 to 1e10) of a dynamic body, and its inertia, of which the model reads what
/// motley_body_definition.inertia says. Pose, velocities, force and torque stay. Where the body has joints, the next step
/// lays out all joints anew.
motley_status motley_scene_set_mass(motley_scene* scene, motley_body_id body, float mass,
                                    motley_sym3f inertia);
/// Changes the damping (1/s, each 0 to 1e6) of a dynamic body: see motley_body_definition.linear_damping.
motley_status motley_scene_set_damping(motley_scene* scene, motley_body_id body, float linear, float angular);
/// Gives a dynamic body another model in place. Its handle, user data, joints, mass, position and linear velocity stay,
/// and its angular momentum as far as the new model has it. A planar body that becomes rigid is turned by its yaw about
/// z; a rigid one that becomes planar gives up its tilt. Refuses static, kinematic and contained bodies, a body with a
/// disc that leaves the planar model, and a model that a joint or a capsule on the body cannot have.
motley_status motley_scene_change_body(motley_scene* scene, motley_body_id body,
                                       const motley_body_change* change);
/// A number of the host's own for a body: an index, or a pointer. 0 at birth; kept in copies and files of the scene. No
/// step reads it.
motley_status motley_scene_set_user_data(motley_scene* scene, motley_body_id body, uint64_t value);
motley_status motley_scene_user_data(const motley_scene* scene, motley_body_id body, uint64_t* value);
/// Lets a contained body move again, from `position` (m, world) with the velocity `linear` (m/s, world) and no angular
/// velocity; its orientation stays. Refuses a body that is not contained.
motley_status motley_scene_revive(motley_scene* scene, motley_body_id body, motley_vec3d position,
                                  motley_vec3f linear);
/// Whether a step has contained the body: frozen it at its last finite pose because its state became infinite or NaN.
motley_status motley_scene_is_contained(const motley_scene* scene, motley_body_id body,
                                        motley_bool* contained);
/// Whether the body sleeps: see motley_solver_settings.sleep_speed. Its island wakes as a whole, when the host changes one
/// of its bodies or what touches them, and when something that moves is about to touch it.
motley_status motley_scene_is_asleep(const motley_scene* scene, motley_body_id body, motley_bool* asleep);
/// Wakes the island of a body. Without effect on a body that is awake, kinematic or static.
motley_status motley_scene_wake(motley_scene* scene, motley_body_id body);

// Bulk reads and writes over arrays of the host. Element i of an array belongs to bodies[i] and begins i * stride bytes
// after its first: a member of an array of structs has the size of the struct as its stride, a plain array that of its
// element. Refused are a null array where it is needed, strides that are smaller than an element or no multiple of its
// alignment, and arrays that are not aligned. Where `count` is 0, nothing is read or written.

/// As motley_scene_set_velocity(). Where `angular` is null, angular velocities stay as they are.
motley_status motley_scene_set_velocities(motley_scene* scene, size_t count, const motley_body_id* bodies,
                                          const motley_vec3f* linear, size_t linear_stride,
                                          const motley_vec3f* angular, size_t angular_stride);
/// As motley_scene_set_force(). Where `torques` is null, torques stay as they are.
motley_status motley_scene_set_forces(motley_scene* scene, size_t count, const motley_body_id* bodies,
                                      const motley_vec3f* forces, size_t force_stride,
                                      const motley_vec3f* torques, size_t torque_stride);
/// Centres of mass, m, world.
motley_status motley_scene_read_positions(const motley_scene* scene, size_t count,
                                          const motley_body_id* bodies, motley_vec3d* positions,
                                          size_t stride);
/// m/s and rad/s, world. Either array may be null: then it is skipped.
motley_status motley_scene_read_velocities(const motley_scene* scene, size_t count,
                                           const motley_body_id* bodies, motley_vec3f* linear,
                                           size_t linear_stride, motley_vec3f* angular,
                                           size_t angular_stride);
/// rad about +z, not wrapped to a turn.
motley_status motley_scene_read_yaws(const motley_scene* scene, size_t count, const motley_body_id* bodies,
                                     double* yaws, size_t stride);
/// Body to world, unit: the identity for a particle, and from the yaw for a planar body.
motley_status motley_scene_read_orientations(const motley_scene* scene, size_t count,
                                             const motley_body_id* bodies, motley_quatd* orientations,
                                             size_t stride);

#pragma GCC visibility pop
#ifdef __cplusplus
}
#endif
#endif
