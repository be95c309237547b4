// Bodies, by row and as copies of figures. AVX2: eight lanes.
#include "figure.h"
#include "kernel_prelude.h"

#include <xsimd/xsimd.hpp>

namespace motley {
namespace {

using Arch = xsimd::avx2;
#include "lanes.h"
#include "quads_avx.h"

#include "body_kernels.h"

}  // namespace

void enter_body_kernels_avx2(KernelTable& table)
{
    enter_body_kernels(table);
}

}  // namespace motley
