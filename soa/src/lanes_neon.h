// NEON: four lanes.
// Included inside an anonymous namespace, once by each file of kernels: see constraint_kernels.cpp.

using Arch = xsimd::neon64;
#include "exact_neon.h"
#include "lanes.h"
#include "quads_neon.h"
