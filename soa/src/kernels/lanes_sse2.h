// SSE2: four lanes.
// Included inside an anonymous namespace, once by each file of kernels: see constraint_kernels.cpp.
#pragma once

using Arch = xsimd::sse2;
#include "kernels/lanes.h"
#include "kernels/quads_sse.h"
