// AVX-512: sixteen lanes, a whole block at once.
// Included inside an anonymous namespace, once by each file of kernels: see constraint_kernels.cpp.
#pragma once

using Arch = xsimd::avx512f;
#include "kernels/lanes.h"
#include "kernels/quads_avx512.h"
