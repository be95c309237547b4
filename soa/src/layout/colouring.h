// Greedy colouring: constraints of one colour share no moving body, so they may be solved in any order, in lanes and
// on threads. A body's mask has a bit for each colour that touches it; a constraint takes the first colour that is
// free on both bodies. First fit stays within a few colours of the best for crowds, and a constraint that persists
// keeps its colour. Static and kinematic bodies have no mask: no constraint writes them, so sharing is safe.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <vector>

#include "layout/block.h"
#include "stores/body_store.h"
#include "stores/contact_cache.h"

namespace motley {

/// The colour of constraints that are in no block: bad contacts, and constraints on a contained body (one whose state
/// was not finite), which no impulse may change.
inline constexpr std::uint8_t left_out_colour = 254;

/// Which colours touch each moving body.
class ColourMasks {
  public:
    /// As many masks as the store has rows, all clear.
    void reset(const BodyStore& bodies)
    {
        for (int kind = 0; kind < moving_kinds; ++kind) {
            masks_[kind].assign(bodies.rows(static_cast<BodyKind>(kind)).size(), 0U);
        }
    }
    /// Appends clear masks for rows that were added to the store.
    void grow(const BodyStore& bodies)
    {
        for (int kind = 0; kind < moving_kinds; ++kind) {
            const std::size_t rows = bodies.rows(static_cast<BodyKind>(kind)).size();
            if (masks_[kind].size() < rows) masks_[kind].resize(rows, 0U);
        }
    }
    /// Takes the colour and returns true if neither body has it yet. The overflow colour is always free; its bit only says
    /// that a body has constraints.
    bool try_take(BodyRow a, BodyRow b, std::uint8_t colour)
    {
        const std::uint32_t bit = 1U << colour;
        std::uint32_t* mask_a = mask(a);
        std::uint32_t* mask_b = mask(b);
        if (colour != overflow_colour && (used(mask_a, mask_b) & bit)) return false;
        note(bit, mask_a, mask_b);
        return true;
    }
    /// Takes and returns the first colour free on both bodies; overflow_colour when there is none.
    std::uint8_t take_first(BodyRow a, BodyRow b)
    {
        std::uint32_t* mask_a = mask(a);
        std::uint32_t* mask_b = mask(b);
        const int colour = std::min(std::countr_one(used(mask_a, mask_b)), parallel_colours);
        note(1U << colour, mask_a, mask_b);
        return static_cast<std::uint8_t>(colour);
    }
    void set(BodyRow moving, std::uint32_t colours) { *mask(moving) = colours; }
    void note_start_rows(BodyRow a, BodyRow b) { note(start_rows_bit, mask(a), mask(b)); }
    /// A mask a row: 0 where no constraint acts.
    [[nodiscard]] const std::uint32_t* of(BodyKind kind) const
    {
        return masks_[static_cast<std::size_t>(kind)].data();
    }

  private:
    static constexpr int moving_kinds = 3;
    std::uint32_t* mask(BodyRow body)
    {
        return body.kind() == BodyKind::fixed ? nullptr
                                              : &masks_[static_cast<std::size_t>(body.kind())][body.row()];
    }
    static std::uint32_t used(const std::uint32_t* mask_a, const std::uint32_t* mask_b)
    {
        return (mask_a ? *mask_a : 0U) | (mask_b ? *mask_b : 0U);
    }
    static void note(std::uint32_t bit, std::uint32_t* mask_a, std::uint32_t* mask_b)
    {
        if (mask_a) *mask_a |= bit;
        if (mask_b) *mask_b |= bit;
    }
    std::array<AlignedVector<std::uint32_t>, moving_kinds> masks_;
};

}  // namespace motley
