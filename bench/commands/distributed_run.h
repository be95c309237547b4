// `motley run crowd` under mpirun: the crowd on several ranks.
#pragma once

#include "measuring/runner.h"

namespace motley::bench {

/// Whether mpirun, or another launcher of MPI, has started this process.
bool is_started_by_mpi();

/// Where a run on several ranks is kept, to be taken up again.
struct Checkpoints {
    std::string file;     ///< empty: none
    int every = 1000;     ///< steps
    std::string restart;  ///< the checkpoint to go on from; empty: from the start
};

/// Runs the crowd on all ranks and prints its table on the first one. Other scenes, and options that it cannot follow, are refused
/// by name on all ranks. Returns an exit code.
int run_distributed(const std::string& scene, RunOptions options, const RunOutputs& outputs,
                    const Checkpoints& checkpoints, const std::string& json);

}  // namespace motley::bench
