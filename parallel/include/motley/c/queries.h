// Who is near, what walls hide, and which contacts began or ended.
#ifndef MOTLEY_C_QUERIES_H
#define MOTLEY_C_QUERIES_H

#include "motley/c/crowd.h"

#ifdef __cplusplus
extern "C" {
#endif
#pragma GCC visibility push(default)

/// Finds people: the bodies of a scene that have discs. It answers for the scene as it was at its build: build it anew after
/// a step, and after the host has added, removed or teleported anybody or changed a disc. One that was never built finds
/// nobody. Queries may run at the same time as each other, whatever happens to the scene meanwhile, and allocate only where
/// an answer is longer than all of their thread before, and for the rings of an area. Coordinates are -1e12 to 1e12 m.
typedef struct motley_crowd_index motley_crowd_index;
/// Finds the walls of a scene along straight lines; people hide nothing. It answers for the scene as it was at its build, as
/// a crowd index does. Queries allocate nothing. Coordinates are -1e12 to 1e12 m.
typedef struct motley_wall_index motley_wall_index;
/// Compares the contacts of discs and capsules that pushed in the last step of a scene with those at the update before.
typedef struct motley_contact_events motley_contact_events;

/// Somebody, and how far away. This struct never changes.
typedef struct motley_near_person {
    motley_body_id body;
    double distance;  ///< m, from the point to the centre
} motley_near_person;

/// Where a line of sight meets a wall. This struct never changes.
typedef struct motley_wall_hit {
    motley_wall_id wall;
    double fraction;  ///< of the way, 0 to 1
} motley_wall_hit;

/// Two bodies that push each other with their discs, capsules or half-spaces, or one and a wall. This struct never changes.
typedef struct motley_contact_pair {
    motley_body_id a;     ///< the body with the lower slot of two; null with a wall
    motley_body_id b;     ///< the other body
    motley_wall_id wall;  ///< null between two bodies
} motley_contact_pair;

motley_status motley_crowd_index_create(motley_crowd_index** index);
/// Null is allowed.
void motley_crowd_index_destroy(motley_crowd_index* index);
/// Replaces the index by that of `scene`. A warm build allocates nothing; if memory runs out, the index is empty.
motley_status motley_crowd_index_build(motley_crowd_index* index, const motley_scene* scene);
/// Whether the people of the scene are those of the index and are where they were. Looks at every one of them.
motley_status motley_crowd_index_is_current(const motley_crowd_index* index, const motley_scene* scene,
                                            motley_bool* current);
/// Number of people.
motley_status motley_crowd_index_size(const motley_crowd_index* index, size_t* size);

// Each of these writes whom it finds to `found`, but no more than `capacity` of them, and how many there are to `count`.
// `found` may be null where `capacity` is 0.

/// Those whose centres are at most `radius` (m, 0 or more) away from `point` (m, world), in the order of their slots.
motley_status motley_crowd_index_centres_within(const motley_crowd_index* index, motley_vec2d point,
                                                double radius, size_t capacity, motley_body_id* found,
                                                size_t* count);
/// The same for those of whose disc any part is at most `radius` away.
motley_status motley_crowd_index_discs_within(const motley_crowd_index* index, motley_vec2d point,
                                              double radius, size_t capacity, motley_body_id* found,
                                              size_t* count);
/// The `capacity` people nearest to `point` (m, world), or as many as there are at most `furthest` (m, 0 or more, or
/// infinite) away: nearest first, those at the same distance in the order of their slots.
motley_status motley_crowd_index_nearest(const motley_crowd_index* index, motley_vec2d point, double furthest,
                                         size_t capacity, motley_near_person* found, size_t* count);
/// Those whose centres are in an area, in the order of their slots. A centre is in it if a ray from there crosses an odd
/// number of edges of all rings; rings may cross themselves and each other. Refuses no ring, and rings of fewer than three
/// points.
motley_status motley_crowd_index_inside(const motley_crowd_index* index, size_t ring_count,
                                        const motley_ring* rings, size_t capacity, motley_body_id* found,
                                        size_t* count);

motley_status motley_wall_index_create(motley_wall_index** index);
/// Null is allowed.
void motley_wall_index_destroy(motley_wall_index* index);
/// As motley_crowd_index_build().
motley_status motley_wall_index_build(motley_wall_index* index, const motley_scene* scene);
/// Whether the walls of the scene are those of the index and are where they were. Looks at every one of them.
motley_status motley_wall_index_is_current(const motley_wall_index* index, const motley_scene* scene,
                                           motley_bool* current);
/// Number of straight pieces of walls.
motley_status motley_wall_index_size(const motley_wall_index* index, size_t* size);
/// Whether the way from `from` to `to` (m, world) meets a wall that has a category bit that `mask` has, and where it meets
/// the first one. Touching a wall, beginning on it and running along it are meetings. `hit` is not written where there is
/// none; null for `hit`: only `is_hit` is wanted.
motley_status motley_wall_index_first_hit(const motley_wall_index* index, motley_vec2d from, motley_vec2d to,
                                          uint32_t mask, motley_bool* is_hit, motley_wall_hit* hit);

motley_status motley_contact_events_create(motley_contact_events** events);
/// Null is allowed.
void motley_contact_events_destroy(motley_contact_events* events);
/// Reads the contacts of the last step; called after every step, with the same scene or with copies that continue it. Bodies
/// that touch in several points are one pair. A warm update allocates nothing.
motley_status motley_contact_events_update(motley_contact_events* events, const motley_scene* scene);
/// Writes where the pairs are that pushed in the last step and not at the update before, and how many. They are valid until
/// the next update, pairs of bodies first, in the order of their slots.
motley_status motley_contact_events_began(const motley_contact_events* events,
                                          const motley_contact_pair** pairs, size_t* count);
/// The same for those that pushed at the update before and not in the last step.
motley_status motley_contact_events_ended(const motley_contact_events* events,
                                          const motley_contact_pair** pairs, size_t* count);
/// Number of pairs that pushed in the last step.
motley_status motley_contact_events_pushing(const motley_contact_events* events, size_t* count);
/// Forgets all pairs, as if there had been no update.
motley_status motley_contact_events_clear(motley_contact_events* events);

#pragma GCC visibility pop
#ifdef __cplusplus
}
#endif
#endif
