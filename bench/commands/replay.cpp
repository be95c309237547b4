// Solves a step's problem under any settings and prints lines that can be compared with those of another machine.
#include "commands/replay.h"

#include <fmt/format.h>

#include <stdexcept>

namespace motley::bench {

std::string replay(StepProblem problem, const SolverOptions& options, int steps)
{
    Scene& scene = problem.scene;
    problem.settings.measures = true;
    Solver solver(problem.settings, options);
    std::string text = fmt::format(
        "{} bodies, {} joints, {} contacts, {:.6g} s; {}, {} thread{}\nbefore  hash {:016x}\n",
        scene.body_count(), scene.joint_count(), problem.contacts.size(), problem.dt, isa_name(solver.isa()),
        solver.threads(), solver.threads() == 1 ? "" : "s", scene.state_hash());
    for (int step = 1; step <= steps; ++step) {
        const StepReport report =
            solver.step(scene, problem.dt,
                        step == 1 ? std::span<const Contact>(problem.contacts) : std::span<const Contact>{});
        if (report.status != StepStatus::done)
            throw std::runtime_error(fmt::format("step {} refused: {}", step, report.error));
        const SceneErrors& after = report.measures.after;
        text += fmt::format(
            "step {:<3}hash {:016x}  {:.3f} ms, residual rms {:.3g} max {:.3g} m/s, joints apart rms {:.3g} "
            "max {:.3g} m, "
            "energy {:.6g} J, contained {}\n",
            step, scene.state_hash(), report.total_seconds() * 1e3, report.measures.residual_rms,
            report.measures.residual_max, after.joint_separation_rms, after.joint_separation_max,
            after.kinetic_energy, report.bodies_contained);
    }
    return text;
}

}  // namespace motley::bench
