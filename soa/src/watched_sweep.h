// Sweeps between two looks at the bodies: how far constraints are from their solution. What a sweep does to a block's bodies is what
// each of its constraints does, for they share no moving body; so all types are watched alike.
#pragma once

#include "kernel_table.h"

namespace motley {

/// Runs a sweep of solve or relax over blocks [begin, end) of one class and notes each constraint's LaneResidual in
/// streams.residuals, as KernelContext::measure says; Measure::without_solving leaves velocities and impulses as they were.
void watched_sweep(const KernelContext& context, const KernelTable& kernels, const BlockStreams& streams,
                   ConstraintKernels::Sweep sweep, int impulse_floats, std::int32_t begin, std::int32_t end);

}  // namespace motley
