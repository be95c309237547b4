// Sweeps between two looks at the bodies: how far constraints are from their solution, and where they come to rest. What a sweep
// does to a block's bodies is what each of its constraints does, for they share no moving body; so all types are watched alike.
#pragma once

#include "figure.h"
#include "kernel_table.h"

namespace motley {

/// Whether sweeps of solve and relax have to be watched.
inline bool is_watched(const KernelContext& context)
{
    return context.measure != Measure::nothing || context.step.comes_to_rest;
}

/// Runs a sweep of solve or relax over blocks [begin, end) of one class. With StepConstants::comes_to_rest, takes back what makes
/// no difference (see rest.h). Notes each constraint's LaneResidual in streams.residuals, as KernelContext::measure says;
/// Measure::without_solving leaves velocities and impulses as they were.
void watched_sweep(const KernelContext& context, const KernelTable& kernels, const BlockStreams& streams,
                   ConstraintKernels::Sweep sweep, int impulse_floats, std::int32_t begin, std::int32_t end);

/// Runs a sweep over a joint of a block of copies and takes back what makes no difference.
void sweep_to_rest(const KernelContext& context, const FigureKernels& kernels,
                   const FigureBlock::Joint& joint, ConstraintKernels::CopiesSweep sweep, float* body_a,
                   float* body_b);

}  // namespace motley
