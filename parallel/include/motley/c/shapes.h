// Shapes whose contacts the library finds itself, beside discs and walls: spheres, capsules and half-spaces.
#ifndef MOTLEY_C_SHAPES_H
#define MOTLEY_C_SHAPES_H

#include "motley/c/types.h"

#ifdef __cplusplus
extern "C" {
#endif
#pragma GCC visibility push(default)

/// All points within `radius` of a straight axis: a capsule, or a sphere where both ends of the axis are the same. A
/// body may have any number of them.
///
/// Capsules meet each other, half-spaces, walls and discs. A planar body reaches from the floor to the sky: what it meets,
/// it meets as seen from above, and is pushed in the plane. So do walls, however they are tilted. Capsules take no notice
/// of one-way walls, and of other walls not of their surface_speed and max_force.
///
/// Two capsules touch if each has a category bit that the other one's mask has, unless they are of one body, of bodies
/// that a joint connects, or of one group. Contacts have the geometric mean of both coefficients of friction and the
/// larger restitution.
typedef struct motley_capsule_definition {
    size_t struct_size;   ///< set by motley_default_capsule_definition()
    motley_body_id body;  ///< the null handle, which is the default: the ground
    /// The ends of the axis, m, in the frame of the body, from its centre of mass; each coordinate -1e6 to 1e6. Of a
    /// planar body z = 0; of a particle both 0. Default 0.
    motley_vec3f from, to;
    float radius;    ///< m, 1e-6 to 1e6; default 0.1
    float friction;  ///< coefficient of Coulomb friction, 0 to 1e9; 0, which is the default: no friction rows
    float restitution;  ///< coefficient, 0 to 1; default 0
    uint32_t category;  ///< default 1
    uint32_t mask;      ///< default all
    uint32_t group;     ///< 0, which is the default: of no group; at most 2^31 - 1
} motley_capsule_definition;
MOTLEY_DECLARE_DEFAULT(capsule_definition)

/// Everything on one side of a plane, such as the ground below a floor. It meets capsules of rigid bodies and particles;
/// planar bodies have walls.
typedef struct motley_half_space_definition {
    size_t struct_size;   ///< set by motley_default_half_space_definition()
    motley_body_id body;  ///< static or kinematic; the null handle, which is the default: the ground
    /// on the plane, m, in the frame of the body; each coordinate -1e12 to 1e12; default 0
    motley_vec3d point;
    motley_vec3f normal;  ///< out of it, likewise; length 1e-6 to 1e6, normalised on entry; default {0, 0, 1}
    float friction;       ///< as motley_capsule_definition.friction
    float restitution;    ///< coefficient, 0 to 1; default 0
    uint32_t category;    ///< default 1
    uint32_t mask;        ///< default all
} motley_half_space_definition;
MOTLEY_DECLARE_DEFAULT(half_space_definition)

/// A contact of a capsule that the library found in the last step. This struct never changes.
typedef struct motley_shape_contact {
    motley_body_id a;             ///< of the half-space, wall, disc or other capsule
    motley_body_id b;             ///< of a capsule
    motley_wall_id wall;          ///< null unless it touches a wall
    motley_vec3f normal;          ///< unit, from a to b, world, as it was when the last step began
    motley_vec3f arm_b;           ///< m, world, likewise: from the centre of mass of b to the contact point
    float separation;             ///< m along the normal, likewise; negative when overlapping
    float normal_force;           ///< N, on b along the normal, mean over the last step; 0 if it did not push
    motley_vec3f friction_force;  ///< N, world, on b, likewise
} motley_shape_contact;

/// Gives a body a capsule, or a sphere, beside those that it has, and writes its handle to `shape`. From then on steps
/// find its contacts. It is removed with its body. In a scene with capsules, keys of the host's contacts are below 2^63.
motley_status motley_scene_add_capsule(motley_scene* scene, const motley_capsule_definition* definition,
                                       motley_shape_id* shape);
/// Adds `count` capsules, whose definitions are `stride` bytes apart, and writes their handles to `shapes`: all or none.
motley_status motley_scene_add_capsules(motley_scene* scene, size_t count,
                                        const motley_capsule_definition* definitions, size_t stride,
                                        motley_shape_id* shapes);
/// Adds a half-space. It is removed with its body.
motley_status motley_scene_add_half_space(motley_scene* scene, const motley_half_space_definition* definition,
                                          motley_shape_id* shape);
motley_status motley_scene_remove_shape(motley_scene* scene, motley_shape_id shape);
motley_status motley_scene_is_shape_alive(const motley_scene* scene, motley_shape_id shape,
                                          motley_bool* alive);
/// Writes the contacts of capsules that were found in the last step, in the order in which they were listed for it, to
/// `contacts`, but no more than `capacity` of them, and how many there are to `count`. `contacts` may be null where
/// `capacity` is 0. Allocates.
motley_status motley_scene_shape_contacts(const motley_scene* scene, size_t capacity,
                                          motley_shape_contact* contacts, size_t* count);
/// Those on one body, which may be of any kind.
motley_status motley_scene_shape_contacts_of(const motley_scene* scene, motley_body_id body, size_t capacity,
                                             motley_shape_contact* contacts, size_t* count);

#pragma GCC visibility pop
#ifdef __cplusplus
}
#endif
#endif
