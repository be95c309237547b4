// See watched_sweep.h.
#include "step/watched_sweep.h"

#include <algorithm>

#include "maths/lane_residual.h"

namespace motley {
namespace {

/// The bodies of one side (a or b) of a block, as they were before a sweep.
class KeptBodies {
  public:
    KeptBodies(const KernelContext& context, const KernelTable& kernels, BodyKind kind,
               const std::int32_t* offsets)
        : arrays_(context.bodies[static_cast<int>(kind)]),
          kernels_(kernels.bodies[static_cast<int>(kind)]),
          offsets_(offsets)
    {
        kernels_.keep(arrays_, offsets_, kept_);
    }
    void find_energy() { kernels_.find_energy(arrays_, offsets_, kept_, energy, inverse_mass); }
    void bring_back(int count) const
    {
        if (arrays_.can_move) kernels_.bring_back(arrays_, offsets_, kept_, count);
    }
    // What the sweep did, by lane.
    alignas(64) float energy[block_lanes];        ///< dv^T M dv, J
    alignas(64) float inverse_mass[block_lanes];  ///< 1/kg

  private:
    const BodyArrays& arrays_;
    const BodyKernels& kernels_;
    const std::int32_t* offsets_;
    alignas(64) float kept_[most_body_floats * block_lanes];
};

void note_residuals(const KeptBodies& a, const KeptBodies& b, const BlockStreams& streams, std::int32_t block)
{
    constexpr int residual_floats = sizeof(LaneResidual<float>) / sizeof(float);
    float* residual = streams.residuals + std::int64_t{block} * residual_floats * block_lanes;
    for (int lane = 0; lane < block_lanes; ++lane) {
        const LaneResidual<float> of_lane =
            residual_of(a.energy[lane] + b.energy[lane], a.inverse_mass[lane] + b.inverse_mass[lane]);
        residual[lane] = of_lane.energy;
        residual[block_lanes + lane] = of_lane.speed;
    }
}

}  // namespace

void watched_sweep(const KernelContext& context, const KernelTable& kernels, const BlockStreams& streams,
                   ConstraintKernels::Sweep sweep, int impulse_floats, std::int32_t begin, std::int32_t end)
{
    for (std::int32_t block = begin; block < end; ++block) {
        KeptBodies a(context, kernels, streams.kind_a, streams.bodies[block].a);
        KeptBodies b(context, kernels, streams.kind_b, streams.bodies[block].b);
        const int floats = impulse_floats * block_lanes;
        float* const impulses = streams.impulses + std::int64_t{block} * floats;
        float kept[most_impulse_floats * block_lanes];
        std::copy(impulses, impulses + floats, kept);
        sweep(context, streams, block, block + 1);
        a.find_energy();
        b.find_energy();
        note_residuals(a, b, streams, block);
        if (context.measure != Measure::without_solving) continue;
        std::copy(kept, kept + floats, impulses);
        a.bring_back(streams.counts[block]);
        b.bring_back(streams.counts[block]);
    }
}

}  // namespace motley
