// Pictures of a crowd on several ranks: each is gathered on one rank, and all ranks draw at once.
#pragma once

#include <mpi.h>

#include <optional>

#include "commands/distributed_view.h"
#include "measuring/runner.h"

namespace motley::bench {

/// Writes the files that FrameWriter writes of the crowd in one process. Picture n is drawn by rank n modulo their number, as soon
/// as every rank has one. Every call is made by all ranks. A picture that one of them cannot write is an error on all.
class DistributedFrames {
  public:
    /// Throws std::runtime_error when the folder cannot be made.
    explicit DistributedFrames(const RunOutputs& outputs);
    /// To be called when the step of a picture has ended.
    void write(const DistributedView& from, DistributedCrowd& crowd);
    /// Draws what has been gathered since.
    void close(DistributedCrowd& crowd) { draw(crowd.executor()); }

  private:
    int rank_ = 0, ranks_ = 1;
    int gathered_ = 0;  ///< how many pictures, on any rank
    std::optional<FrameWriter> writer_;
    std::optional<View> view_;  ///< the picture that this rank is to draw

    void draw(Executor& executor);
};

}  // namespace motley::bench
