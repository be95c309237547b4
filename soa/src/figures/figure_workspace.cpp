// Hands out pointers into a workspace, in the order in which a step uses what they point at.
#include "figures/figure_workspace.h"

#include <utility>

namespace motley {
namespace {

std::int64_t body_floats(const FigureShape& shape)
{
    return static_cast<std::int64_t>(shape.bodies.size()) * CopyBody::floats;
}

}  // namespace

void FigureWorkspace::make_room(std::span<const FigureBlock> blocks)
{
    const FigureShape* last = nullptr;
    for (const FigureBlock& block : blocks) {
        if (std::exchange(last, block.shape) == block.shape) continue;  // same shape again
        const std::size_t joints = block.shape->joints.size();
        std::int64_t floats = body_floats(*block.shape) + block.shape->system_floats;
        for (std::size_t i = 0; i < joints; ++i) {
            const ConstraintKernels& kernels = *block.joints[i].kernels;
            floats += std::int64_t{kernels.row_floats + kernels.substep_floats + kernels.impulse_floats +
                                   kernels.sum_floats} *
                      block_lanes;
        }
        if (floats_.size() < static_cast<std::size_t>(floats))
            floats_.resize(static_cast<std::size_t>(floats));
        if (joints_.size() < joints) joints_.resize(joints);
    }
}

FigureBlock FigureWorkspace::take_in(const FigureBlock& block)
{
    float* end = floats_.data();
    const auto take = [&](std::int64_t floats) { return std::exchange(end, end + floats); };
    FigureBlock here = block;
    here.bodies = take(body_floats(*block.shape));
    here.system = take(block.shape->system_floats);
    here.joints = joints_.data();
    for (std::size_t i = 0; i < block.shape->joints.size(); ++i) {
        const auto [kernels, streams, index] = block.joints[i];
        joints_[i] = {kernels,
                      {.kind_a = streams.kind_a,
                       .kind_b = streams.kind_b,
                       .bodies = streams.bodies + index,
                       .counts = streams.counts + index,
                       .constraints = streams.constraints + index,
                       .rows = take(std::int64_t{kernels->row_floats} * block_lanes),
                       .substep_rows = take(std::int64_t{kernels->substep_floats} * block_lanes),
                       .impulses = take(std::int64_t{kernels->impulse_floats} * block_lanes),
                       .sums = take(std::int64_t{kernels->sum_floats} * block_lanes)},
                      0};
    }
    return here;
}

}  // namespace motley
