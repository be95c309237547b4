// Loads and stores quads in four lanes with NEON; see quads_sse.h.
#pragma once

[[gnu::always_inline]] inline void turn(float32x4_t& r0, float32x4_t& r1, float32x4_t& r2, float32x4_t& r3)
{
    const float32x4x2_t even = vtrnq_f32(r0, r1), odd = vtrnq_f32(r2, r3);
    r0 = vcombine_f32(vget_low_f32(even.val[0]), vget_low_f32(odd.val[0]));
    r1 = vcombine_f32(vget_low_f32(even.val[1]), vget_low_f32(odd.val[1]));
    r2 = vcombine_f32(vget_high_f32(even.val[0]), vget_high_f32(odd.val[0]));
    r3 = vcombine_f32(vget_high_f32(even.val[1]), vget_high_f32(odd.val[1]));
}

[[gnu::always_inline]] inline void load_quads(const float* rows, std::int64_t stride,
                                              const std::int32_t* index, Lanes (&out)[4])
{
    float32x4_t r0 = vld1q_f32(rows + stride * index[0]), r1 = vld1q_f32(rows + stride * index[1]);
    float32x4_t r2 = vld1q_f32(rows + stride * index[2]), r3 = vld1q_f32(rows + stride * index[3]);
    turn(r0, r1, r2, r3);
    out[0].v = r0;
    out[1].v = r1;
    out[2].v = r2;
    out[3].v = r3;
}

/// Of four numbers in line, the last one four times.
[[gnu::always_inline]] inline Lanes last_of_each_quad(const Lanes& quad)
{
    return Lanes(vdupq_laneq_f32(quad.v, 3));
}

/// Stores the first `count` lanes of a bundle with padding. Runs at most once per colour.
[[gnu::noinline, gnu::cold]] inline void store_some_quads(float* rows, std::int64_t stride,
                                                          const std::int32_t* index,
                                                          const float32x4_t* turned, int count)
{
    for (int lane = 0; lane < count; ++lane) vst1q_f32(rows + stride * index[lane], turned[lane]);
}

[[gnu::always_inline]] inline void store_quads(float* rows, std::int64_t stride, const std::int32_t* index,
                                               const Lanes (&in)[4], int count)
{
    float32x4_t r0 = in[0].v, r1 = in[1].v, r2 = in[2].v, r3 = in[3].v;
    turn(r0, r1, r2, r3);
    if (count < 4) [[unlikely]] {
        const float32x4_t turned[4] = {r0, r1, r2, r3};
        store_some_quads(rows, stride, index, turned, count);
        return;
    }
    vst1q_f32(rows + stride * index[0], r0);
    vst1q_f32(rows + stride * index[1], r1);
    vst1q_f32(rows + stride * index[2], r2);
    vst1q_f32(rows + stride * index[3], r3);
}
