// Loads and stores quads in eight lanes: two 4 x 4 transposes side by side. The upper half of each register is
// loaded by an insertion from memory, which does not need the shuffle port that bounds these kernels.
#pragma once

[[gnu::always_inline]] inline void turn(__m256& r0, __m256& r1, __m256& r2, __m256& r3)
{
    const __m256 t0 = _mm256_unpacklo_ps(r0, r1), t1 = _mm256_unpackhi_ps(r0, r1);
    const __m256 t2 = _mm256_unpacklo_ps(r2, r3), t3 = _mm256_unpackhi_ps(r2, r3);
    r0 = _mm256_shuffle_ps(t0, t2, 0x44);
    r1 = _mm256_shuffle_ps(t0, t2, 0xEE);
    r2 = _mm256_shuffle_ps(t1, t3, 0x44);
    r3 = _mm256_shuffle_ps(t1, t3, 0xEE);
}

[[gnu::always_inline]] inline __m256 load_pair(const float* low, const float* high)
{
    return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(low)), _mm_loadu_ps(high), 1);
}

[[gnu::always_inline]] inline void load_quads(const float* rows, std::int64_t stride,
                                              const std::int32_t* index, Lanes (&out)[4])
{
    __m256 r0 = load_pair(rows + stride * index[0], rows + stride * index[4]);
    __m256 r1 = load_pair(rows + stride * index[1], rows + stride * index[5]);
    __m256 r2 = load_pair(rows + stride * index[2], rows + stride * index[6]);
    __m256 r3 = load_pair(rows + stride * index[3], rows + stride * index[7]);
    turn(r0, r1, r2, r3);
    out[0].v = r0;
    out[1].v = r1;
    out[2].v = r2;
    out[3].v = r3;
}

/// Of every four numbers in line, the last one four times.
[[gnu::always_inline]] inline Lanes last_of_each_quad(const Lanes& quads)
{
    return Lanes(_mm256_permute_ps(quads.v, 0xFF));
}

/// Stores the first `count` lanes of a bundle with padding: `turned` holds rows 0 to 3 and, in the upper halves, 4 to
/// 7. Runs at most once per colour.
[[gnu::noinline, gnu::cold]] inline void store_some_quads(float* rows, std::int64_t stride,
                                                          const std::int32_t* index, const __m256* turned,
                                                          int count)
{
    alignas(32) float row[8];
    for (int lane = 0; lane < count; ++lane) {
        _mm256_store_ps(row, turned[lane % 4]);
        _mm_storeu_ps(rows + stride * index[lane], _mm_load_ps(row + lane / 4 * 4));
    }
}

[[gnu::always_inline]] inline void store_quads(float* rows, std::int64_t stride, const std::int32_t* index,
                                               const Lanes (&in)[4], int count)
{
    __m256 r0 = in[0].v, r1 = in[1].v, r2 = in[2].v, r3 = in[3].v;
    turn(r0, r1, r2, r3);
    if (count < 8) [[unlikely]] {
        const __m256 turned[4] = {r0, r1, r2, r3};
        store_some_quads(rows, stride, index, turned, count);
        return;
    }
    const auto store_pair = [&](int lane, const __m256& r) {
        _mm_storeu_ps(rows + stride * index[lane], _mm256_castps256_ps128(r));
        _mm_storeu_ps(rows + stride * index[lane + 4], _mm256_extractf128_ps(r, 1));
    };
    store_pair(0, r0);
    store_pair(1, r1);
    store_pair(2, r2);
    store_pair(3, r3);
}
