// NEON: four lanes.
#include "kernel_prelude.h"

#include <xsimd/xsimd.hpp>

namespace motley {
namespace {

using Arch = xsimd::neon64;
#include "lanes.h"
#include "quads_neon.h"

#include "kernels.h"

}  // namespace

const KernelTable& kernel_table_neon()
{
    static const KernelTable table = make_table();
    return table;
}

}  // namespace motley
