// A bundle of lanes as a Real: xsimd's batch under the few operations that constraint maths may use. The wrapper
// exists because every instruction set must give the same bits: negation flips the sign (xsimd 8.1 subtracts from
// zero with AVX-512, which loses -0), and no operation that differs between instruction sets is offered.
//
// Included once by each file of kernels (see constraint_kernels.cpp), inside an anonymous namespace: every template
// over these lanes then has internal linkage, so code compiled for a wide instruction set cannot be picked by the
// linker for another. No includes: the including file sets Arch first.
#pragma once

// Both must round to nearest. Where xsimd does not, overloads replace them (exact_neon.h).
template <class Batch>
[[gnu::always_inline]] inline Batch quotient(const Batch& x, const Batch& y)
{
    return x / y;
}
template <class Batch>
[[gnu::always_inline]] inline Batch root(const Batch& x)
{
    return xsimd::sqrt(x);
}

class Mask {
  public:
    explicit Mask(xsimd::batch_bool<float, Arch> m) : bits(m) {}
    friend Mask operator&(const Mask& x, const Mask& y) { return Mask(x.bits & y.bits); }
    friend bool any(const Mask& x) { return xsimd::any(x.bits); }
    xsimd::batch_bool<float, Arch> bits;
};

class Lanes {
  public:
    static constexpr int width = static_cast<int>(xsimd::batch<float, Arch>::size);

    Lanes() = default;
    explicit Lanes(float value) : v(value) {}
    explicit Lanes(xsimd::batch<float, Arch> batch) : v(batch) {}
    static Lanes load(const float* aligned)
    {
        return Lanes(xsimd::batch<float, Arch>::load_aligned(aligned));
    }
    void store(float* aligned) const { v.store_aligned(aligned); }

    friend Lanes operator+(const Lanes& x, const Lanes& y) { return Lanes(x.v + y.v); }
    friend Lanes operator-(const Lanes& x, const Lanes& y) { return Lanes(x.v - y.v); }
    friend Lanes operator*(const Lanes& x, const Lanes& y) { return Lanes(x.v * y.v); }
    // Where kernels are compiled for size, g++ would call a function for this one instruction, which is larger.
    [[gnu::always_inline]] friend Lanes operator/(const Lanes& x, const Lanes& y)
    {
        return Lanes(quotient(x.v, y.v));
    }
    friend Lanes operator-(const Lanes& x) { return Lanes(x.v ^ xsimd::batch<float, Arch>(-0.0F)); }
    friend Mask operator<(const Lanes& x, const Lanes& y) { return Mask(x.v < y.v); }
    friend Mask operator>(const Lanes& x, const Lanes& y) { return Mask(x.v > y.v); }
    friend Lanes select(const Mask& mask, const Lanes& if_true, const Lanes& if_false)
    {
        return Lanes(xsimd::select(mask.bits, if_true.v, if_false.v));
    }
    friend Lanes square_root(const Lanes& x) { return Lanes(root(x.v)); }

    xsimd::batch<float, Arch> v;
};

[[gnu::always_inline]] inline Lanes load_lanes(const float* aligned)
{
    return Lanes::load(aligned);
}
[[gnu::always_inline]] inline void store_lanes(const Lanes& lanes, float* aligned)
{
    lanes.store(aligned);
}
