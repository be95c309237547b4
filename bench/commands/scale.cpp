// Runs the sizes in turn, and a triad with each run, because the host's memory bandwidth varies from minute to
// minute.
#include "commands/scale.h"

#include <fmt/format.h>

#include "measuring/host.h"
#include "measuring/median.h"
#include "measuring/roofline.h"
#include "measuring/runner.h"

namespace motley::bench {
namespace {

/// s, for every size. People start apart and have come into contact after about half of it.
constexpr double simulated_seconds = 1;

/// Bytes that a contact between planar bodies moves in addition to its row: for each body a velocity that is read and
/// written and a displacement that is read; and the impulse that is written back.
constexpr double body_bytes = 2 * 3 * 16 + 4;

ScaleResult::Size measure_once(std::int64_t people, const ScaleOptions& options)
{
    RunOptions run;
    run.agents = people;
    run.seconds = simulated_seconds;
    run.solver = options.solver;
    RunOutputs quiet;
    quiet.progress = false;
    const RunResult result = run_scene(*find_scene("crowd"), run, quiet);
    ScaleResult::Size size;
    size.people = people;
    size.contacts = result.constraints;
    size.step_seconds = result.median_step_seconds;
    size.solver_seconds = result.median_solver_seconds;
    const auto stage = [&](Stage s) { return result.times.stages[static_cast<std::size_t>(s)]; };
    const SolverSettings settings = run.settings.resolved();
    const double sweeps = stage(Stage::solve) + stage(Stage::relax);
    size.sweep_seconds = sweeps / (static_cast<double>(result.times.steps * settings.substeps *
                                                       (settings.iterations + settings.relaxations)) *
                                   result.constraints);
    size.sweep_share = sweeps / result.times.solver;
    size.sweep_bytes_per_second = (result.bytes_per_constraint + body_bytes) / size.sweep_seconds;
    size.triad_bytes_per_second = memory_triad(options.solver.threads);
    return size;
}

}  // namespace

ScaleResult measure_scale(const ScaleOptions& options)
{
    ScaleResult result;
    result.isa = isa_name(options.solver.isa.value_or(default_isa()));
    result.threads = options.solver.threads;
    std::vector<std::vector<ScaleResult::Size>> runs(options.people.size());
    for (int round = 0; round < options.rounds; ++round) {
        for (std::size_t i = 0; i < runs.size(); ++i) {
            runs[i].push_back(measure_once(options.people[i], options));
            if (options.progress)
                fmt::print(stderr, "crowd of {}: round {} of {}\n", options.people[i], round + 1,
                           options.rounds);
        }
    }
    for (const std::vector<ScaleResult::Size>& rounds : runs) {
        ScaleResult::Size size = rounds.front();
        for (double ScaleResult::Size::*figure :
             {&ScaleResult::Size::step_seconds, &ScaleResult::Size::solver_seconds,
              &ScaleResult::Size::sweep_seconds, &ScaleResult::Size::sweep_share,
              &ScaleResult::Size::sweep_bytes_per_second, &ScaleResult::Size::triad_bytes_per_second}) {
            std::vector<double> values;
            for (const ScaleResult::Size& one : rounds) values.push_back(one.*figure);
            size.*figure = median(values);
        }
        result.sizes.push_back(size);
    }
    result.host_load = host_load();
    return result;
}

std::string table_of(const ScaleResult& result)
{
    std::string text = fmt::format(
        "crowd at 5 per m2, {}, {} thread{}, host load {:.2f}; sweeps: rows, impulses and bodies, beside a "
        "triad over\narrays far larger than the caches\n"
        "{:>9} {:>10} {:>10} {:>15} {:>12} {:>13} {:>12} {:>10} {:>11} {:>9}\n",
        result.isa, result.threads, result.threads == 1 ? "" : "s", result.host_load, "people", "contacts",
        "ms a step", "M agent-steps/s", "solver alone", "ns a contact", "and a sweep", "of solver",
        "GB/s swept", "of triad");
    for (const ScaleResult::Size& size : result.sizes) {
        const auto people = static_cast<double>(size.people);
        text += fmt::format(
            "{:9} {:10.0f} {:10.2f} {:15.2f} {:12.2f} {:13.1f} {:12.2f} {:9.0f}% {:11.1f} {:8.0f}%\n",
            size.people, size.contacts, size.step_seconds * 1e3, people / size.step_seconds * 1e-6,
            people / size.solver_seconds * 1e-6, size.solver_seconds / size.contacts * 1e9,
            size.sweep_seconds * 1e9, 100 * size.sweep_share, size.sweep_bytes_per_second * 1e-9,
            100 * size.sweep_bytes_per_second / size.triad_bytes_per_second);
    }
    return text;
}

}  // namespace motley::bench
