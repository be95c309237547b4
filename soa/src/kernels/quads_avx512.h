// Loads and stores quads in sixteen lanes: four 4 x 4 transposes side by side; see quads_avx.h for the insertions.
#pragma once

[[gnu::always_inline]] inline void turn(__m512& r0, __m512& r1, __m512& r2, __m512& r3)
{
    const __m512 t0 = _mm512_unpacklo_ps(r0, r1), t1 = _mm512_unpackhi_ps(r0, r1);
    const __m512 t2 = _mm512_unpacklo_ps(r2, r3), t3 = _mm512_unpackhi_ps(r2, r3);
    r0 = _mm512_shuffle_ps(t0, t2, 0x44);
    r1 = _mm512_shuffle_ps(t0, t2, 0xEE);
    r2 = _mm512_shuffle_ps(t1, t3, 0x44);
    r3 = _mm512_shuffle_ps(t1, t3, 0xEE);
}

[[gnu::always_inline]] inline __m512 load_four(const float* rows, std::int64_t stride,
                                               const std::int32_t* index)
{
    __m512 r = _mm512_castps128_ps512(_mm_loadu_ps(rows + stride * index[0]));
    r = _mm512_insertf32x4(r, _mm_loadu_ps(rows + stride * index[4]), 1);
    r = _mm512_insertf32x4(r, _mm_loadu_ps(rows + stride * index[8]), 2);
    return _mm512_insertf32x4(r, _mm_loadu_ps(rows + stride * index[12]), 3);
}

[[gnu::always_inline]] inline void load_quads(const float* rows, std::int64_t stride,
                                              const std::int32_t* index, Lanes (&out)[4])
{
    __m512 r0 = load_four(rows, stride, index), r1 = load_four(rows, stride, index + 1);
    __m512 r2 = load_four(rows, stride, index + 2), r3 = load_four(rows, stride, index + 3);
    turn(r0, r1, r2, r3);
    out[0].v = r0;
    out[1].v = r1;
    out[2].v = r2;
    out[3].v = r3;
}

/// Of every four numbers in line, the last one four times.
[[gnu::always_inline]] inline Lanes last_of_each_quad(const Lanes& quads)
{
    return Lanes(_mm512_permute_ps(quads.v, 0xFF));
}

/// Stores the first `count` lanes of a bundle with padding. Runs at most once per colour.
[[gnu::noinline, gnu::cold]] inline void store_some_quads(float* rows, std::int64_t stride,
                                                          const std::int32_t* index, const __m512* turned,
                                                          int count)
{
    alignas(64) float row[16];
    for (int lane = 0; lane < count; ++lane) {
        _mm512_store_ps(row, turned[lane % 4]);
        _mm_storeu_ps(rows + stride * index[lane], _mm_load_ps(row + lane / 4 * 4));
    }
}

[[gnu::always_inline]] inline void store_quads(float* rows, std::int64_t stride, const std::int32_t* index,
                                               const Lanes (&in)[4], int count)
{
    __m512 r0 = in[0].v, r1 = in[1].v, r2 = in[2].v, r3 = in[3].v;
    turn(r0, r1, r2, r3);
    if (count < 16) [[unlikely]] {
        const __m512 turned[4] = {r0, r1, r2, r3};
        store_some_quads(rows, stride, index, turned, count);
        return;
    }
    const auto store_four = [&](int lane, const __m512& r) {
        _mm_storeu_ps(rows + stride * index[lane], _mm512_castps512_ps128(r));
        _mm_storeu_ps(rows + stride * index[lane + 4], _mm512_extractf32x4_ps(r, 1));
        _mm_storeu_ps(rows + stride * index[lane + 8], _mm512_extractf32x4_ps(r, 2));
        _mm_storeu_ps(rows + stride * index[lane + 12], _mm512_extractf32x4_ps(r, 3));
    };
    store_four(0, r0);
    store_four(1, r1);
    store_four(2, r2);
    store_four(3, r3);
}
