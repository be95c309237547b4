// Bodies, by row and as copies of figures. Scalar: one lane.
#include "figure.h"
#include "kernel_prelude.h"

namespace motley {
namespace {

using Lanes = float;
#include "quads_scalar.h"

#include "body_kernels.h"

}  // namespace

void enter_body_kernels_scalar(KernelTable& table)
{
    enter_body_kernels(table);
}

}  // namespace motley
