// The program `motley`: run a scene, list the scenes, or do the main job.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>

#include "commands/anchors.h"
#include "commands/behaviour.h"
#include "commands/demo.h"
#include "commands/extremes.h"
#include "commands/laws.h"
#include "commands/replay.h"
#include "commands/run_command.h"
#include "commands/scale.h"
#include "commands/sleep.h"
#include "commands/soak.h"
#include "commands/solver_command.h"
#include "commands/sweep.h"
#include "commands/threads.h"
#include "commands/view.h"
#include "measuring/clock.h"
#include "measuring/runner.h"
#include "page/page.h"

namespace {

using namespace motley;
using namespace motley::bench;

struct ReplayCommand {
    std::string file;
    SolverCommand dials;
    int steps = 1;

    void declare(CLI::App& app)
    {
        app.add_option("file", file, "a problem of `motley record`, or of save_problem()")->required();
        app.add_option("--steps", steps, "steps to go on; the contacts are those of the first")
            ->check(CLI::Range(1, 1000000))
            ->capture_default_str();
        dials.declare(app);
    }
    /// `parse_again` reads the command line again, so that its dials override those of the file.
    template <class Parse>
    int operator()(const Parse& parse_again)
    {
        StepProblem problem = load_problem(file);
        dials.settings = problem.settings;
        parse_again();
        if (!dials.pick_isa()) return 2;
        problem.settings = dials.settings;
        fmt::print("{}", replay(std::move(problem), dials.solver, steps));
        return 0;
    }
};

struct SweepCommand {
    std::string scene, csv, json;
    std::vector<std::string> isas;
    DialGrid grid;
    SweepOptions options;

    void declare(CLI::App& app)
    {
        app.add_option("scene", scene, "one of `motley list`")->required();
        app.add_option("--agents", options.agents, "people or bodies; default: the scene's")
            ->check(CLI::PositiveNumber);
        app.add_option("--seconds", options.seconds, "simulated time that is measured; default: the scene's")
            ->check(CLI::PositiveNumber);
        app.add_option("--rounds", options.rounds, "runs of each point, in turn with the others")
            ->check(CLI::Range(1, 100))
            ->capture_default_str();
        app.add_option("--seed", options.seed, "of the scene's random numbers")->capture_default_str();
        app.add_option("--csv", csv, "write every point to this file");
        app.add_option("--json", json, "write every point to this file, for `motley report`");
        const auto dial = [&](const char* name, auto& values, const char* what) {
            app.add_option(name, values, what)->delimiter(',');
        };
        app.add_option("--method", grid.methods, "soft_step, sequential_impulse, direct; several: a,b")
            ->delimiter(',')
            ->transform(CLI::CheckedTransformer(method_names));
        app.add_option("--drift-correction", grid.drift_corrections, "none, baumgarte, projection")
            ->delimiter(',')
            ->transform(CLI::CheckedTransformer(drift_names));
        dial("--substeps", grid.substeps, "substeps a step; several: 1,2,4");
        dial("--iterations", grid.iterations, "sweeps a substep");
        dial("--relaxations", grid.relaxations, "soft_step: sweeps without bias a substep");
        dial("--hertz", grid.hertz,
             "soft_step: stiffness of joints; contacts have half of it; 0: as by default");
        dial("--exact", grid.exact, "soft_step: joints solved all at once: 1, 0 or both: 0,1");
        dial("--exact-contacts", grid.exact_contacts,
             "soft_step: contacts of an island solved all at once: 1, 0 or both: 0,1");
        dial("--warm-start", grid.warm_starts, "1, 0 or both: 0,1");
        dial("--tolerance", grid.tolerances, "m/s at which an island's sweeps end; 0: never");
        dial("--threads", grid.threads, "threads");
        dial("--isa", isas, "instruction sets; default: MOTLEY_ISA, else the widest here");
    }
    int operator()()
    {
        for (const std::string& name : isas) {
            const std::optional<Isa> isa = isa_called(name);
            if (!isa) return 2;
            grid.isas.push_back(*isa);
        }
        const SweepResult result = sweep(scene, grid, options);
        fmt::print("{}", table_of(result));
        if (!csv.empty()) write_text(csv, csv_of(result));
        if (!json.empty()) write_text(json, json_of(result));
        return 0;
    }
};

/// `motley threads`.
struct ThreadsCommand {
    ThreadsOptions options;
    SolverCommand dials;

    void declare(CLI::App& app)
    {
        dials.solver = options.solver;
        dials.declare(app);
        app.add_option("scenes", options.scenes, "of `motley list`; default: grid chains ragdolls crowd");
        app.add_option("--agents", options.agents, "people or bodies; default: the scene's")
            ->check(CLI::PositiveNumber);
        app.add_option("--turns", options.turns, "of each copy")
            ->check(CLI::Range(1, 100000))
            ->capture_default_str();
    }
    int operator()()
    {
        if (!dials.pick_isa()) return 2;
        options.settings = dials.settings;
        options.solver = dials.solver;
        const std::vector<ThreadsResult> results = measure_threads(options);
        fmt::print("{}", table_of(results, options.solver.threads));
        return std::ranges::all_of(results, &ThreadsResult::same_bits) ? 0 : 1;
    }
};

/// `motley soak`.
struct SoakCommand {
    SoakOptions options;

    void declare(CLI::App& app)
    {
        app.add_option("--seconds", options.seconds, "of the clock")
            ->check(CLI::PositiveNumber)
            ->capture_default_str();
        app.add_option("--steps", options.steps, "so many steps instead")->check(CLI::PositiveNumber);
        app.add_option("--people", options.people, "about how many")
            ->check(CLI::Range(10, 1000000))
            ->capture_default_str();
        app.add_option("--seed", options.seed, "of the town's random numbers")->capture_default_str();
    }
    int operator()() const
    {
        const double began = now();
        const SoakResult result = soak(options);
        const double took = now() - began;
        fmt::print("{}", table_of(result, took));
        return result.failure.empty() ? 0 : 1;
    }
};

}  // namespace

int main(int count, char** arguments)
{
    CLI::App app{"motley: rigid-body constraints for crowds, in coloured SIMD lanes"};
    app.require_subcommand(1);
    RunCommand run;
    CLI::App* run_app = app.add_subcommand("run", "run a scene and print what it cost and how well it held");
    run.declare(*run_app);
    RecordCommand record;
    CLI::App* record_app = app.add_subcommand(
        "record",
        "run a scene up to a step and write that step's problem to a file, to send with a bug report");
    record.declare(*record_app);
    ReplayCommand replay_command;
    CLI::App* replay_app =
        app.add_subcommand("replay", "solve a recorded problem again, as it was or with other dials");
    replay_command.declare(*replay_app);
    ViewCommand view_command;
    CLI::App* view_app = app.add_subcommand(
        "view",
        "make a page of a recording of `motley run --record`, to play, to look at and to pick people in");
    view_command.declare(*view_app);
    CLI::App* list_app =
        app.add_subcommand("list", "name the scenes and the instruction sets of this machine");
    CLI::App* demo_app = app.add_subcommand(
        "demo", "the main job: the bottleneck, then the crowd, scalar, SIMD and threads side by side");
    SweepCommand sweep_command, compare_command;
    compare_command.options.with_peers = true;
    CLI::App* sweep_app =
        app.add_subcommand("sweep", "run a scene under a grid of dials: time a step against error");
    sweep_command.declare(*sweep_app);
    AnchorOptions anchor_options;
    CLI::App* anchors_app = app.add_subcommand(
        "anchors", "the nets, chains and ragdolls that other engines were measured on, as ratios to them");
    anchors_app->add_option("--rounds", anchor_options.rounds, "runs of each, in turn")
        ->check(CLI::Range(1, 100))
        ->capture_default_str();
    anchors_app->add_flag("--quick", anchor_options.quick, "small scenes, for a look");
    ScaleOptions scale_options;
    CLI::App* scale_app = app.add_subcommand("scale",
                                             "a crowd from a thousand to a million people, on one thread and "
                                             "on several: speed, memory, bandwidth");
    scale_app->add_option("--people", scale_options.people, "sizes; several: 1000,10000")
        ->delimiter(',')
        ->check(CLI::PositiveNumber);
    scale_app->add_option("--densities", scale_options.densities, "people per m2; several: 2,5")
        ->delimiter(',')
        ->check(CLI::Range(1e-6, 6.0));
    scale_app->add_option("--rounds", scale_options.rounds, "runs of each, in turn")
        ->check(CLI::Range(1, 100))
        ->capture_default_str();
    scale_app->add_option("--threads", scale_options.solver.threads, "threads, the caller's counted")
        ->check(CLI::Range(1, 1024))
        ->capture_default_str();
    SleepOptions sleep_options;
    CLI::App* sleep_app =
        app.add_subcommand("sleep", "what a crowd and listed contacts at rest cost, awake and asleep");
    sleep_app->add_option("--rounds", sleep_options.rounds, "runs of each, in turn")
        ->check(CLI::Range(1, 100))
        ->capture_default_str();
    sleep_app->add_option("--threads", sleep_options.solver.threads, "threads, the caller's counted")
        ->check(CLI::Range(1, 1024))
        ->capture_default_str();
    ThreadsCommand threads_command;
    CLI::App* threads_app = app.add_subcommand(
        "threads", "what threads are worth: copies of a scene, on one thread and on several, in turn");
    threads_command.declare(*threads_app);
    CLI::App* compare_app =
        app.add_subcommand("compare", "the same, with every peer that is installed, in one run");
    compare_command.declare(*compare_app);
    compare_app->add_option("--peer", compare_command.options.only_peer,
                            "of peers only what has this text in its name and setting, as in 'Bullet'");
    ReportOptions report;
    CLI::App* report_app = app.add_subcommand(
        "report", "sweep every scene beside the peers, price every feature, and write one page with charts");
    report_app->add_option("--output", report.output, "the page; .csv and .json are put beside it")
        ->capture_default_str();
    report_app->add_option("--scenes", report.scenes, "only these; several: a,b")->delimiter(',');
    report_app->add_option("--rounds", report.rounds, "runs of each point, in turn with the others")
        ->check(CLI::Range(1, 100))
        ->capture_default_str();
    report_app->add_flag("--quick", report.quick,
                         "small scenes, run once: a page in three minutes, for a look");
    report_app->add_flag("!--without-peers", report.with_peers, "motley alone");
    CLI::App* extremes_app = app.add_subcommand(
        "extremes", "run scenes at the edge of what numbers can bear under every method: figures and bounds");
    LawsOptions laws_options;
    CLI::App* laws_app = app.add_subcommand(
        "laws", "run every crowd that has an exact law, contacts found and listed: figures and pass marks");
    laws_app->add_flag("--quick", laws_options.quick, "fewer people, shorter runs");
    BehaviourOptions behaviour_options;
    CLI::App* behaviour_app = app.add_subcommand(
        "behaviour", "what steering decides, beside published curves: flows, speeds, lanes; and their drift");
    behaviour_app->add_flag("--quick", behaviour_options.quick, "fewer people, shorter runs");
    SoakCommand soak_command;
    CLI::App* soak_app = app.add_subcommand(
        "soak",
        "a town of people who join, leave, fall and rise, checked after every step, for as long as asked");
    soak_command.declare(*soak_app);
    DemoOptions demo;
    demo_app->add_option("--seconds", demo.seconds, "simulated time of each crowd run")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    demo_app->add_option("--rounds", demo.rounds, "interleaved rounds")
        ->check(CLI::Range(1, 100))
        ->capture_default_str();
    try {
        app.parse(count, arguments);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : 2;
    }
    try {
        if (*run_app) return run();
        if (*record_app) return record();
        if (*replay_app) return replay_command([&] { app.parse(count, arguments); });
        if (*view_app) return view_command();
        if (*sweep_app) return sweep_command();
        if (*anchors_app) {
            fmt::print("{}", table_of(measure_anchors(anchor_options)));
            return 0;
        }
        if (*scale_app) {
            const ScaleResult result = measure_scale(scale_options);
            fmt::print("{}", table_of(result));
            return std::ranges::all_of(result.marks, &Mark::passes) ? 0 : 1;
        }
        if (*sleep_app) {
            fmt::print("{}", table_of(measure_sleep(sleep_options)));
            return 0;
        }
        if (*threads_app) return threads_command();
        if (*compare_app) return compare_command();
        if (*report_app) write_report(report);
        if (*demo_app) return run_demo(demo);
        if (*soak_app) return soak_command();
        if (*extremes_app) return print_extremes({}) == 0 ? 0 : 1;
        if (*laws_app) {
            const std::vector<LawResult> results = run_laws(laws_options);
            fmt::print("{}", table_of(results));
            return failures_in(results, false) == 0 ? 0 : 1;
        }
        if (*behaviour_app) print_behaviour(behaviour_options);
        if (*list_app) {
            for (const SceneEntry& entry : scene_list())
                fmt::print("{:<18}{}\n", entry.name, entry.description);
            fmt::print("instruction sets here:");
            for (const Isa isa : available_isas()) fmt::print(" {}", isa_name(isa));
            fmt::print("\n");
        }
    } catch (const InvalidInput& error) {
        fmt::print(stderr, "motley: {}\n", error.what());
        return 2;
    } catch (const std::exception& error) {
        fmt::print(stderr, "motley: {}\n", error.what());
        return 1;
    }
    return 0;
}
