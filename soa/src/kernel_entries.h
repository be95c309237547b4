// What each file of kernels defines for its instruction set: functions that enter its kernels into a table made elsewhere. A
// table made there would need a constructor, a weak function compiled for that instruction set.
#pragma once

#include "block.h"

namespace motley {

/// Kernels are compiled in two shares: for speed what every substep runs of pairs of like bodies, and of bodies and fixed ones;
/// for size what runs once a step or where a setting asks for it, and all of pairs of two models.
enum class KernelShare { swept, rare };

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
