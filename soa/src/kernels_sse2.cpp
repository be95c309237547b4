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

void enter_kernels_sse2(KernelTable& table)
{
    enter_kernels(table);
}

}  // namespace motley
