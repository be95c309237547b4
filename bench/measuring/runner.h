// Runs a scene and measures it.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "page/frames.h"
#include "worlds/bench_scene.h"

namespace motley::bench {

/// What was done in some steps, and how long it took, s.
struct RunTimes {
    std::int64_t steps = 0;
    std::array<double, stage_count> stages{};
    double solver = 0, steering = 0, search = 0;
    double constraint_sweeps = 0;  ///< constraints x sweeps
    [[nodiscard]] double whole() const { return solver + steering + search; }
};

/// What a run was and what it cost.
struct RunResult {
    std::string scene, isa, method;
    int threads = 1;
    std::int64_t steps = 0;
    double bodies = 0;                    ///< mean over the steps
    RunTimes times;                       ///< of all steps but the first, which allocates for the others
    double median_step_seconds = 0;       ///< of a whole step: solver, steering and search
    double median_solver_seconds = 0;     ///< of the solver's part
    double median_unsteered_seconds = 0;  ///< of solver and search, without the host's steering
    double constraints = 0;               ///< mean
    double lane_occupancy = 0;            ///< of all steps: constraints / (16 blocks); 0 without constraints
    double bytes_per_constraint = 0;      ///< of all steps: streamed by one sweep of solve
    int colours = 0;                      ///< most of any step
    std::int64_t overflow = 0;            ///< likewise
    StepReport last;
    double overlap_p50 = 0, overlap_p99 = 0,
           overlap_max = 0;  ///< deepest overlap of each person, share of radius
    double residual = 0;     ///< m/s, rms approach speed left at touching contacts
    SceneErrors errors;
    std::uint64_t state_hash = 0;
    double bytes = 0;  ///< of memory that the scene, its host and the solver hold at the end
    std::int64_t contained = 0;
    double direct_rms = -1, direct_max = -1;  ///< m/s, off the simultaneous solution; negative: not compared
    std::optional<SceneError> error;
    std::vector<Figure> figures;
    std::vector<Mark> marks;
    bool lists_contacts = false;  ///< of people; the others are of scenes without people
};

/// What to write in addition to the table.
struct RunOutputs {
    std::string trajectories, frames, recording;  ///< empty: none
    FrameColour colour = FrameColour::pressure;
    int frame_every = 30;    ///< steps
    int record_every = 6;    ///< steps
    bool densities = false;  ///< figures of how close people stand at the end
    int hash_every = 0;      ///< steps; 0: never
    std::string problem;     ///< the file for the problem of step `problem_step`; empty: none
    std::int64_t problem_step = 0;
    bool progress = true;
};

/// Decides who finds the contacts of people: the library, unless the options ask for a list or the scene cannot leave it to the
/// library. Throws InvalidInput when the scene cannot list them, and for options that the scene does not follow.
void settle_options(const SceneEntry& entry, RunOptions& options);

/// Runs a scene. Throws InvalidInput for dials out of range and std::runtime_error for files and refused steps.
RunResult run_scene(const SceneEntry& entry, RunOptions options, const RunOutputs& outputs);

/// The table of a run, for people.
std::string table_of(const RunResult& result);
/// The same for programs.
std::string json_of(const RunResult& result);

}  // namespace motley::bench
