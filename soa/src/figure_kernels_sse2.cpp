// Figures: the bodies of copies and their trees. SSE2: four lanes.
#include "figure.h"
#include "kernel_prelude.h"

#include <xsimd/xsimd.hpp>

namespace motley {
namespace {

using Arch = xsimd::sse2;
#include "lanes.h"
#include "quads_sse.h"

#include "figure_kernels.h"

}  // namespace

void enter_figure_kernels_sse2(FigureKernels& kernels)
{
    enter_figure_kernels(kernels);
}

}  // namespace motley
