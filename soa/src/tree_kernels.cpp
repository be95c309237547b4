// The kernels that solve all locks of a figure at once, one copy per lane, for one instruction set: see
// constraint_kernels.cpp.
#include "kernel_prelude.h"

namespace motley {
namespace {

#include MOTLEY_LANES
#include "kernel_rows.h"

#include "kernel_bodies.h"

#include "kernel_integration.h"

#include "kernel_copies.h"

#include "kernel_tree_rows.h"
#include "kernel_trees.h"

#include "kernel_closures.h"

}  // namespace

template <>
void enter_tree_kernels<Isa::MOTLEY_ISA>(FigureKernels& figures)
{
    figures.factor = factor_trees;
    figures.solve = solve_trees;
}

}  // namespace motley
