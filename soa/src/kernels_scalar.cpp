// Scalar: one lane, the lane maths instantiated on float. What the other instruction sets must equal to the
// bit.
#include "kernel_prelude.h"

namespace motley {
namespace {

using Lanes = float;
#include "quads_scalar.h"

#include "kernels.h"

}  // namespace

const KernelTable& kernel_table_scalar()
{
    static const KernelTable table = make_table();
    return table;
}

}  // namespace motley
