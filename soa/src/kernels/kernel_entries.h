// What each file of kernels defines for its instruction set: functions that enter its kernels into a table made
// elsewhere. A table made there would need a constructor, a weak function compiled for that instruction set, which
// the linker could pick for the whole program.
#pragma once

#include "layout/block.h"

namespace motley {

/// Kernels are compiled in four shares, optimised for speed or for size.
enum class KernelShare {
    swept,  ///< run in every substep, for usual pairs (see is_usual): for speed
    once,   ///< run at the start and end of a step, for usual pairs: for size
    unusual,  ///< run in every substep, for the other pairs: for speed; not on every instruction set (rare_lanes_of)
    rare,  ///< run only with some settings, or at the start and end for the other pairs: for size; likewise
};

/// Enters the kernels of the types of one constraint header, by pair of body kinds: `pairs` is indexed by class_of,
/// counted from the first of these types.
template <Isa isa, KernelShare share, class Types>
void enter_constraint_kernels(ConstraintKernels* pairs);
/// Enters the kernels that integrate bodies, that measure what sweeps change, and that load and store copies of
/// figures.
template <Isa isa>
void enter_body_kernels(BodyKernels* kinds, FigureKernels& figures);
/// Enters the kernels of contacts of discs.
template <Isa isa>
void enter_disc_kernels(DiscKernels& discs);
/// Enters FigureKernels::factor and solve.
template <Isa isa>
void enter_tree_kernels(FigureKernels& figures);

}  // namespace motley
