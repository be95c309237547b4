// A step of a figure's block.
#pragma once

#include <span>

#include "figures/figure.h"
#include "step/plan.h"

namespace motley {

/// Runs the whole step, in cache, for a block whose bodies are touched by its own joints and contacts only. `data` has
/// an entry for each type. Stages of the plan that concern the whole scene are skipped: the caller runs them.
void step_figure(const KernelContext& context, const FigureKernels& kernels, const FigureBlock& block,
                 std::span<const ConstraintData> data, const Plan& plan);

// For a block whose bodies something else touches, ordinary sweeps do everything but the tree, which these do:
/// Factors the tree at the present poses: before each substep; or, with relaxations, before the first substep and
/// after each integration of positions.
void prepare_tree(const KernelContext& context, const FigureKernels& kernels, const FigureBlock& block);
/// Before the first sweep of a substep: the impulses of its locks start from zero. Where its light bodies are under much more tension
/// than in the last substep, the tree is factored again.
void begin_tree(const KernelContext& context, const FigureKernels& kernels, const FigureBlock& block);
/// After the warm start: lets the joints beside the tree step as far as its locks allow (locked_point.h).
void lengthen_steps(const FigureBlock& block);
/// Solves the tree; after each sweep.
void solve_tree(const KernelContext& context, const FigureKernels& kernels, const FigureBlock& block,
                float rate);

}  // namespace motley
