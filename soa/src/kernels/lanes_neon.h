// NEON: four lanes.
// Included inside an anonymous namespace, once by each file of kernels: see constraint_kernels.cpp.
#pragma once

using Arch = xsimd::neon64;
#include "kernels/exact_neon.h"
#include "kernels/lanes.h"
#include "kernels/quads_neon.h"
