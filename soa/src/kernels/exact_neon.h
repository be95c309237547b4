// Division and square root with NEON as IEEE 754 rounds them. xsimd 8.1 estimates both and corrects the estimate
// twice, also for 64-bit ARM, which has instructions for them: the last bit differs from every other machine's, and
// the estimate of 1 / sqrt(0) raises a division by zero. Included before lanes.h, whose templates these overloads
// take precedence over.
#pragma once

[[gnu::always_inline]] inline xsimd::batch<float, Arch> quotient(const xsimd::batch<float, Arch>& x,
                                                                 const xsimd::batch<float, Arch>& y)
{
    return vdivq_f32(x, y);
}

[[gnu::always_inline]] inline xsimd::batch<float, Arch> root(const xsimd::batch<float, Arch>& x)
{
    return vsqrtq_f32(x);
}
