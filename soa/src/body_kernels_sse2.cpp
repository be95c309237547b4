// Bodies, by row and as copies of figures. SSE2: four lanes.
#include "figure.h"
#include "kernel_prelude.h"

#include <xsimd/xsimd.hpp>

namespace motley {
namespace {

using Arch = xsimd::sse2;
#include "lanes.h"
#include "quads_sse.h"

#include "body_kernels.h"

}  // namespace

void enter_body_kernels_sse2(KernelTable& table)
{
    enter_body_kernels(table);
}

}  // namespace motley
