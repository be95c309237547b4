// Figures: the bodies of copies and their trees. AVX2: eight lanes.
#include "figure.h"
#include "kernel_prelude.h"

#include <xsimd/xsimd.hpp>

namespace motley {
namespace {

using Arch = xsimd::avx2;
#include "lanes.h"
#include "quads_avx.h"

#include "figure_kernels.h"

}  // namespace

void enter_figure_kernels_avx2(FigureKernels& kernels)
{
    enter_figure_kernels(kernels);
}

}  // namespace motley
