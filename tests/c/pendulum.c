#include <motley/c/motley.h>
#include <stdio.h>

int main(void)
{
    motley_scene* scene = NULL;
    motley_solver* solver = NULL;
    motley_body_id ground, ball;
    motley_body_state state;
    motley_body_definition body = motley_default_body_definition();
    motley_ball_socket_definition joint = motley_default_ball_socket_definition();
    motley_solver_settings settings = motley_default_solver_settings();
    settings.gravity.y = -9.81F;
    body.position.x = 1;
    joint.local_anchor_b.x = -1;
    int failed = motley_scene_create(&scene) || motley_solver_create(&settings, NULL, &solver) ||
                 motley_scene_ground(scene, &ground) || motley_scene_add_body(scene, &body, &ball);
    joint.body_a = ground, joint.body_b = ball;
    failed = failed || motley_scene_add_ball_socket(scene, &joint, NULL);
    for (int step = 0; step < 60 && !failed; ++step)
        failed = motley_solver_step(solver, scene, 1.0F / 60, 0, NULL, NULL);
    failed = failed || motley_scene_body_state(scene, ball, &state);
    if (failed)
        fprintf(stderr, "%s\n", motley_last_error());
    else
        printf("the ball hangs at y = %.3f m\n", state.position.y);
    motley_solver_destroy(solver);
    motley_scene_destroy(scene);
    return failed;
}
