// Transpose and gather with AVX2.
#include "kernels/kernel_prelude.h"
#include "kernels/transfer.h"

#include <xsimd/xsimd.hpp>

namespace motley {
namespace {

using Arch = xsimd::avx2;
#include "kernels/lanes.h"
#include "kernels/quads_avx.h"

/// Gathers one field of eight rows, each of eight floats.
Lanes gather_field(const float* field, const std::int32_t* index)
{
    const __m256i rows = _mm256_slli_epi32(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(index)), 3);
    return Lanes(_mm256_i32gather_ps(field, rows, 4));
}

#include "kernels/transfer_loop.h"

}  // namespace

bench::Transfers bench::transfers_avx2()
{
    return {sum_by_transpose, sum_by_gather};
}

}  // namespace motley
