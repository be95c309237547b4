// People and walls whose contacts the library finds itself: discs on planar bodies, and walls of straight segments.
#ifndef MOTLEY_C_CROWD_H
#define MOTLEY_C_CROWD_H

#include "motley/c/types.h"

#ifdef __cplusplus
extern "C" {
#endif
#pragma GCC visibility push(default)

/// The shape of a planar body: a disc about its centre of mass. Two discs, or a disc and a wall, touch if each has a
/// category bit that the other one's mask has.
typedef struct motley_disc_definition {
    size_t struct_size;  ///< set by motley_default_disc_definition()
    float radius;        ///< m, 1e-6 to 1e6; default 0.2
    /// coefficient of Coulomb friction, 0 to 1e9; of a contact the geometric mean of both; default 0
    float friction;
    uint32_t category;  ///< default 1
    uint32_t mask;      ///< default all
} motley_disc_definition;
MOTLEY_DECLARE_DEFAULT(disc_definition)

/// A wall without thickness along a chain of points. Discs are kept on the side of it on which they are; they may walk
/// around its ends.
typedef struct motley_wall_definition {
    size_t struct_size;  ///< set by motley_default_wall_definition()
    /// Two points or more, m, each coordinate -1e12 to 1e12, neighbours at least 1e-6 m apart: in the world, or, with
    /// `body`, in the frame of that body, of which only the motion in the plane counts. Read during the call only.
    const motley_vec2d* points;
    size_t point_count;  ///< default 0
    /// whether a segment joins the last point with the first; then three points or more; default 0
    motley_bool closed;
    motley_body_id body;  ///< static or kinematic; the null handle, which is the default: the ground
    float friction;       ///< as motley_disc_definition.friction
    uint32_t category;    ///< default 1
    uint32_t mask;        ///< default all
    /// A turnstile: discs pass from the right of the wall to its left, seen from the first point towards the last, and
    /// are held there once they are past it. Default 0.
    motley_bool one_way;
    /// m/s, -1e6 to 1e6: the surface runs along the wall, from the first point towards the last, as that of a moving belt
    /// does. It takes discs along by friction. Default 0.
    float surface_speed;
    /// N, above 0: the most with which the wall pushes a disc along the normal; default infinite
    float max_force;
} motley_wall_definition;
MOTLEY_DECLARE_DEFAULT(wall_definition)

/// A chain of points, m, world, whose last point is joined with its first and does not repeat it.
typedef struct motley_ring {
    const motley_vec2d* points;
    size_t point_count;
} motley_ring;

/// A contact that the library found and that pushed in the last step. This struct never changes.
typedef struct motley_disc_contact {
    motley_body_id a;      ///< the body of the wall, if `wall` is not null
    motley_body_id b;      ///< a disc
    motley_wall_id wall;   ///< null between two discs
    motley_vec2f normal;   ///< unit, from a to b, world, as it was when the last step began
    float separation;      ///< m along the normal, likewise; negative when overlapping
    float normal_force;    ///< N, on b along the normal, mean over the last step
    float friction_force;  ///< N, on b along the normal turned by +90 degrees, likewise
} motley_disc_contact;

/// Gives a planar, dynamic body the shape of a disc, or another one than it has. From then on steps find its contacts
/// with other discs and with walls; contacts of the host's list act beside them.
motley_status motley_scene_set_disc(motley_scene* scene, motley_body_id body,
                                    const motley_disc_definition* disc);
/// The same for many: disc i, `stride` bytes after the one before, is of bodies[i].
motley_status motley_scene_set_discs(motley_scene* scene, size_t count, const motley_body_id* bodies,
                                     const motley_disc_definition* discs, size_t stride);
/// Takes the disc of a body away. Refuses a body without one.
motley_status motley_scene_clear_disc(motley_scene* scene, motley_body_id body);
motley_status motley_scene_has_disc(const motley_scene* scene, motley_body_id body, motley_bool* has);
/// Adds a wall and writes its handle to `wall`. It is removed with its body.
motley_status motley_scene_add_wall(motley_scene* scene, const motley_wall_definition* definition,
                                    motley_wall_id* wall);
motley_status motley_scene_remove_wall(motley_scene* scene, motley_wall_id wall);
motley_status motley_scene_is_wall_alive(const motley_scene* scene, motley_wall_id wall, motley_bool* alive);
/// Adds each ring of a polygon as a closed wall, or nothing, and writes their handles to `walls`, as many as there are
/// rings: that of the outline, which comes first, then those of the holes. `like` says what all of them have, with no
/// points of its own; null: the defaults. With a body, the points are in its frame.
///
/// Refuses no ring, rings of fewer than three points, coordinates beyond -1e12 to 1e12 m, neighbours less than 1e-6 m
/// apart, a ring that meets itself, rings that cross each other or share a part of an edge, a hole that is not in the
/// outline, and a hole in another hole. Rings may touch in points.
motley_status motley_scene_add_polygon(motley_scene* scene, size_t ring_count, const motley_ring* rings,
                                       const motley_wall_definition* like, motley_wall_id* walls);

/// Writes the contacts of discs with each other and with walls that pushed in the last step, in the order in which they
/// were solved, to `contacts`, but no more than `capacity` of them, and how many there are to `count`. `contacts` may be
/// null where `capacity` is 0. Allocates.
motley_status motley_scene_disc_contacts(const motley_scene* scene, size_t capacity,
                                         motley_disc_contact* contacts, size_t* count);
/// Those of one body with a disc.
motley_status motley_scene_disc_contacts_of(const motley_scene* scene, motley_body_id body, size_t capacity,
                                            motley_disc_contact* contacts, size_t* count);

#pragma GCC visibility pop
#ifdef __cplusplus
}
#endif
#endif
