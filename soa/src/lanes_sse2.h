// SSE2: four lanes.
// Included inside an anonymous namespace, once by each file of kernels: see constraint_kernels.cpp.

using Arch = xsimd::sse2;
#include "lanes.h"
#include "quads_sse.h"
