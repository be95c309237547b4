// Bodies into lanes two ways: four rows' quads turned in registers, which is what the kernels do, or a hardware gather a
// field. Measured by motley_benchmarks, for what an instruction set's gather is worth.
#pragma once

#include <cstdint>

namespace motley::bench {

/// Sums all fields of rows of eight floats (a rigid body's velocity) in the order of an index; `count` a multiple of 16.
using SumRows = float (*)(const float* rows, const std::int32_t* index, std::int64_t count);

float sum_by_transpose_avx2(const float* rows, const std::int32_t* index, std::int64_t count);
float sum_by_gather_avx2(const float* rows, const std::int32_t* index, std::int64_t count);
float sum_by_transpose_avx512(const float* rows, const std::int32_t* index, std::int64_t count);
float sum_by_gather_avx512(const float* rows, const std::int32_t* index, std::int64_t count);

}  // namespace motley::bench
