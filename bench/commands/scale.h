// The same crowd with a thousand to a million people, on one thread and on several: steps of a person a second, memory, and
// how much of the memory's bandwidth is used.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "motley/motley.h"
#include "worlds/bench_scene.h"

namespace motley::bench {

struct ScaleOptions {
    std::vector<std::int64_t> people{1000, 10000, 100000, 1000000};  ///< >= 1 each
    std::vector<double> densities{2, 5};                             ///< people per m2, above 0 to 6
    int rounds = 3;                                                  ///< runs of each size, in turn; >= 1
    SolverOptions solver{.threads = 2};                              ///< each size is also run on one thread
    bool progress = true;
};

struct ScaleResult {
    struct Size {
        double density = 0;
        std::int64_t people = 0;
        int threads = 1;
        double contacts = 0;      ///< mean
        double step_seconds = 0;  ///< search and steering included; these are medians of the rounds
        double solver_seconds = 0;
        double sweep_seconds = 0;           ///< of solve and relax, a contact and sweep
        double sweep_share = 0;             ///< of the solver's time that solve and relax take
        double sweep_bytes_per_second = 0;  ///< rows, impulses and bodies, each time they are accessed
        double triad_bytes_per_second = 0;  ///< measured with each run, on as many threads
        double bytes = 0;                   ///< of memory that scene, host and solver hold
        std::uint64_t state_hash = 0;       ///< after the last step
    };
    std::vector<Size> sizes;
    /// Of all runs: equal bits on one thread and on several, and what the scene must meet.
    std::vector<Mark> marks;
    std::string isa;
    double host_load = 0;
};

/// Throws InvalidInput for options of the solver out of range.
ScaleResult measure_scale(const ScaleOptions& options);
std::string table_of(const ScaleResult& result);

}  // namespace motley::bench
