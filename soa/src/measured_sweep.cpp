// See measured_sweep.h.
#include "measured_sweep.h"

#include <algorithm>

#include "motley/core/lane_residual.h"

namespace motley {
namespace {

/// One side of a block: its bodies before the sweep, and what the sweep changed.
class Side {
  public:
    Side(const KernelContext& context, const KernelTable& kernels, BodyKind kind, const std::int32_t* offsets)
        : arrays_(context.bodies[static_cast<int>(kind)]),
          kernels_(kernels.bodies[static_cast<int>(kind)]),
          offsets_(offsets)
    {
        kernels_.keep(arrays_, offsets_, kept_);
    }
    void find_change() { kernels_.find_change(arrays_, offsets_, kept_, energy, inverse_mass); }
    void bring_back(int count) const
    {
        if (arrays_.can_move) kernels_.bring_back_velocities(arrays_, offsets_, kept_, count);
    }

    alignas(64) float energy[block_lanes];  ///< of the change, dv^T M dv, J
    alignas(64) float inverse_mass[block_lanes];

  private:
    const BodyArrays& arrays_;
    const BodyKernels& kernels_;
    const std::int32_t* offsets_;
    alignas(64) float kept_[most_body_floats * block_lanes];
};

}  // namespace

void measured_sweep(const KernelContext& context, const KernelTable& kernels, int impulse_floats,
                    const BlockStreams& streams, ConstraintKernels::Sweep sweep, std::int32_t begin,
                    std::int32_t end)
{
    const bool solves = context.measure == Measure::while_solving;
    for (std::int32_t block = begin; block < end; ++block) {
        Side a(context, kernels, streams.kind_a, streams.bodies[block].a);
        Side b(context, kernels, streams.kind_b, streams.bodies[block].b);
        const std::int64_t size = std::int64_t{impulse_floats} * block_lanes;
        float* impulses = streams.impulses + block * size;
        float kept[most_impulse_floats * block_lanes];
        if (!solves) std::copy(impulses, impulses + size, kept);
        sweep(context, streams, block, block + 1);
        a.find_change();
        b.find_change();
        constexpr int residual_floats = sizeof(LaneResidual<float>) / sizeof(float);
        float* residual = streams.residuals + std::int64_t{block} * residual_floats * block_lanes;
        for (int lane = 0; lane < block_lanes; ++lane) {
            const LaneResidual<float> of_lane =
                residual_of(a.energy[lane] + b.energy[lane], a.inverse_mass[lane] + b.inverse_mass[lane]);
            residual[lane] = of_lane.energy;
            residual[block_lanes + lane] = of_lane.speed;
        }
        if (solves) continue;
        std::copy(kept, kept + size, impulses);
        a.bring_back(streams.counts[block]);
        b.bring_back(streams.counts[block]);
    }
}

}  // namespace motley
