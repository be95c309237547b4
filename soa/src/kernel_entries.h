// What each file of kernels defines for its instruction set: functions that enter its kernels into a table made elsewhere. A
// table made there would need a constructor, a weak function compiled for that instruction set.
#pragma once

#include "block.h"

namespace motley {

/// Kernels are compiled in four shares.
enum class KernelShare {
    swept,  ///< what every substep runs of usual pairs (see is_usual): for speed
    once,   ///< what brings those into lanes when a step begins, and stores what they did: for size
    unusual,  ///< what every substep runs of unusual pairs: for speed, but in some lanes only (see rare_lanes_of)
    rare,  ///< what a setting asks for, and the rest of unusual pairs: for size, and in some lanes only
};

/// Of the types of one constraint header, by pair of body kinds: the entry of class_of, counted from the first of them.
template <Isa isa, KernelShare share, class Types>
void enter_constraint_kernels(ConstraintKernels* pairs);
/// What moves bodies, sees what sweeps do to them, and brings copies of figures into lanes and back.
template <Isa isa>
void enter_body_kernels(BodyKernels* kinds, FigureKernels& figures);
/// FigureKernels::factor and solve.
template <Isa isa>
void enter_tree_kernels(FigureKernels& figures);

}  // namespace motley
