// Bodies, by row and as copies of figures. AVX-512: sixteen lanes, a whole block at once.
#include "figure.h"
#include "kernel_prelude.h"

#include <xsimd/xsimd.hpp>

namespace motley {
namespace {

using Arch = xsimd::avx512f;
#include "lanes.h"
#include "quads_avx512.h"

#include "body_kernels.h"

}  // namespace

void enter_body_kernels_avx512(KernelTable& table)
{
    enter_body_kernels(table);
}

}  // namespace motley
