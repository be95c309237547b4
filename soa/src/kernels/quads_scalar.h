// Loads and stores quads in one lane. See quads_sse.h for what a quad is.
#pragma once

[[gnu::always_inline]] inline float load_lanes(const float* address)
{
    return *address;
}
[[gnu::always_inline]] inline void store_lanes(float lane, float* address)
{
    *address = lane;
}

[[gnu::always_inline]] inline void load_quads(const float* rows, std::int64_t stride,
                                              const std::int32_t* index, Lanes (&out)[4])
{
    const float* row = rows + stride * index[0];
    for (int i = 0; i < 4; ++i) out[i] = row[i];
}

[[gnu::always_inline]] inline void store_quads(float* rows, std::int64_t stride, const std::int32_t* index,
                                               const Lanes (&in)[4], int)
{
    float* row = rows + stride * index[0];
    for (int i = 0; i < 4; ++i) row[i] = in[i];
}
