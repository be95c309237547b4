// AVX2: eight lanes. Compiled with FMA allowed but contraction off: equal bits forbid it.
// Included inside an anonymous namespace, once by each file of kernels: see constraint_kernels.cpp.

using Arch = xsimd::avx2;
#include "lanes.h"
#include "quads_avx.h"
