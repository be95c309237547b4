// `motley run` and `motley record`: a scene with the options of the command line.
#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <fstream>
#include <map>
#include <stdexcept>
#include <string>

#include "commands/distributed_run.h"
#include "commands/solver_command.h"
#include "measuring/runner.h"

namespace motley::bench {

inline void write_text(const std::string& path, const std::string& text)
{
    std::ofstream file(path);
    file << text;
    file.close();
    if (!file) throw std::runtime_error(path + ": cannot be written");
}

inline const std::map<std::string, SteeringModel> steering_names{
    {"plain", SteeringModel::plain},
    {"social-force", SteeringModel::social_force},
    {"orca", SteeringModel::orca}};

inline const std::map<std::string, FrameColour> colour_names{{"pressure", FrameColour::pressure},
                                                             {"density", FrameColour::density},
                                                             {"voronoi", FrameColour::voronoi}};

struct RunCommand {
    std::string scene, json;
    SolverCommand dials;
    RunOptions options;
    RunOutputs outputs;
    Checkpoints checkpoints;

    void declare(CLI::App& app)
    {
        dials.declare(app);
        app.add_option("scene", scene, "one of `motley list`")->required();
        app.add_option("--agents", options.agents, "people or bodies; default: the scene's")
            ->check(CLI::PositiveNumber);
        app.add_option("--seconds", options.seconds, "simulated time; default: the scene's")
            ->check(CLI::PositiveNumber);
        app.add_option("--dt", options.dt, "s a step")->check(CLI::Range(1e-6, 1.0))->capture_default_str();
        app.add_flag("--listed", options.lists_contacts,
                     "a search of the host lists the contacts of people, where the scene has one");
        app.add_option("--door", options.door, "m, width of the door of evacuation; default: 1.2")
            ->check(CLI::Range(0.6, 50.0));
        app.add_option("--density", options.density,
                       "people per m2 of crowd, flow, counterflow and corridor; default: the scene's")
            ->check(CLI::Range(1e-6, 6.0));
        app.add_option("--steering", options.steering,
                       "of evacuation, counterflow, crowd and flow: plain, social-force or orca")
            ->transform(CLI::CheckedTransformer(steering_names));
        app.add_flag(
            "--torsos", options.torsos,
            "of bottleneck, evacuation, counterflow and flow: people are capsules across the shoulders");
        app.add_option("--friction", options.friction, "between people; default: the scene's")
            ->check(CLI::Range(0.0, 1e6));
        app.add_option("--seed", options.seed, "of the scene's random numbers")->capture_default_str();
        app.add_option("--data", options.data, "bottleneck: a trajectory file; default: the experiment's")
            ->check(CLI::ExistingFile);
        app.add_flag("--measures", dials.settings.measures, "report what each step left unsolved");
        app.add_option("--direct-every", options.direct_every,
                       "compare every so many steps with the simultaneous solution of the same step; slow")
            ->check(CLI::PositiveNumber);
        app.add_option("--json", json, "write the figures to this file");
        app.add_option("--trajectories", outputs.trajectories, "write PedPy text to this file");
        app.add_option("--frames", outputs.frames, "write pictures to this folder");
        app.add_option("--record", outputs.recording, "write a recording to this file, for `motley view`");
        app.add_option("--record-every", outputs.record_every, "steps between its frames")
            ->check(CLI::PositiveNumber)
            ->capture_default_str();
        app.add_option("--colour", outputs.colour,
                       "what pictures show: pressure, density on each square metre, or voronoi, that of each "
                       "person's cell")
            ->transform(CLI::CheckedTransformer(colour_names));
        app.add_flag("--densities", outputs.densities,
                     "tell how close people stand at the end: on square metres, and by Voronoi cells");
        app.add_option("--frame-every", outputs.frame_every, "steps between pictures")
            ->check(CLI::PositiveNumber)
            ->capture_default_str();
#ifdef MOTLEY_HAS_MPI
        app.add_option("--checkpoint", checkpoints.file, "under mpirun: a file to go on from");
        app.add_option("--checkpoint-every", checkpoints.every, "steps between two checkpoints")
            ->check(CLI::PositiveNumber)
            ->capture_default_str();
        app.add_option("--restart", checkpoints.restart,
                       "under mpirun: go on from this checkpoint, on any number of ranks")
            ->check(CLI::ExistingFile);
#endif
        app.add_option("--hash-every", outputs.hash_every, "print the state hash every so many steps")
            ->check(CLI::PositiveNumber);
    }

    int operator()()
    {
        const SceneEntry* entry = find_scene(scene);
        if (entry == nullptr) {
            fmt::print(stderr, "motley: no scene '{}'; `motley list` names them\n", scene);
            return 2;
        }
        if (!dials.pick_isa()) return 2;
        options.settings = dials.settings;
        options.solver = dials.solver;
#ifdef MOTLEY_HAS_MPI
        if (is_started_by_mpi()) return run_distributed(scene, options, outputs, checkpoints, json);
        if (!checkpoints.file.empty() || !checkpoints.restart.empty()) {
            fmt::print(stderr, "motley: --checkpoint and --restart are for runs under mpirun\n");
            return 2;
        }
#endif
        const RunResult result = run_scene(*entry, options, outputs);
        fmt::print("{}", table_of(result));
        if (!json.empty()) write_text(json, json_of(result));
        return 0;
    }
};

struct RecordCommand {
    RunCommand run;

    void declare(CLI::App& app)
    {
        run.declare(app);
        app.add_option("file", run.outputs.problem, "where the step's problem is written to")->required();
        app.add_option("--step", run.outputs.problem_step, "which step, the first is 0")
            ->check(CLI::NonNegativeNumber)
            ->capture_default_str();
    }
    int operator()()
    {
        run.outputs.hash_every = 1;
        run.options.seconds =
            static_cast<double>(run.options.dt) * (static_cast<double>(run.outputs.problem_step) + 0.5);
        return run();
    }
};

}  // namespace motley::bench
