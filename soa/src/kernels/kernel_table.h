// Every kernel of one instruction set.
#pragma once

#include "contract/constraint_types.h"
#include "layout/block.h"

namespace motley {

inline constexpr int class_count = constraint_type_count * body_kind_count * body_kind_count;

/// Kernels of constraints by class_of, of bodies by kind, of figures and of discs.
struct KernelTable {
    int width = 1;  ///< lanes of the kernels that sweep
    ConstraintKernels constraints[class_count];
    BodyKernels bodies[body_kind_count];
    FigureKernels figures;
    DiscKernels discs;
};

/// The table compiled for an instruction set; only for those of available_isas().
const KernelTable& kernel_table(Isa isa);

}  // namespace motley
