// Cuts blocks into chunks of work for sweeps, and into tiles for what moves data into them and out of them.
#include <algorithm>

#include "layout/batches.h"
#include "stores/growth.h"

namespace motley {
namespace {

/// Blocks per chunk: one or two microseconds of work, ten times what claiming it costs.
constexpr std::int32_t blocks_per_chunk = 16;
/// Blocks of each class and colour in a tile: the contacts of a tile then fit a first or second level cache.
constexpr std::int32_t blocks_per_tile = 8;

}  // namespace

void BlockMarks::make_room(std::size_t blocks)
{
    grow_to(residuals, blocks * residuals_a_block);
    grow_to(finished, blocks);
    grow_to(islands, blocks);
    grow_to(wanted, blocks);
}

void BlockMarks::mark(SweepChunk& chunk, std::size_t first_block)
{
    chunk.streams.residuals = residuals.data() + first_block * residuals_a_block;
    chunk.finished = finished.data() + first_block;
    chunk.islands = islands.data() + first_block;
    chunk.wanted = wanted.data() + first_block;
}

BatchSet::Block BatchSet::block(int constraint_class, int colour, std::int32_t nth)
{
    const std::size_t p = pool_of(constraint_class);
    Pool& pool = pools_[p];
    const std::int32_t index = pool.first_block[static_cast<std::size_t>(colour)] + nth;
    return {streams(p), index, &pool.skipped[static_cast<std::size_t>(index)]};
}

BlockStreams BatchSet::streams(std::size_t p)
{
    Pool& pool = pools_[p];
    const int constraint_class = first_class_ + static_cast<int>(p);
    return {kind_a_of(constraint_class),
            kind_b_of(constraint_class),
            pool.bodies.data(),
            pool.counts.data(),
            pool.who.data(),
            pool.rows.data(),
            pool.substep_rows.data(),
            pool.impulses.data(),
            adds_up_ ? pool.sums.data() : nullptr};
}

SweepChunk BatchSet::sweep_chunk(const KernelTable& table, std::size_t p, std::int32_t begin,
                                 std::int32_t end, bool tells_apart)
{
    Pool& pool = pools_[p];
    const int constraint_class = first_class_ + static_cast<int>(p);
    SweepChunk chunk{&table.constraints[constraint_class],
                     streams(p),
                     begin,
                     end,
                     type_of(constraint_class),
                     kind_a_of(constraint_class),
                     kind_b_of(constraint_class)};
    if (tells_apart) pool.marks.mark(chunk, 0);
    return chunk;
}

TransferTile::Part BatchSet::transfer_part(const KernelTable& table, std::size_t p, std::int32_t begin,
                                           std::int32_t end)
{
    const int constraint_class = first_class_ + static_cast<int>(p);
    return {&table.constraints[constraint_class], streams(p), type_of(constraint_class), begin, end};
}

void BatchSet::cut(const KernelTable& table, bool tells_apart, SweepLists& sweeps, TransferList& transfers)
{
    std::int32_t tiles = 1;
    for (const std::size_t p : used_) {
        Pool& pool = pools_[p];
        if (tells_apart) pool.marks.make_room(static_cast<std::size_t>(pool.all_blocks));
        for (std::size_t colour = 0; colour < colours; ++colour) {
            const std::int32_t end = pool.first_block[colour + 1];
            tiles = std::max(tiles, (end - pool.first_block[colour]) / blocks_per_tile);
            for_each_run(
                pool.first_block[colour], end,
                [&](std::int32_t block) { return pool.skips(block) == skip_nothing; },
                [&](std::int32_t first, std::int32_t last) {
                    for_each_even_piece<1>(first, last, blocks_per_chunk,
                                           [&](std::int32_t from, std::int32_t to) {
                                               sweeps.add(static_cast<int>(colour),
                                                          sweep_chunk(table, p, from, to, tells_apart));
                                           });
                });
        }
    }
    for (std::int32_t tile = 0; tile < tiles; ++tile) {
        const auto first_part = static_cast<std::int32_t>(transfers.parts.size());
        for (const std::size_t p : used_) {
            Pool& pool = pools_[p];
            for (std::size_t colour = 0; colour < colours; ++colour) {
                const std::int32_t first = pool.first_block[colour];
                const std::int64_t blocks = pool.first_block[colour + 1] - first;
                if (blocks == 0) continue;
                for_each_run(
                    first + static_cast<std::int32_t>(blocks * tile / tiles),
                    first + static_cast<std::int32_t>(blocks * (tile + 1) / tiles),
                    [&](std::int32_t block) { return pool.skips(block) != skip_altogether; },
                    [&](std::int32_t begin, std::int32_t end) {
                        transfers.parts.push_back(transfer_part(table, p, begin, end));
                    });
            }
        }
        transfers.close_tile(first_part);
    }
    if (has_patches_) cut_patches(table, tells_apart, sweeps, transfers);
}

/// No block of a patch is skipped: only joints are in blocks that figures may solve, and patches hold contacts.
void BatchSet::cut_patches(const KernelTable& table, bool tells_apart, SweepLists& sweeps,
                           TransferList& transfers)
{
    for (std::int64_t chunk = 0; chunk < chunk_count(); ++chunk) {
        const std::span<std::int32_t> first = of_chunk(patch_blocks_, chunk);
        const std::int32_t first_chunk = sweeps.patch_chunks();
        for (int colour = 0; colour < parallel_colours; ++colour) {
            for (const std::size_t p : used_) {
                const std::size_t key = p * colours + static_cast<std::size_t>(colour);
                if (first[key] == first[key + 1]) continue;
                sweeps.add_to_patch(colour, sweep_chunk(table, p, first[key], first[key + 1], tells_apart));
            }
        }
        sweeps.close_patch(first_chunk);
        const auto first_part = static_cast<std::int32_t>(transfers.parts.size());
        for (const std::size_t p : used_) {
            const std::int32_t begin = first[p * colours], end = first[p * colours + parallel_colours];
            if (begin < end) transfers.parts.push_back(transfer_part(table, p, begin, end));
        }
        transfers.close_tile(first_part);
    }
}

BatchSet::Count BatchSet::count(const KernelTable& table) const
{
    Count total;
    for (const std::size_t p : used_) {
        const Pool& pool = pools_[p];
        std::int64_t constraints = 0, blocks = 0;
        for (std::int32_t block = 0; block < pool.all_blocks; ++block) {
            constraints += pool.counts[static_cast<std::size_t>(block)];
            blocks += pool.counts[static_cast<std::size_t>(block)] > 0 ? 1 : 0;
        }
        total.add_blocks(table.constraints[static_cast<std::size_t>(first_class_) + p], blocks, constraints);
        total.overflow += pool.overflow;
    }
    return total;
}

}  // namespace motley
