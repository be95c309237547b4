// How far constraints are from their solution, by what one more sweep changes of their bodies.
#pragma once

#include "kernel_table.h"

namespace motley {

/// Runs a sweep over blocks [begin, end) of one class and notes each constraint's LaneResidual in streams.residuals. A
/// block's constraints share no moving body, so what its sweep does to a body is what one constraint does.
/// Measure::without_solving leaves velocities and impulses as they were.
void measured_sweep(const KernelContext& context, const KernelTable& kernels, int impulse_floats,
                    const BlockStreams& streams, ConstraintKernels::Sweep sweep, std::int32_t begin,
                    std::int32_t end);

}  // namespace motley
