// The kernels of the constraint types of one header, for one instruction set. The build compiles this file once for
// each pair of them and each KernelShare, and says which by macros: MOTLEY_ISA (avx2), MOTLEY_LANES ("lanes_avx2.h"),
// MOTLEY_CONSTRAINTS (the header), MOTLEY_TYPES (its list of types) and MOTLEY_SHARE.
//
// What depends on the instruction set is inside an anonymous namespace: code compiled for a wide one must have
// internal linkage, or the linker could pick it for all.
#include MOTLEY_CONSTRAINTS

#include "kernels/kernel_prelude.h"

namespace motley {
namespace {

#include MOTLEY_LANES
#include "kernels/kernels.h"

}  // namespace

template <>
void enter_constraint_kernels<Isa::MOTLEY_ISA, KernelShare::MOTLEY_SHARE, MOTLEY_TYPES>(
    ConstraintKernels* pairs)
{
    enter_types<KernelShare::MOTLEY_SHARE>(pairs, MOTLEY_TYPES{});
}

}  // namespace motley
