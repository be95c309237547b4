// NEON: four lanes.
#include "kernel_prelude.h"

#include <xsimd/xsimd.hpp>

namespace motley {
namespace {

using Arch = xsimd::neon64;
#include "exact_neon.h"
#include "lanes.h"
#include "quads_neon.h"

#include "kernels.h"

}  // namespace

void enter_kernels_neon(KernelTable& table)
{
    enter_kernels(table);
}

}  // namespace motley
