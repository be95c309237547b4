// Puts contacts into blocks of sixteen lanes that share no moving body, first fit: into the first open block that has
// neither of the two bodies. At most 32 blocks are open at a time, so that contacts stay near their neighbours.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <vector>

#include "stores/disc_store.h"
#include "stores/growth.h"

namespace motley {

class BlockFiller {
  public:
    /// Starts over with blocks whose rows and impulses have so many floats a lane. Bodies are numbered from 0 to
    /// `bodies` - 1.
    void begin(DiscBlocks& blocks, int row_floats, int impulse_floats, std::size_t bodies)
    {
        blocks.count = 0;
        take_over(blocks, row_floats, impulse_floats, bodies);
    }
    /// Goes on with the blocks that there are: opens those of the last ones again that have lanes left. `numbers_of`
    /// gives the numbers of the bodies, or no_body, in a lane of a block.
    template <class NumbersOf>
    void go_on(DiscBlocks& blocks, int row_floats, int impulse_floats, std::size_t bodies,
               const NumbersOf& numbers_of)
    {
        take_over(blocks, row_floats, impulse_floats, bodies);
        const auto count = static_cast<std::size_t>(blocks.count);
        for (std::size_t block = count - std::min(count, most_open); block < count; ++block) {
            if (blocks.lanes[block] == block_lanes) continue;
            const int number = std::countr_zero(~open_);
            Open& open = opened_[static_cast<std::size_t>(number)];
            open.block = block;
            open_ |= 1U << number;
            for (std::size_t lane = 0; lane < blocks.lanes[block]; ++lane) {
                open.bodies[lane] = numbers_of(block, lane);
                for (const std::uint32_t body : open.bodies[lane]) {
                    if (body != no_body) masks_[body] |= 1U << number;
                }
            }
        }
    }
    /// How many bodies there may be before a list grows.
    [[nodiscard]] std::size_t most_bodies() const { return masks_.size(); }
    void make_room_for(std::size_t bodies)
    {
        if (masks_.size() < bodies) masks_.resize(bodies, 0);
    }
    /// Makes room for so many blocks.
    static void make_room(DiscBlocks& blocks, std::size_t row_floats, std::size_t impulse_floats,
                          std::size_t room)
    {
        if (blocks.lanes.size() >= room) return;
        blocks.bodies.resize(room);
        blocks.rows.resize(room * row_floats * block_lanes);
        blocks.impulses.resize(room * impulse_floats * block_lanes);
        blocks.sums.resize(room * impulse_floats * block_lanes);
        blocks.lanes.resize(room);
    }
    /// A lane of a block.
    struct Place {
        std::size_t block;
        std::size_t lane;
    };
    static constexpr std::uint32_t no_body = UINT32_MAX;
    /// The lane for a contact of bodies a and b, which may be no_body where it cannot move.
    Place take(std::uint32_t a, std::uint32_t b)
    {
        const std::uint32_t taken = mask_of(a) | mask_of(b);
        const std::uint32_t fits = open_ & ~taken;
        const int number = fits != 0 ? std::countr_zero(fits) : open_one();
        Open& open = opened_[static_cast<std::size_t>(number)];
        const std::uint32_t bit = 1U << number;
        if (a != no_body) masks_[a] |= bit;
        if (b != no_body) masks_[b] |= bit;
        const std::size_t lane = blocks_->lanes[open.block]++;
        open.bodies[lane] = {a, b};
        const Place place{open.block, lane};
        if (lane + 1 == block_lanes) close(number);
        return place;
    }
    /// Closes all blocks.
    void finish()
    {
        while (open_ != 0) close(std::countr_zero(open_));
    }

  private:
    static constexpr std::size_t most_open = 32;
    struct Open {
        std::size_t block;
        std::array<std::array<std::uint32_t, 2>, block_lanes> bodies;
    };
    DiscBlocks* blocks_ = nullptr;
    std::size_t row_floats_ = 0, impulse_floats_ = 0;
    std::vector<std::uint32_t> masks_;  ///< by body: in which open blocks it is
    std::array<Open, most_open> opened_;
    std::uint32_t open_ = 0;  ///< a bit for each open block

    void take_over(DiscBlocks& blocks, int row_floats, int impulse_floats, std::size_t bodies)
    {
        blocks_ = &blocks;
        row_floats_ = static_cast<std::size_t>(row_floats);
        impulse_floats_ = static_cast<std::size_t>(impulse_floats);
        // Memory may have run out while blocks were open.
        if (open_ != 0) std::fill(masks_.begin(), masks_.end(), 0U);
        open_ = 0;
        if (masks_.size() < bodies) masks_.resize(with_room_to_grow(bodies), 0);
    }
    [[nodiscard]] std::uint32_t mask_of(std::uint32_t body) const
    {
        return body == no_body ? 0 : masks_[body];
    }
    void close(int number)
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
    int open_one()
    {
        if (open_ == UINT32_MAX) {
            int oldest = 0;
            for (int number = 1; number < 32; ++number) {
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
    /// A block of padding lanes: of null bodies, and with zeros for rows and impulses.
    std::size_t add_block()
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
};

}  // namespace motley
