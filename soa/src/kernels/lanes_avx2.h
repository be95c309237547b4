// AVX2: eight lanes. Compiled with FMA enabled but without contraction, which would change the bits.
// Included inside an anonymous namespace, once by each file of kernels: see constraint_kernels.cpp.
#pragma once

using Arch = xsimd::avx2;
#include "kernels/lanes.h"
#include "kernels/quads_avx.h"
