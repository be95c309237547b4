// Figures: the bodies of copies and their trees. NEON: four lanes.
#include "figure.h"
#include "kernel_prelude.h"

#include <xsimd/xsimd.hpp>

namespace motley {
namespace {

using Arch = xsimd::neon64;
#include "lanes.h"
#include "quads_neon.h"

#include "figure_kernels.h"

}  // namespace

void enter_figure_kernels_neon(FigureKernels& kernels)
{
    enter_figure_kernels(kernels);
}

}  // namespace motley
