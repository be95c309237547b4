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

constexpr std::int64_t cache_line_floats = 16;

/// Prefetches `entry` of a table whose entries have `stride` floats.
template <bool to_write>
void prefetch_entry(const float* table, std::int64_t stride, std::int32_t entry)
{
    const float* const first = table + stride * entry;
    for (std::int64_t i = 0; i < stride; i += cache_line_floats) __builtin_prefetch(first + i, to_write);
    __builtin_prefetch(first + stride - 1, to_write);
}

}  // namespace

void prefetch_bodies(const KernelContext& context, const BlockStreams& streams, std::int64_t block,
                     bool with_delta)
{
    const BlockBodies& bodies = streams.bodies[block];
    prefetch_rows(context.bodies[static_cast<int>(streams.kind_a)], bodies.a, with_delta);
    prefetch_rows(context.bodies[static_cast<int>(streams.kind_b)], bodies.b, with_delta);
}

void prefetch_constraints(ConstraintKernels::Transfer ConstraintKernels::*kernel, const BlockStreams& streams,
                          const ConstraintData& data, std::int64_t block)
{
    const bool prepares = kernel == &ConstraintKernels::prepare;
    for (int lane = 0; lane < streams.counts[block]; ++lane) {
        const std::int32_t constraint = streams.constraints[block].lane[lane];
        if (prepares) {
            prefetch_entry<false>(data.parameters, data.parameter_stride, constraint);
            // The memory of a contact is where its index says, which is not read for this.
            if (data.memory_index == nullptr)
                prefetch_entry<false>(data.memory_in, data.memory_stride, constraint);
        } else {
            prefetch_entry<true>(data.memory_out, data.memory_stride, constraint);
            prefetch_entry<true>(data.step_out, data.step_stride, constraint);
        }
    }
}

}  // namespace motley
