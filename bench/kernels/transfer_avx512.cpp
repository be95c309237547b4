// Transpose and gather with AVX-512.
#include "kernels/kernel_prelude.h"
#include "kernels/transfer.h"

#include <xsimd/xsimd.hpp>

namespace motley {
namespace {

using Arch = xsimd::avx512f;
#include "kernels/lanes.h"
#include "kernels/quads_avx512.h"

/// Gathers one field of sixteen rows, each of eight floats.
Lanes gather_field(const float* field, const std::int32_t* index)
{
    const __m512i rows = _mm512_slli_epi32(_mm512_loadu_si512(index), 3);
    return Lanes(_mm512_i32gather_ps(rows, field, 4));
}

#include "kernels/transfer_loop.h"

}  // namespace

bench::Transfers bench::transfers_avx512()
{
    return {sum_by_transpose, sum_by_gather};
}

}  // namespace motley
