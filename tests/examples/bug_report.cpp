// A bug report: a host sees a joint come apart, keeps the step in which it did as a file, and who gets the file solves that
// very step again, first as it was and then with other settings. `motley replay FILE` does the same with any such file.
//
//   bug_report FILE     writes the step to FILE, reads it back and solves it
#include <motley/motley.h>

#include <cstdio>
#include <exception>
#include <limits>
#include <optional>
#include <stdexcept>

namespace {

constexpr float dt = 1.0F / 60;
constexpr double tolerated = 0.002;  // m

/// A rope of ten links of 0.1 kg with 200 kg at its end, let go from level.
motley::Scene wrecking_ball()
{
    motley::Scene scene;
    motley::BodyId above = scene.ground();
    for (int link = 0; link < 10; ++link) {
        const bool is_ball = link == 9;
        motley::BodyDefinition body;
        body.position = {0.25 + 0.5 * link, 0, 0};
        body.mass = is_ball ? 200.0F : 0.1F;
        const float inertia = is_ball ? 8.0F : 0.002F;
        body.inertia = {inertia, 0, 0, inertia, 0, inertia};
        const motley::BodyId id = scene.add_body(body);
        const float end = link == 0 ? 0 : 0.25F;
        scene.add_joint(motley::BallSocketDefinition{above, id, {end, 0, 0}, {-0.25F, 0, 0}});
        above = id;
    }
    return scene;
}

double separation(const motley::Scene& scene)
{
    return scene.errors().joint_separation_max;
}

/// Plays until a joint is further apart than what the host tolerates, and returns the step that made it so.
std::optional<motley::StepProblem> play(motley::Scene& scene, motley::Solver& solver)
{
    for (int step = 0; step < 600; ++step) {
        // The scene as it was before the step, contacts included, is all that decides what the step does.
        motley::StepProblem problem{.scene = scene, .settings = solver.settings(), .dt = dt, .contacts = {}};
        const motley::StepReport report = solver.step(scene, dt, problem.contacts);
        if (report.status != motley::StepStatus::done) throw std::runtime_error(report.error);
        if (separation(scene) > tolerated) return problem;
    }
    return std::nullopt;
}

int report(const char* file)
{
    motley::Scene scene = wrecking_ball();
    // A host that has every joint swept, whatever it bears: by default this chain would be solved exactly.
    motley::Solver solver(
        {.exact_above_ratio = std::numeric_limits<float>::infinity(), .gravity = {0, 0, -9.81F}},
        {.threads = 2});
    const std::optional<motley::StepProblem> problem = play(scene, solver);
    if (!problem) throw std::runtime_error("no joint came apart");
    save_problem(*problem, file);
    std::printf("a joint is %.2f mm apart: %s has the step that did it\n", 1e3 * separation(scene), file);

    // Whoever gets the file, on another machine and with another number of threads, sees the same bits.
    const motley::StepProblem received = motley::load_problem(file);
    motley::Scene again = received.scene;
    if (motley::Solver(received.settings).step(again, received.dt, received.contacts).status !=
            motley::StepStatus::done ||
        again.state_hash() != scene.state_hash())
        throw std::runtime_error("the step came out otherwise");
    std::printf("solved again: the same bits\n");

    motley::SolverSettings finer = received.settings, exact = received.settings;
    finer.substeps = 4 * finer.substeps;
    exact.exact_joints = true;
    for (const auto& [name, settings] :
         {std::pair{"four times the substeps", finer}, {"exact joints", exact}}) {
        motley::Scene other = received.scene;
        motley::Solver(settings).step(other, received.dt, received.contacts);
        std::printf("%-24s %.3f mm\n", name, 1e3 * separation(other));
    }
    return 0;
}

}  // namespace

int main(int count, char** arguments)
{
    if (count != 2) {
        std::fprintf(stderr, "usage: bug_report FILE\n");
        return 2;
    }
    try {
        return report(arguments[1]);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "bug_report: %s\n", error.what());
        return 1;
    }
}
