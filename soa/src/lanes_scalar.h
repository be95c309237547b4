// Scalar: one lane, the lane maths instantiated on float. What the other instruction sets must equal to the bit.
// Included inside an anonymous namespace, once by each file of kernels: see constraint_kernels.cpp.

using Lanes = float;
#include "quads_scalar.h"
