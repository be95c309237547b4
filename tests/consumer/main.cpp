#include <motley/motley.h>

#include <cstdio>

int main()
{
    motley::Scene scene;
    const motley::BodyId ball = scene.add_body({.position = {1, 0, 0}, .mass = 2});
    scene.add_joint(motley::BallSocketDefinition{scene.ground(), ball, {0, 0, 0}, {-1, 0, 0}});
    motley::Solver solver({.gravity = {0, -9.81F, 0}}, {.threads = 2});
    for (int step = 0; step < 60; ++step) {
        const motley::StepReport report = solver.step(scene, 1.0F / 60);
        if (report.status != motley::StepStatus::done) return std::printf("%s\n", report.error.c_str());
    }
    std::printf("the ball hangs at y = %.3f m\n", scene.state(ball).position.y);
    return scene.state(ball).position.y < -0.5 ? 0 : 1;
}
