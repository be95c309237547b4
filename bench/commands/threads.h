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
    SolverSettings settings{};           ///< of every copy
    SolverOptions solver{.threads = 2};  ///< of the copy that is compared with one thread; threads >= 2
    bool progress = true;
};

/// How many times as fast several threads were, over some turns.
struct SpeedUp {
    int turns = 0;
    double lower_quartile = 0, median = 0, upper_quartile = 0;  ///< 0 without turns
};

/// The result for one scene.
struct ThreadsResult {
    std::string scene;
    double one_thread_seconds = 0, seconds = 0;  ///< a whole step, search and steering included; medians
    SpeedUp all;
    SpeedUp near;            ///< while every thread had a core of its own and the first two shared a cache
    SpeedUp far;             ///< while every thread had a core of its own and the first two shared none
    bool same_bits = false;  ///< at the end
};

/// Throws std::runtime_error for a scene that is not there, InvalidInput for dials out of range.
std::vector<ThreadsResult> measure_threads(const ThreadsOptions& options);
std::string table_of(const std::vector<ThreadsResult>& results, int threads);

}  // namespace motley::bench
