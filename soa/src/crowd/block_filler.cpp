// See block_filler.h.
#include "crowd/block_filler.h"

#include <algorithm>
#include <cstring>

#include "stores/disc_fields.h"
#include "stores/growth.h"

namespace motley {

void BlockFiller::begin(DiscBlocks& blocks, int row_floats, int impulse_floats, std::size_t bodies)
{
    blocks.count = 0;
    take_over(blocks, row_floats, impulse_floats, bodies);
}

void BlockFiller::go_on(DiscBlocks& blocks, int row_floats, int impulse_floats, std::size_t bodies,
                        const BodyNumbers& numbers, bool are_walls)
{
    take_over(blocks, row_floats, impulse_floats, bodies);
    const auto count = static_cast<std::size_t>(blocks.count);
    const auto number_at = [&](std::int32_t offset) {
        return numbers.of(row_at(BodyKind::planar, offset).row());
    };
    for (std::size_t block = count - std::min(count, most_open); block < count; ++block) {
        if (blocks.lanes[block] == block_lanes) continue;
        const int number = std::countr_zero(~open_);
        Open& open = opened_[static_cast<std::size_t>(number)];
        open.block = block;
        open_ |= 1U << number;
        const BlockBodies& held = blocks.bodies[block];
        for (std::size_t lane = 0; lane < blocks.lanes[block]; ++lane) {
            open.bodies[lane] = {are_walls ? no_body : number_at(held.a[lane]), number_at(held.b[lane])};
            for (const std::uint32_t body : open.bodies[lane]) {
                if (body != no_body) masks_[body] |= 1U << number;
            }
        }
    }
}

void BlockFiller::take_over(DiscBlocks& blocks, int row_floats, int impulse_floats, std::size_t bodies)
{
    blocks_ = &blocks;
    row_floats_ = static_cast<std::size_t>(row_floats);
    impulse_floats_ = static_cast<std::size_t>(impulse_floats);
    // Memory may have run out while blocks were open.
    if (open_ != 0) std::fill(masks_.begin(), masks_.end(), 0U);
    open_ = 0;
    if (masks_.size() < bodies) masks_.resize(with_room_to_grow(bodies), 0);
}

void BlockFiller::make_room(DiscBlocks& blocks, std::size_t row_floats, std::size_t impulse_floats,
                            std::size_t room)
{
    if (blocks.lanes.size() >= room) return;
    blocks.bodies.resize(room);
    blocks.rows.resize(room * row_floats * block_lanes);
    blocks.impulses.resize(room * impulse_floats * block_lanes);
    blocks.sums.resize(room * impulse_floats * block_lanes);
    blocks.lanes.resize(room);
}

void BlockFiller::close(int number)
{
    const std::uint32_t bit = 1U << number;
    const Open& open = opened_[static_cast<std::size_t>(number)];
    for (std::size_t lane = 0; lane < blocks_->lanes[open.block]; ++lane) {
        for (const std::uint32_t body : open.bodies[lane]) {
            if (body != no_body) masks_[body] &= ~bit;
        }
    }
    open_ &= ~bit;
}

int BlockFiller::open_one()
{
    if (open_ == UINT32_MAX) {
        int oldest = 0;
        for (int number = 1; number < static_cast<int>(most_open); ++number) {
            if (opened_[static_cast<std::size_t>(number)].block <
                opened_[static_cast<std::size_t>(oldest)].block)
                oldest = number;
        }
        close(oldest);
    }
    const int number = std::countr_zero(~open_);
    opened_[static_cast<std::size_t>(number)].block = add_block();
    open_ |= 1U << number;
    return number;
}

std::size_t BlockFiller::add_block()
{
    const auto block = static_cast<std::size_t>(blocks_->count);
    const std::size_t rows = row_floats_ * block_lanes, impulses = impulse_floats_ * block_lanes;
    // More room, because a band that is searched for again has a few blocks more or less than before.
    if (blocks_->lanes.size() <= block)
        make_room(*blocks_, row_floats_, impulse_floats_, block + block / 2 + 8);
    ++blocks_->count;
    blocks_->bodies[block] = {};
    blocks_->lanes[block] = 0;
    std::memset(&blocks_->rows[block * rows], 0, rows * sizeof(float));
    std::memset(&blocks_->impulses[block * impulses], 0, impulses * sizeof(float));
    std::memset(&blocks_->sums[block * impulses], 0, impulses * sizeof(float));
    return block;
}

}  // namespace motley
