// Puts contacts into blocks of sixteen lanes that share no moving body, first fit: into the first open block that has
// neither of the two bodies. At most 32 blocks are open at a time, so that contacts stay near their neighbours.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "stores/array.h"
#include "stores/disc_store.h"

namespace motley {

/// What a filler calls a planar body: its row, or its place in the order of the strips, less the first place of a band.
struct BodyNumbers {
    const std::uint32_t* places = nullptr;  ///< by row; null: the rows themselves
    std::uint32_t first = 0;
    [[nodiscard]] std::uint32_t of(std::uint32_t row) const
    {
        return places == nullptr ? row : places[row] - first;
    }
};

class BlockFiller {
  public:
    /// Starts over with blocks whose rows and impulses have so many floats a lane. Bodies are numbered from 0 to
    /// `bodies` - 1.
    void begin(DiscBlocks& blocks, int row_floats, int impulse_floats, std::size_t bodies);
    /// Goes on with the blocks that there are, of two planar bodies each, or of a wall and one: opens those of the last ones
    /// again that have lanes left.
    void go_on(DiscBlocks& blocks, int row_floats, int impulse_floats, std::size_t bodies,
               const BodyNumbers& numbers, bool are_walls);
    /// How many bodies there may be before a list grows.
    [[nodiscard]] std::size_t most_bodies() const { return masks_.size(); }
    void make_room_for(std::size_t bodies)
    {
        if (masks_.size() < bodies) masks_.resize(bodies, 0);
    }
    /// Makes room for so many blocks.
    static void make_room(DiscBlocks& blocks, std::size_t row_floats, std::size_t impulse_floats,
                          std::size_t room);
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
    Array<std::uint32_t> masks_;  ///< by body: in which open blocks it is
    std::array<Open, most_open> opened_;
    std::uint32_t open_ = 0;  ///< a bit for each open block

    void take_over(DiscBlocks& blocks, int row_floats, int impulse_floats, std::size_t bodies);
    [[nodiscard]] std::uint32_t mask_of(std::uint32_t body) const
    {
        return body == no_body ? 0 : masks_[body];
    }
    void close(int number);
    int open_one();
    /// A block of padding lanes: of null bodies, and with zeros for rows and impulses.
    std::size_t add_block();
};

}  // namespace motley
