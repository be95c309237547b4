// What threads are worth: copies of one scene, on one thread and on several, stepped in turn.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "motley/motley.h"

namespace motley::bench {

struct ThreadsOptions {
    std::vector<std::string> scenes{"grid", "chains", "ragdolls", "crowd"};  ///< of `motley list`
    std::int64_t agents = 0;             ///< people or bodies; 0: the scene's default
    int turns = 100;                     ///< of each copy; >= 1
    SolverSettings settings;             ///< of every copy
    SolverOptions solver{.threads = 2};  ///< of the copy that is compared with one thread
    bool progress = true;
};

/// Of one scene, over the turns: s a whole step, search and steering included, and how many times as fast the second copy was.
struct ThreadsResult {
    std::string scene;
    double one_thread_seconds = 0, seconds = 0;  ///< medians
    double lower_quartile = 0, median_speed_up = 0,
           upper_quartile = 0;  ///< of both copies' turns beside each other
    bool same_bits = false;     ///< at the end
};

/// Throws std::runtime_error for a scene that is not there, InvalidInput for dials out of range.
std::vector<ThreadsResult> measure_threads(const ThreadsOptions& options);
std::string table_of(const std::vector<ThreadsResult>& results, int threads);

}  // namespace motley::bench
