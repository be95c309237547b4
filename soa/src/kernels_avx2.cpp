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

const KernelTable& kernel_table_avx2()
{
    static const KernelTable table = make_table();
    return table;
}

}  // namespace motley
