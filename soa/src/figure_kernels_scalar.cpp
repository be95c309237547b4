// Figures: the bodies of copies and their trees. Scalar: one lane.
#include "figure.h"
#include "kernel_prelude.h"

namespace motley {
namespace {

using Lanes = float;
#include "quads_scalar.h"

#include "figure_kernels.h"

}  // namespace

void enter_figure_kernels_scalar(FigureKernels& kernels)
{
    enter_figure_kernels(kernels);
}

}  // namespace motley
