// Runs the sizes in turn, and a triad with each run, because the host's memory bandwidth varies from minute to
// minute.
#include "commands/scale.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <tuple>
#include <utility>

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

/// Lists that grow have room for up to a quarter more.
constexpr double most_growth = 1.25;

/// What is measured once a round.
struct Case {
    double density;
    std::int64_t people;
    int threads;
};

ScaleResult::Size measure_once(const Case& asked, const ScaleOptions& options, std::vector<Mark>& marks)
{
    RunOptions run;
    run.agents = asked.people;
    run.density = asked.density;
    run.seconds = simulated_seconds;
    run.solver = options.solver;
    run.solver.threads = asked.threads;
    RunOutputs quiet;
    quiet.progress = false;
    const RunResult result = run_scene(*find_scene("flow"), run, quiet);
    ScaleResult::Size size;
    size.density = asked.density;
    size.people = asked.people;
    size.threads = asked.threads;
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
    size.triad_bytes_per_second = memory_triad(asked.threads);
    size.bytes = result.bytes;
    size.state_hash = result.state_hash;
    for (const Mark& mark : result.marks) {
        const auto same = std::ranges::find(marks, mark.name, &Mark::name);
        if (same == marks.end()) {
            marks.push_back(mark);
        } else {
            same->value = std::max(same->value, mark.value);
        }
    }
    return size;
}

/// How many crowds did not end with the same bits in every run.
int crowds_of_several_hashes(const std::vector<std::vector<ScaleResult::Size>>& runs)
{
    std::set<std::pair<double, std::int64_t>> crowds;
    std::set<std::tuple<double, std::int64_t, std::uint64_t>> ends;
    for (const std::vector<ScaleResult::Size>& rounds : runs) {
        for (const ScaleResult::Size& size : rounds) {
            crowds.emplace(size.density, size.people);
            ends.emplace(size.density, size.people, size.state_hash);
        }
    }
    return static_cast<int>(ends.size() - crowds.size());
}

/// Memory follows the number of people: that of a person is no more in a large crowd than in one of a tenth of its size,
/// but for what lists have to spare.
void mark_growth(ScaleResult& result)
{
    double growth = 0;
    for (const ScaleResult::Size& small : result.sizes) {
        for (const ScaleResult::Size& large : result.sizes) {
            const bool compare = small.people >= 10'000 && large.people >= 10 * small.people &&
                                 small.density == large.density && small.threads == large.threads;
            const double of_both = large.bytes / static_cast<double>(large.people) /
                                   (small.bytes / static_cast<double>(small.people));
            if (compare) growth = std::max(growth, of_both);
        }
    }
    if (growth > 0)
        result.marks.push_back({"memory of a person over that in a crowd a tenth of the size or less, most",
                                growth, most_growth});
}

}  // namespace

ScaleResult measure_scale(const ScaleOptions& options)
{
    ScaleResult result;
    result.isa = isa_name(options.solver.isa.value_or(default_isa()));
    std::vector<Case> cases;
    for (const double density : options.densities) {
        for (const std::int64_t people : options.people) {
            cases.push_back({density, people, 1});
            if (options.solver.threads > 1) cases.push_back({density, people, options.solver.threads});
        }
    }
    std::vector<std::vector<ScaleResult::Size>> runs(cases.size());
    for (int round = 0; round < options.rounds; ++round) {
        for (std::size_t i = 0; i < runs.size(); ++i) {
            runs[i].push_back(measure_once(cases[i], options, result.marks));
            if (options.progress)
                fmt::print(stderr, "{} people at {} per m2, {} thread{}: round {} of {}\n", cases[i].people,
                           cases[i].density, cases[i].threads, cases[i].threads == 1 ? "" : "s", round + 1,
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
    result.marks.push_back({"crowds whose bits differ between threads or runs",
                            static_cast<double>(crowds_of_several_hashes(runs)), 0});
    mark_growth(result);
    result.host_load = host_load();
    return result;
}

std::string table_of(const ScaleResult& result)
{
    std::string text = fmt::format(
        "flow, {}, host load {:.2f}; sweeps: rows, impulses and bodies, beside a triad over arrays far "
        "larger than the "
        "caches\n"
        "{:>6} {:>8} {:>7} {:>9} {:>9} {:>15} {:>12} {:>13} {:>11} {:>9} {:>10} {:>8} {:>8}\n",
        result.isa, result.host_load, "per m2", "people", "threads", "contacts", "ms a step",
        "M agent-steps/s", "solver alone", "ns a contact", "and a sweep", "of solver", "GB/s swept",
        "of triad", "bytes");
    for (const ScaleResult::Size& size : result.sizes) {
        const auto people = static_cast<double>(size.people);
        text += fmt::format(
            "{:6} {:8} {:7} {:9.0f} {:9.2f} {:15.2f} {:12.2f} {:13.1f} {:11.2f} {:8.0f}% {:10.1f} {:7.0f}% "
            "{:8.0f}\n",
            size.density, size.people, size.threads, size.contacts, size.step_seconds * 1e3,
            people / size.step_seconds * 1e-6, people / size.solver_seconds * 1e-6,
            size.solver_seconds / size.contacts * 1e9, size.sweep_seconds * 1e9, 100 * size.sweep_share,
            size.sweep_bytes_per_second * 1e-9,
            100 * size.sweep_bytes_per_second / size.triad_bytes_per_second, size.bytes / people);
    }
    for (const Mark& mark : result.marks)
        text +=
            fmt::format("{}: {:.4g}, at most {:g}: {}\n", mark.name, mark.value, mark.bound, mark.verdict());
    return text;
}

}  // namespace motley::bench
