// See watched_sweep.h.
#include "watched_sweep.h"

#include <algorithm>

#include "motley/core/lane_residual.h"
#include "motley/core/rest.h"

namespace motley {
namespace {

/// What a sweep did to one side of a block, by lane.
struct SideChange {
    alignas(64) float energy[block_lanes];        ///< dv^T M dv, J
    alignas(64) float inverse_mass[block_lanes];  ///< 1/kg
    alignas(64) float changes[block_lanes];       ///< squares of speeds, m2/s2: of the change
    alignas(64) float speeds[block_lanes];        ///< and of what was there before
};

/// 1 where the sweep made a difference to the bodies of a lane, else 0.
struct GoesOn {
    alignas(64) float lane[block_lanes] = {};
};
GoesOn lanes_that_go_on(const SideChange& a, const SideChange& b)
{
    GoesOn goes_on;
    for (int lane = 0; lane < block_lanes; ++lane) {
        const bool differs =
            makes_a_difference(a.changes[lane] + b.changes[lane], a.speeds[lane] + b.speeds[lane]);
        goes_on.lane[lane] = differs ? 1.0F : 0.0F;
    }
    return goes_on;
}

/// The impulses of a block before a sweep.
class KeptImpulses {
  public:
    KeptImpulses(const BlockStreams& streams, std::int32_t block, int floats)
        : floats_(floats), impulses_(streams.impulses + std::int64_t{block} * floats * block_lanes)
    {
        std::copy(impulses_, impulses_ + floats_ * block_lanes, kept_);
    }
    void bring_back(const GoesOn& goes_on)
    {
        for (int i = 0; i < floats_ * block_lanes; ++i)
            impulses_[i] = goes_on.lane[i % block_lanes] > 0 ? impulses_[i] : kept_[i];
    }

  private:
    int floats_;
    float* impulses_;
    float kept_[most_impulse_floats * block_lanes];
};

/// One side of a block of rows, from before a sweep on.
class Side {
  public:
    Side(const KernelContext& context, const KernelTable& kernels, BodyKind kind, const std::int32_t* offsets)
        : arrays_(context.bodies[static_cast<int>(kind)]),
          kernels_(kernels.bodies[static_cast<int>(kind)]),
          offsets_(offsets)
    {
        kernels_.keep(arrays_, offsets_, kept_);
    }
    void find_energy() { kernels_.find_energy(arrays_, offsets_, kept_, change.energy, change.inverse_mass); }
    void find_speeds() { kernels_.find_speeds(arrays_, offsets_, kept_, change.changes, change.speeds); }
    void bring_back(const GoesOn& goes_on, int count) const
    {
        if (arrays_.can_move) kernels_.bring_back(arrays_, offsets_, kept_, goes_on.lane, count);
    }
    SideChange change;

  private:
    const BodyArrays& arrays_;
    const BodyKernels& kernels_;
    const std::int32_t* offsets_;
    alignas(64) float kept_[most_body_floats * block_lanes];
};

void note_residuals(const SideChange& a, const SideChange& b, const BlockStreams& streams, std::int32_t block)
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
        Side a(context, kernels, streams.kind_a, streams.bodies[block].a);
        Side b(context, kernels, streams.kind_b, streams.bodies[block].b);
        KeptImpulses impulses(streams, block, impulse_floats);
        const auto bring_back = [&](const GoesOn& goes_on) {
            impulses.bring_back(goes_on);
            a.bring_back(goes_on, streams.counts[block]);
            b.bring_back(goes_on, streams.counts[block]);
        };
        sweep(context, streams, block, block + 1);
        if (context.step.comes_to_rest) {
            a.find_speeds();
            b.find_speeds();
            bring_back(lanes_that_go_on(a.change, b.change));
        }
        if (context.measure == Measure::nothing) continue;
        a.find_energy();
        b.find_energy();
        note_residuals(a.change, b.change, streams, block);
        if (context.measure == Measure::without_solving) bring_back(GoesOn{});
    }
}

void sweep_to_rest(const KernelContext& context, const FigureKernels& kernels,
                   const FigureBlock::Joint& joint, ConstraintKernels::CopiesSweep sweep, float* body_a,
                   float* body_b)
{
    constexpr int floats = most_body_floats * block_lanes;
    alignas(64) float kept_a[floats], kept_b[floats];
    std::copy(body_a, body_a + floats, kept_a);
    std::copy(body_b, body_b + floats, kept_b);
    KeptImpulses impulses(joint.streams, joint.block, joint.kernels->impulse_floats);
    sweep(context, joint.streams, joint.block, body_a, body_b);
    SideChange a, b;
    kernels.find_speeds(body_a, kept_a, a.changes, a.speeds);
    kernels.find_speeds(body_b, kept_b, b.changes, b.speeds);
    const GoesOn goes_on = lanes_that_go_on(a, b);
    impulses.bring_back(goes_on);
    kernels.bring_back(body_a, kept_a, goes_on.lane);
    kernels.bring_back(body_b, kept_b, goes_on.lane);
}

}  // namespace motley
