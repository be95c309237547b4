// Blocks opened, filled and cut into chunks.
#include "batches.h"

#include <algorithm>

namespace motley {
namespace {

/// Blocks a chunk: about two microseconds of work, twenty times what claiming it costs.
constexpr std::int32_t blocks_per_chunk = 32;
/// Overflow blocks that stay open to newcomers: enough to fill lanes from a few hubs, few enough to search.
constexpr std::size_t open_overflow_blocks = 8;

constexpr std::int32_t none = -1;

template <class T>
void grow(AlignedVector<T>& stream, std::size_t size)
{
    if (stream.size() < size) stream.resize(size + size / 2);
}

bool holds(const BlockIndex& block, BodyRow a, BodyRow b)
{
    const auto row_a = static_cast<std::int32_t>(a.row());
    const auto row_b = static_cast<std::int32_t>(b.row());
    const bool same_kind = a.kind() == b.kind();
    for (int lane = 0; lane < block.count; ++lane) {
        // Fixed bodies are shared freely; one kind may stand on either side.
        if (a.kind() != BodyKind::fixed && (block.a[lane] == row_a || (same_kind && block.b[lane] == row_a)))
            return true;
        if (b.kind() != BodyKind::fixed && (block.b[lane] == row_b || (same_kind && block.a[lane] == row_b)))
            return true;
    }
    return false;
}

}  // namespace

BlockPool::BlockPool()
{
    open_.fill(none);
}

void BlockPool::clear()
{
    block_count_ = 0;
    constraint_count_ = 0;
    for (auto& order : orders_) order.clear();
    open_.fill(none);
}

BlockIndex& BlockPool::open_block(std::uint8_t colour, std::int32_t constraint)
{
    if (static_cast<std::size_t>(block_count_) == index_.size()) grow(index_, index_.size() + 16);
    orders_[colour].push_back(block_count_);
    if (colour != overflow_colour) open_[colour] = block_count_;
    BlockIndex& block = index_[static_cast<std::size_t>(block_count_++)];
    std::fill_n(block.a, block_lanes, 0);
    std::fill_n(block.b, block_lanes, 0);
    // Padding reads the parameters of a real constraint, so that no lane ever computes with a zero normal.
    std::fill_n(block.constraint, block_lanes, constraint);
    block.count = 0;
    return block;
}

BlockIndex& BlockPool::open_overflow_block(BodyRow a, BodyRow b, std::int32_t constraint)
{
    const auto& order = orders_[overflow_colour];
    const std::size_t first = order.size() > open_overflow_blocks ? order.size() - open_overflow_blocks : 0;
    for (std::size_t i = first; i < order.size(); ++i) {
        BlockIndex& block = index_[static_cast<std::size_t>(order[i])];
        if (block.count < block_lanes && !holds(block, a, b)) return block;
    }
    return open_block(overflow_colour, constraint);
}

void BlockPool::place(BodyRow a, BodyRow b, std::int32_t constraint, std::uint8_t colour)
{
    BlockIndex& block = colour == overflow_colour ? open_overflow_block(a, b, constraint)
                        : open_[colour] != none   ? index_[static_cast<std::size_t>(open_[colour])]
                                                  : open_block(colour, constraint);
    block.a[block.count] = static_cast<std::int32_t>(a.row());
    block.b[block.count] = static_cast<std::int32_t>(b.row());
    block.constraint[block.count] = constraint;
    if (++block.count == block_lanes && colour != overflow_colour) open_[colour] = none;
    ++constraint_count_;
}

BlockStreams BlockPool::streams(const ConstraintKernels& kernels)
{
    const std::size_t lanes = static_cast<std::size_t>(block_count_) * block_lanes;
    grow(rows_, lanes * static_cast<std::size_t>(kernels.row_floats));
    grow(substep_rows_, lanes * static_cast<std::size_t>(kernels.substep_floats));
    grow(impulses_, lanes * static_cast<std::size_t>(kernels.impulse_floats));
    return {index_.data(), rows_.data(), substep_rows_.data(), impulses_.data()};
}

void BatchSet::clear()
{
    for (BlockPool& pool : pools_) pool.clear();
}

void BatchSet::cut(const KernelTable& table,
                   std::array<std::vector<SweepChunk>, parallel_colours + 1>& sweeps,
                   std::vector<TransferChunk>& transfers)
{
    for (int c = 0; c < class_count; ++c) {
        BlockPool& pool = pools_[static_cast<std::size_t>(c)];
        if (pool.block_count() == 0) continue;
        const ConstraintKernels& kernels = table.constraints[c];
        const BlockStreams streams = pool.streams(kernels);
        for (int colour = 0; colour <= parallel_colours; ++colour) {
            const auto& order = pool.order(colour);
            const auto size = static_cast<std::int32_t>(order.size());
            for (std::int32_t begin = 0; begin < size; begin += blocks_per_chunk) {
                sweeps[static_cast<std::size_t>(colour)].push_back(
                    {&kernels, streams, order.data(), begin, std::min(begin + blocks_per_chunk, size)});
            }
        }
        const int type = c / (body_kind_count * body_kind_count);
        for (std::int32_t begin = 0; begin < pool.block_count(); begin += blocks_per_chunk) {
            transfers.push_back(
                {&kernels, streams, type, begin, std::min(begin + blocks_per_chunk, pool.block_count())});
        }
    }
}

bool BatchSet::is_empty() const
{
    return std::all_of(pools_.begin(), pools_.end(),
                       [](const BlockPool& pool) { return pool.block_count() == 0; });
}

BatchSet::Count BatchSet::count(const KernelTable& table) const
{
    Count total;
    for (int c = 0; c < class_count; ++c) {
        const BlockPool& pool = pools_[static_cast<std::size_t>(c)];
        if (pool.block_count() == 0) continue;
        const ConstraintKernels& kernels = table.constraints[c];
        total.blocks += pool.block_count();
        total.constraints += pool.constraint_count();
        // Types that rebuild their row each substep sweep over that one; the others over the step's row.
        const int row = kernels.substep_floats > 0 ? kernels.substep_floats : kernels.row_floats;
        const double floats = row + kernels.impulse_floats + 2;  // two body indices
        total.streamed_bytes += 4.0 * floats * static_cast<double>(pool.constraint_count());
        for (const std::int32_t block : pool.order(overflow_colour)) total.overflow += pool.lanes_used(block);
    }
    return total;
}

}  // namespace motley
