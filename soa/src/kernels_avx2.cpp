// AVX2: eight lanes. Compiled with FMA allowed but contraction off: equal bits forbid it.
#include "kernel_prelude.h"

#include <xsimd/xsimd.hpp>

namespace motley {
namespace {

using Arch = xsimd::avx2;
#include "lanes.h"
#include "quads_avx.h"

#include "kernels.h"

}  // namespace

void enter_kernels_avx2(KernelTable& table)
{
    enter_kernels(table);
}

}  // namespace motley
