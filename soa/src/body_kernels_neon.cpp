// Bodies, by row and as copies of figures. NEON: four lanes.
#include "figure.h"
#include "kernel_prelude.h"

#include <xsimd/xsimd.hpp>

namespace motley {
namespace {

using Arch = xsimd::neon64;
#include "exact_neon.h"
#include "lanes.h"
#include "quads_neon.h"

#include "body_kernels.h"

}  // namespace

void enter_body_kernels_neon(KernelTable& table)
{
    enter_body_kernels(table);
}

}  // namespace motley
