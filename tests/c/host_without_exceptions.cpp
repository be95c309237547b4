// A C++ host that is compiled without exceptions and type information: a hinge under a torque, and a refusal.
#include <motley/c/motley.h>

#include <cmath>
#include <cstdio>
#include <cstring>

#if defined(__cpp_exceptions) || defined(__cpp_rtti)
#error "this host is to be compiled with -fno-exceptions -fno-rtti"
#endif

int main()
{
    motley_scene* scene = nullptr;
    motley_solver* solver = nullptr;
    motley_body_id ground, door;
    motley_constraint_id joint;
    const motley_body_definition body = motley_default_body_definition();
    motley_hinge_definition hinge = motley_default_hinge_definition();
    bool done = motley_scene_create(&scene) == MOTLEY_DONE &&
                motley_solver_create(nullptr, nullptr, &solver) == MOTLEY_DONE &&
                motley_scene_ground(scene, &ground) == MOTLEY_DONE &&
                motley_scene_add_body(scene, &body, &door) == MOTLEY_DONE;
    hinge.body_a = ground;
    hinge.body_b = door;
    done = done && motley_scene_add_hinge(scene, &hinge, &joint) == MOTLEY_DONE &&
           motley_scene_set_force(scene, door, {0, 0, 0}, {2, 5, 0}) == MOTLEY_DONE;
    for (int step = 0; step < 60; ++step)
        done = done && motley_solver_step(solver, scene, 1.0F / 60, 0, nullptr, nullptr) == MOTLEY_DONE;
    motley_body_state state;
    done = done && motley_scene_body_state(scene, door, &state) == MOTLEY_DONE;
    // 2 N m about the hinge turn 1 kg m2 to 2 rad/s in 1 s; the hinge bears the other 5.
    done = done && std::fabs(state.angular_velocity.x - 2) < 1e-3F &&
           std::fabs(state.angular_velocity.y) < 1e-3F;
    hinge.stiffness.hertz = -3;
    const bool refused = motley_scene_set_hinge(scene, joint, &hinge) == MOTLEY_REFUSED &&
                         std::strstr(motley_last_error(), "hertz is -3") != nullptr;
    if (!done || !refused) std::fprintf(stderr, "%s\n", motley_last_error());
    motley_solver_destroy(solver);
    motley_scene_destroy(scene);
    return done && refused ? 0 : 1;
}
