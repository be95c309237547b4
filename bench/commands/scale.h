// The same crowd with a thousand to a million people: what a contact costs, and how much of the memory's bandwidth is
// used.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "motley/motley.h"

namespace motley::bench {

struct ScaleOptions {
    std::vector<std::int64_t> people{1000, 10000, 100000, 1000000};  ///< >= 1 each
    int rounds = 3;                                                  ///< runs of each size, in turn; >= 1
    SolverOptions solver{.threads = 2};
    bool progress = true;
};

struct ScaleResult {
    struct Size {
        std::int64_t people = 0;
        double contacts = 0;      ///< mean
        double step_seconds = 0;  ///< search and steering included; these are medians of the rounds
        double solver_seconds = 0;
        double sweep_seconds = 0;           ///< of solve and relax, a contact and sweep
        double sweep_share = 0;             ///< of the solver's time that solve and relax take
        double sweep_bytes_per_second = 0;  ///< rows, impulses and bodies, each time they are accessed
        double triad_bytes_per_second = 0;  ///< measured with each run, on as many threads
    };
    std::vector<Size> sizes;
    std::string isa;
    int threads = 1;
    double host_load = 0;
};

/// Throws InvalidInput for options of the solver out of range.
ScaleResult measure_scale(const ScaleOptions& options);
std::string table_of(const ScaleResult& result);

}  // namespace motley::bench
