// Figures: the bodies of copies and their trees. AVX-512: sixteen lanes, a whole block at once.
#include "figure.h"
#include "kernel_prelude.h"

#include <xsimd/xsimd.hpp>

namespace motley {
namespace {

using Arch = xsimd::avx512f;
#include "lanes.h"
#include "quads_avx512.h"

#include "figure_kernels.h"

}  // namespace

void enter_figure_kernels_avx512(FigureKernels& kernels)
{
    enter_figure_kernels(kernels);
}

}  // namespace motley
