// Scalar: one lane, the lane maths instantiated on float. The other instruction sets must give the same bits.
// Included inside an anonymous namespace, once by each file of kernels: see constraint_kernels.cpp.
#pragma once

using Lanes = float;
[[gnu::always_inline]] inline bool any(bool mask)
{
    return mask;
}
#include "kernels/quads_scalar.h"
