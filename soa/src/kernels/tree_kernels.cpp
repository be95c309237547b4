// The kernels that solve all locks of a figure at once, one copy per lane, for one instruction set: see
// constraint_kernels.cpp.
#include "kernels/kernel_prelude.h"

namespace motley {
namespace {

#include MOTLEY_LANES
#include "kernels/kernel_rows.h"

#include "kernels/kernel_bodies.h"

#include "kernels/kernel_tumble.h"

#include "kernels/kernel_integration.h"

#include "kernels/kernel_copies.h"

#include "kernels/kernel_tree_rows.h"

#include "kernels/kernel_acting_rows.h"
#include "kernels/kernel_elimination.h"
#include "kernels/kernel_rigid_trees.h"

#include "kernels/kernel_stiffness.h"

#include "kernels/kernel_trees.h"

#include "kernels/kernel_tension.h"

#include "kernels/kernel_closures.h"

}  // namespace

template <>
void enter_tree_kernels<Isa::MOTLEY_ISA>(FigureKernels& figures)
{
    figures.factor = factor_trees;
    figures.follow_tension = follow_tensions;
    figures.solve = solve_trees;
    figures.correct = correct_trees;
}

}  // namespace motley
