// Sweeps that measure how far constraints are from their solution, by comparing the bodies before and after. The
// constraints of a block share no moving body, so what a sweep does to a body is done by one constraint, and all
// types are measured alike.
#pragma once

#include "kernels/kernel_table.h"

namespace motley {

/// Runs a sweep of solve or relax over blocks [begin, end) of one class and stores each constraint's LaneResidual in
/// streams.residuals, as KernelContext::measure says; Measure::without_solving leaves velocities and impulses as they
/// were.
void watched_sweep(const KernelContext& context, const KernelTable& kernels, const BlockStreams& streams,
                   ConstraintKernels::Sweep sweep, int impulse_floats, std::int32_t begin, std::int32_t end);

}  // namespace motley
