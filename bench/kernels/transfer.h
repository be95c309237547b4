// Two ways to load bodies into lanes: transposing quads of four rows in registers, as the kernels do, or a hardware
// gather for each field. motley_benchmarks measures what an instruction set's gather is worth.
#pragma once

#include <cstdint>

namespace motley::bench {

/// Sums all fields of rows of eight floats (a rigid body's velocity) in the order of an index. `count` is a multiple
/// of 16.
using SumRows = float (*)(const float* rows, const std::int32_t* index, std::int64_t count);

/// The two ways on one instruction set.
struct Transfers {
    SumRows by_transpose, by_gather;
};
Transfers transfers_avx2();
Transfers transfers_avx512();

}  // namespace motley::bench
