// Scalar: one lane, the lane maths instantiated on float. What the other instruction sets must equal to the
// bit.
#include "kernel_prelude.h"

namespace motley {
namespace {

using Lanes = float;
#include "quads_scalar.h"

#include "kernels.h"

}  // namespace

void enter_kernels_scalar(KernelTable& table)
{
    enter_kernels(table);
}

}  // namespace motley
