// See distributed_frames.h.
#include "commands/distributed_frames.h"

#include "commands/distributed_view.h"

namespace motley::bench {

DistributedFrames::DistributedFrames(const RunOutputs& outputs)
{
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &ranks_);
    try_on_all([&] { writer_.emplace(outputs.frames, outputs.colour, rank_, ranks_); });
}

void DistributedFrames::write(const DistributedView& from, DistributedCrowd& crowd)
{
    const int root = gathered_ % ranks_;
    std::optional<View> view = from.gather(crowd, root);
    if (view) view_ = std::move(view);
    if (gathered_ == 0) {
        // All show the same part of the plane.
        PictureBounds bounds;
        if (rank_ == root) bounds = bounds_of(*view_);
        MPI_Bcast(&bounds, sizeof bounds, MPI_BYTE, root, MPI_COMM_WORLD);
        writer_->fit(bounds);
    }
    if (++gathered_ % ranks_ == 0) draw(crowd.executor());
}

void DistributedFrames::draw(Executor& executor)
{
    try_on_all([&] {
        if (view_) writer_->write(*view_, executor);
        view_.reset();
    });
}

}  // namespace motley::bench
