// SSE2: four lanes.
#include "kernel_prelude.h"

#include <xsimd/xsimd.hpp>

namespace motley {
namespace {

using Arch = xsimd::sse2;
#include "lanes.h"
#include "quads_sse.h"

#include "kernels.h"

}  // namespace

const KernelTable& kernel_table_sse2()
{
    static const KernelTable table = make_table();
    return table;
}

}  // namespace motley
