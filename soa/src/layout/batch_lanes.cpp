// Single lanes of blocks: of constraints that come after the blocks were filled, and of those that go.
#include <algorithm>

#include "layout/batches.h"

namespace motley {

void BatchSet::set_constraint(const Lane& lane, std::int32_t constraint)
{
    Pool& pool = pools_[pool_of(lane.constraint_class)];
    const auto block = static_cast<std::size_t>(lane.block);
    BlockConstraints& who = pool.who[block];
    who.lane[lane.lane] = constraint;
    // Padding has the parameters of the first lane.
    if (lane.lane == 0) std::fill(who.lane + pool.counts[block], who.lane + block_lanes, constraint);
}

Placement BatchSet::placement_in(const Lane& lane) const
{
    const Pool& pool = pools_[pool_of(lane.constraint_class)];
    const auto block = static_cast<std::size_t>(lane.block);
    const BlockBodies& bodies = pool.bodies[block];
    return {row_at(kind_a_of(lane.constraint_class), bodies.a[lane.lane]),
            row_at(kind_b_of(lane.constraint_class), bodies.b[lane.lane]), pool.who[block].lane[lane.lane],
            static_cast<std::uint8_t>(type_of(lane.constraint_class)), lane.colour};
}

std::optional<BatchSet::Lane> BatchSet::take_free_lane(int constraint_class, std::uint8_t colour)
{
    // Classes without constraints have no blocks.
    if (occurs_[pool_of(constraint_class)] == 0) return std::nullopt;
    const Lane lane = end_of(constraint_class, colour);
    Pool& pool = pools_[pool_of(lane.constraint_class)];
    if (lane.block >= pool.first_block[colour + 1U]) return std::nullopt;
    ++pool.constraints[colour];
    return lane;
}

BatchSet::Lane BatchSet::give_last_back(int constraint_class, std::uint8_t colour)
{
    --pools_[pool_of(constraint_class)].constraints[colour];
    return end_of(constraint_class, colour);
}

BatchSet::Lane BatchSet::end_of(int constraint_class, std::uint8_t colour) const
{
    const Pool& pool = pools_[pool_of(constraint_class)];
    const std::int32_t count = pool.constraints[colour];
    return {constraint_class, pool.first_block[colour] + count / block_lanes,
            static_cast<std::uint8_t>(count % block_lanes), colour};
}

void BatchSet::put(const Lane& lane, const Placement& placement)
{
    Pool& pool = pools_[pool_of(lane.constraint_class)];
    const auto block = static_cast<std::size_t>(lane.block);
    pool.set_lane(block, lane.lane, placement);
    pool.pad(block, std::max<int>(pool.counts[block], lane.lane + 1), pool.who[block].lane[0]);
}

void BatchSet::end_block_at(const Lane& lane)
{
    Pool& pool = pools_[pool_of(lane.constraint_class)];
    const auto block = static_cast<std::size_t>(lane.block);
    pool.pad(block, lane.lane, pool.who[block].lane[0]);
    if (lane.lane == 0) pool.skipped[block] = skip_altogether;
}

}  // namespace motley
