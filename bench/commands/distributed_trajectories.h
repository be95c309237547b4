// The trajectories of a crowd on several ranks as one file, which all ranks write at once by MPI-IO.
#pragma once

#include <cstdint>
#include <string>

#include "motley/mpi/distributed_crowd.h"
#include "shared_file.h"

namespace motley::bench {

/// Writes a file that PedPy reads, a frame at a time, as TrajectoryWriter does; lines of one frame are in the order of the ranks.
/// Every call is made by all ranks. Nothing is left behind at `path` unless close() succeeds.
class DistributedTrajectories {
  public:
    /// Throws std::runtime_error, on all ranks, when the file cannot be made.
    DistributedTrajectories(const std::string& path, double frames_a_second);
    void write(const DistributedCrowd& crowd, std::int64_t frame);
    void close() { file_.finish(); }

  private:
    SharedFile file_;
    std::uint64_t end_ = 0;  ///< bytes written by all ranks

    void write_all(const std::string& text);
};

}  // namespace motley::bench
