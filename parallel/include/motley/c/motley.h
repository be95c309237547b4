// The C interface of motley, for C99 and everything that calls C. It does what <motley/motley.h> does, with the same bits:
// scenes of bodies, joints, discs, walls and capsules, and solvers that step them.
//
//     #include <motley/c/motley.h>
//     #include <stdio.h>
//
//     int main(void)
//     {
//         motley_scene* scene = NULL;
//         motley_solver* solver = NULL;
//         motley_body_id ground, ball;
//         motley_body_state state;
//         motley_body_definition body = motley_default_body_definition();
//         motley_ball_socket_definition joint = motley_default_ball_socket_definition();
//         motley_solver_settings settings = motley_default_solver_settings();
//         settings.gravity.y = -9.81F;
//         body.position.x = 1;
//         joint.local_anchor_b.x = -1;
//         int failed = motley_scene_create(&scene) || motley_solver_create(&settings, NULL, &solver) ||
//                      motley_scene_ground(scene, &ground) || motley_scene_add_body(scene, &body, &ball);
//         joint.body_a = ground, joint.body_b = ball;
//         failed = failed || motley_scene_add_ball_socket(scene, &joint, NULL);
//         for (int step = 0; step < 60 && !failed; ++step)
//             failed = motley_solver_step(solver, scene, 1.0F / 60, 0, NULL, NULL);
//         failed = failed || motley_scene_body_state(scene, ball, &state);
//         if (failed)
//             fprintf(stderr, "%s\n", motley_last_error());
//         else
//             printf("the ball hangs at y = %.3f m\n", state.position.y);
//         motley_solver_destroy(solver);
//         motley_scene_destroy(scene);
//         return failed;
//     }
//
// Link it as motley::motley with CMake, or libmotley.so with -lmotley; a static libmotley.a needs -lstdc++ -ltbb -lm beside.
//
// - Calls. Every call that can fail returns a motley_status; unless that is MOTLEY_DONE, it changed nothing, and
//   motley_last_error() says why. No exception leaves a call. Null pointers, handles of what was removed, unknown values of
//   enumerations, counts and strides that cannot be, and numbers out of the ranges that stand beside each field are
//   refused. A pointer to which a call writes the handle of one object may be null where the host does not want it.
// - Units and frames are SI, radians and the world, right-handed, unless a comment says otherwise.
// - Structs. Those that a host fills begin with a struct_size: make them by motley_default_...(), then change fields. They
//   may grow at their end in later versions; a library reads what an older host knows and takes the defaults for the
//   rest, and refuses a size that it does not know. All others say that they never change.
// - Memory. What create, copy and load make is destroyed by the host. Pointers that the host passes are read and written
//   during the call only. The library allocates by operator new of the process, or by the hooks of motley_set_memory_hooks(), and by
//   malloc() what motley_free() frees.
// - Figures. Copies of a figure are bodies and joints like all others, whether they come from a motley_figure or one by one; a
//   solver finds out by itself which are alike, and solves sixteen of them together.
// - Threads. Different scenes and solvers are independent of each other. Of one scene, calls that take a const one may run
//   at the same time as each other; set_velocity, set_velocities, set_force and set_forces may run at the same time as
//   each other and as reads of other bodies, as long as a body that one of them names is named by no other; every other
//   call, and a step, must run alone. While a step runs, nothing may access its scene or its solver.
#ifndef MOTLEY_C_MOTLEY_H
#define MOTLEY_C_MOTLEY_H

#include "motley/c/bodies.h"
#include "motley/c/crowd.h"
#include "motley/c/figures.h"
#include "motley/c/joints.h"
#include "motley/c/queries.h"
#include "motley/c/scene.h"
#include "motley/c/shapes.h"
#include "motley/c/solver.h"
#include "motley/c/types.h"

#endif
