// AVX-512: sixteen lanes, a whole block at once.
#include "kernel_prelude.h"

#include <xsimd/xsimd.hpp>

namespace motley {
namespace {

using Arch = xsimd::avx512f;
#include "lanes.h"
#include "quads_avx512.h"

#include "kernels.h"

}  // namespace

void enter_kernels_avx512(KernelTable& table)
{
    enter_kernels(table);
}

}  // namespace motley
