// Figures: bodies, joints and capsules of which a scene gets many copies, which are solved sixteen at a time.
#ifndef MOTLEY_C_FIGURES_H
#define MOTLEY_C_FIGURES_H

#include "motley/c/bodies.h"
#include "motley/c/joints.h"
#include "motley/c/shapes.h"

#ifdef __cplusplus
extern "C" {
#endif
#pragma GCC visibility push(default)

/// Bodies, joints and capsules to be copied, in the frame of the figure.
typedef struct motley_figure motley_figure;

/// Where a copy is placed and how it moves as a whole, world frame.
typedef struct motley_placing {
    size_t struct_size;     ///< set by motley_default_placing()
    motley_vec3d position;  ///< m, of the origin of the figure's frame; default 0
    /// finite, not zero, normalised on entry; planar bodies: about z; default {0, 0, 0, 1}
    motley_quatd orientation;
    motley_vec3f linear_velocity;  ///< m/s, added to that of its bodies that are not static; default 0
} motley_placing;
MOTLEY_DECLARE_DEFAULT(placing)

/// Makes a figure without bodies. The host destroys it, at any time: copies do not need it any more.
motley_status motley_figure_create(motley_figure** figure);
/// Null is allowed. No other call may use the figure at the same time or later.
void motley_figure_destroy(motley_figure* figure);

/// Adds a body and writes its handle, which is valid only in joints and capsules of this figure, to `body`. Refuses what
/// motley_scene_add_body() refuses.
motley_status motley_figure_add_body(motley_figure* figure, const motley_body_definition* definition,
                                     motley_body_id* body);

/// For every NAME of MOTLEY_JOINT_TYPES a call as motley_figure_add_ball_socket(): adds a joint between bodies of this
/// figure. Refuses what motley_scene_add_NAME() refuses, the ground (to attach a figure to the world, give it a static
/// body), and pulleys, whose points are fixed in the world.
#define MOTLEY_DECLARE_FIGURE_JOINT(name, cpp_definition)         \
    motley_status motley_figure_add_##name(motley_figure* figure, \
                                           const motley_##name##_definition* definition);
MOTLEY_JOINT_TYPES(MOTLEY_DECLARE_FIGURE_JOINT)
#undef MOTLEY_DECLARE_FIGURE_JOINT

/// Adds the joints of a joint of six degrees of freedom between bodies of this figure. Refuses what
/// motley_scene_add_six_dof() refuses, and the ground.
motley_status motley_figure_add_six_dof(motley_figure* figure, const motley_six_dof_definition* definition);
/// Gives a body of this figure a capsule. Refuses what motley_scene_add_capsule() refuses, and the ground. The groups of each
/// copy are its own: capsules of one group do not touch in one copy, but do in two.
motley_status motley_figure_add_capsule(motley_figure* figure, const motley_capsule_definition* definition);

motley_status motley_figure_body_count(const motley_figure* figure, size_t* count);
motley_status motley_figure_joint_count(const motley_figure* figure, size_t* count);

/// Adds `count` copies, whose placings are `stride` bytes apart. Writes the handles of their bodies to `bodies`, copy after
/// copy, those of a copy in the order of the figure: `count` times as many as motley_figure_body_count() says. The copies
/// are ordinary bodies, joints and capsules. Refuses a bad orientation, and a body's field that a placing takes out of its
/// range; then nothing is added.
motley_status motley_scene_add_assembly(motley_scene* scene, const motley_figure* figure, size_t count,
                                        const motley_placing* copies, size_t stride, motley_body_id* bodies);

#pragma GCC visibility pop
#ifdef __cplusplus
}
#endif
#endif
