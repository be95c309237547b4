// A host of a library that was built in part, with MOTLEY_JOINTS=ball_socket, MOTLEY_MODELS=planar;rigid,
// MOTLEY_DIRECT=OFF and MOTLEY_TBB=OFF. Everything else is refused by name, and there is one thread.
#include <motley/motley.h>

#include <cstdio>
#include <string>

namespace {

/// Whether a call is refused with exactly these words.
template <class Call>
bool refuses(const Call& call, const std::string& words)
{
    try {
        call();
    } catch (const motley::InvalidInput& error) {
        std::printf("%s\n", error.what());
        return std::string(error.what()) == words;
    }
    return false;
}

}  // namespace

int main()
{
    motley::Scene scene;
    motley::BodyDefinition person{.model = motley::BodyModel::planar, .mass = 80};
    const motley::BodyId a = scene.add_body(person);
    person.position.x = 0.39;
    const motley::BodyId b = scene.add_body(person);

    const bool refuses_joint = refuses(
        [&] { scene.add_joint(motley::DistanceDefinition{.body_a = a, .body_b = b}); },
        "joint is motley::DistanceDefinition; expected one that is built, MOTLEY_JOINTS: ball_socket");
    person.model = motley::BodyModel::particle;
    const bool refuses_model =
        refuses([&] { scene.add_body(person); },
                "BodyDefinition.model is particle; expected one that is built, MOTLEY_MODELS: planar, rigid");
    const bool refuses_method = refuses(
        [] { motley::Solver({.method = motley::Method::direct}); },
        "SolverSettings.method is direct; expected one that is built, MOTLEY_DIRECT=OFF: soft_step or "
        "sequential_impulse");

    // Two people who overlap by 1 cm are pushed apart by equal amounts.
    motley::Contact touch;
    touch.body_a = a;
    touch.body_b = b;
    touch.normal = {1, 0, 0};
    touch.separation = -0.01F;
    touch.arm_a = {0.2F, 0, 0};
    touch.arm_b = {-0.2F, 0, 0};
    touch.friction = 0.5F;
    motley::Solver solver({}, {.threads = 2});
    const motley::StepReport report = solver.step(scene, 1.0F / 60, {&touch, 1});
    const double left = scene.state(a).position.x, right = scene.state(b).position.x;
    const bool apart = report.status == motley::StepStatus::done && left < 0 && right > 0.39 &&
                       left + right > 0.39 - 1e-6 && left + right < 0.39 + 1e-6;
    return refuses_joint && refuses_model && refuses_method && apart && solver.threads() == 1 ? 0 : 1;
}
