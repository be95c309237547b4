// Loads and stores quads in four lanes. A quad is four floats of a row in memory; `load_quads` fetches the quad at
// rows + stride * index[lane] for each lane and transposes them, so that out[i] holds float i of every lane. `turn`
// is a 4 x 4 transpose; wider lanes do the same in each 128-bit part (quads_avx.h, quads_avx512.h). `store_quads`
// writes the first `count` lanes back.
#pragma once

[[gnu::always_inline]] inline void turn(__m128& r0, __m128& r1, __m128& r2, __m128& r3)
{
    const __m128 t0 = _mm_unpacklo_ps(r0, r1), t1 = _mm_unpackhi_ps(r0, r1);
    const __m128 t2 = _mm_unpacklo_ps(r2, r3), t3 = _mm_unpackhi_ps(r2, r3);
    r0 = _mm_movelh_ps(t0, t2);
    r1 = _mm_movehl_ps(t2, t0);
    r2 = _mm_movelh_ps(t1, t3);
    r3 = _mm_movehl_ps(t3, t1);
}

[[gnu::always_inline]] inline void load_quads(const float* rows, std::int64_t stride,
                                              const std::int32_t* index, Lanes (&out)[4])
{
    __m128 r0 = _mm_loadu_ps(rows + stride * index[0]), r1 = _mm_loadu_ps(rows + stride * index[1]);
    __m128 r2 = _mm_loadu_ps(rows + stride * index[2]), r3 = _mm_loadu_ps(rows + stride * index[3]);
    turn(r0, r1, r2, r3);
    out[0].v = r0;
    out[1].v = r1;
    out[2].v = r2;
    out[3].v = r3;
}

/// Of four numbers in line, the last one four times.
[[gnu::always_inline]] inline Lanes last_of_each_quad(const Lanes& quad)
{
    return Lanes(_mm_shuffle_ps(quad.v, quad.v, 0xFF));
}

/// Stores the first `count` lanes of a bundle with padding. Runs at most once per colour.
[[gnu::noinline, gnu::cold]] inline void store_some_quads(float* rows, std::int64_t stride,
                                                          const std::int32_t* index, const __m128* turned,
                                                          int count)
{
    for (int lane = 0; lane < count; ++lane) _mm_storeu_ps(rows + stride * index[lane], turned[lane]);
}

[[gnu::always_inline]] inline void store_quads(float* rows, std::int64_t stride, const std::int32_t* index,
                                               const Lanes (&in)[4], int count)
{
    __m128 r0 = in[0].v, r1 = in[1].v, r2 = in[2].v, r3 = in[3].v;
    turn(r0, r1, r2, r3);
    if (count < 4) [[unlikely]] {
        const __m128 turned[4] = {r0, r1, r2, r3};
        store_some_quads(rows, stride, index, turned, count);
        return;
    }
    _mm_storeu_ps(rows + stride * index[0], r0);
    _mm_storeu_ps(rows + stride * index[1], r1);
    _mm_storeu_ps(rows + stride * index[2], r2);
    _mm_storeu_ps(rows + stride * index[3], r3);
}
