// What a sweeper does with patches, one after another, each in a core's cache: see visit_patches_once().
#include "sweeper.h"

namespace motley {
namespace {

/// Prefetches the streams that sweeps of a patch read, block by block, in their order.
class StreamsAhead {
  public:
    explicit StreamsAhead(std::span<const SweepChunk> chunks) : chunks_(chunks) {}
    void ask_for(std::int32_t blocks)
    {
        for (; blocks > 0 && !chunks_.empty(); --blocks) {
            const SweepChunk& chunk = chunks_.front();
            const std::int32_t block = chunk.begin + asked_;
            ask(chunk.streams.bodies, block, 1);
            ask(chunk.streams.rows, block, block_lanes * chunk.kernels->row_floats);
            ask(chunk.streams.impulses, block, block_lanes * chunk.kernels->impulse_floats);
            if (block + 1 < chunk.end) {
                ++asked_;
            } else {
                chunks_ = chunks_.subspan(1);
                asked_ = 0;
            }
        }
    }

  private:
    std::span<const SweepChunk> chunks_;  ///< those not prefetched yet
    std::int32_t asked_ = 0;              ///< blocks of the first of them that are prefetched

    template <class T>
    static void ask(const T* stream, std::int64_t block, std::int64_t a_block)
    {
        constexpr int second_level = 2;
        const char* const first = reinterpret_cast<const char*>(stream + block * a_block);
        for (std::int64_t byte = 0; byte < a_block * static_cast<std::int64_t>(sizeof(T)); byte += 64)
            __builtin_prefetch(first + byte, 0, second_level);
    }
};

}  // namespace

void Sweeper::move_patch(const KernelContext& context, std::int64_t patch)
{
    for (int kind = 0; kind < body_kind_count; ++kind) {
        const auto move = layout_.kernels().bodies[kind].integrate_listed;
        if (move == nullptr) continue;
        const std::span<const BodyRow> bodies =
            layout_.intake.patches.bodies_of(static_cast<std::size_t>(patch), static_cast<BodyKind>(kind));
        move(context, bodies.data(), static_cast<std::int32_t>(bodies.size()));
    }
}

/// Relaxing leaves the memory idle, so it prefetches the next patch, which this worker will most likely visit next.
void Sweeper::relax_patch(const KernelContext& context, std::int64_t patch)
{
    constexpr std::int32_t blocks_at_a_time = 8;
    const SweepLists& sweeps = layout_.sweeps();
    const bool is_last = patch + 1 == static_cast<std::int64_t>(sweeps.patches.size());
    StreamsAhead ahead(is_last ? std::span<const SweepChunk>() : sweeps.of_patch(patch + 1));
    for (const SweepChunk& chunk : sweeps.of_patch(patch)) {
        for_each_piece(chunk.begin, chunk.end, blocks_at_a_time, [&](std::int32_t begin, std::int32_t end) {
            ahead.ask_for(end - begin);
            chunk.kernels->relax(context, chunk.streams, begin, end);
        });
    }
}

void Sweeper::visit_patches(std::span<const PlanStage> stages)
{
    const SweepLists& sweeps = layout_.sweeps();
    // The bodies were solved a moment ago and are in cache.
    KernelContext at_hand = layout_.context;
    at_hand.bodies_are_far = false;
    runner_.run(static_cast<std::int64_t>(sweeps.patches.size()), [&](std::int64_t patch) {
        for (const PlanStage& stage : stages) {
            switch (stage.operation) {
                case Operation::solve:
                    for (const SweepChunk& chunk : sweeps.of_patch(patch))
                        chunk.kernels->solve(layout_.context, chunk.streams, chunk.begin, chunk.end);
                    break;
                case Operation::integrate_positions:
                    move_patch(at_hand, patch);
                    break;
                case Operation::relax:
                    relax_patch(at_hand, patch);
                    break;
                default:
                    break;
            }
        }
    });
}

void Sweeper::list_beside_patches()
{
    for (int kind = 0; kind < body_kind_count; ++kind) {
        if (layout_.kernels().bodies[kind].integrate_listed == nullptr) continue;
        runner_.run(static_cast<std::int64_t>(layout_.rows(kind).size()),
                    [&](std::int64_t i) { layout_.list_beside_patches(static_cast<BodyKind>(kind), i); });
    }
}

void Sweeper::move_beside_patches()
{
    for (int kind = 0; kind < body_kind_count; ++kind) {
        const BodyKernels& kernels = layout_.kernels().bodies[kind];
        const auto& ranges = layout_.rows(kind);
        runner_.run(static_cast<std::int64_t>(ranges.size()), [&](std::int64_t i) {
            const RowRange& range = ranges[static_cast<std::size_t>(i)];
            if (kernels.integrate_listed == nullptr) {
                kernels.integrate_positions(layout_.context, range.begin, range.end);
                return;
            }
            const std::span<const BodyRow> beside = layout_.beside_patches(static_cast<BodyKind>(kind), i);
            kernels.integrate_listed(layout_.context, beside.data(),
                                     static_cast<std::int32_t>(beside.size()));
        });
    }
}

}  // namespace motley
