// A step of a figure's block.
#pragma once

#include <span>

#include "figure.h"
#include "plan.h"

namespace motley {

/// The whole step of a block that nothing but its own joints touches, in cache. `data` is that of each type; stages of the
/// plan that are of the whole scene are left to whoever runs that.
void step_figure(const KernelContext& context, const FigureKernels& kernels, const FigureBlock& block,
                 std::span<const ConstraintData> data, const Plan& plan);

// Of blocks that something else touches, what is left to do beside ordinary sweeps: the tree.
/// Factors where the bodies are: before each substep; or, with relaxations, before the first substep and after each move.
void prepare_tree(const KernelContext& context, const FigureKernels& kernels, const FigureBlock& block);
/// Before the first sweep of a substep: the impulses of its locks start from zero.
void begin_tree(const FigureBlock& block);
/// After each sweep.
void solve_tree(const KernelContext& context, const FigureKernels& kernels, const FigureBlock& block,
                float rate);

}  // namespace motley
