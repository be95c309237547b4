#include "kernels/prefetch.h"

namespace motley {

namespace {

void prefetch_rows(const BodyArrays& arrays, const std::int32_t* offsets, bool with_delta)
{
    if (!arrays.can_move) return;
    for (int lane = 0; lane < block_lanes; ++lane) {
        const std::int64_t first = std::int64_t{offset_floats} * offsets[lane];
        __builtin_prefetch(arrays.velocity + first);
        if (with_delta) __builtin_prefetch(arrays.delta + first);
        if (arrays.kind == BodyKind::rigid) __builtin_prefetch(arrays.world_inverse_inertia + first);
    }
}

}  // namespace

void prefetch_bodies(const KernelContext& context, const BlockStreams& streams, std::int64_t block,
                     bool with_delta)
{
    const BlockBodies& bodies = streams.bodies[block];
    prefetch_rows(context.bodies[static_cast<int>(streams.kind_a)], bodies.a, with_delta);
    prefetch_rows(context.bodies[static_cast<int>(streams.kind_b)], bodies.b, with_delta);
}

}  // namespace motley
