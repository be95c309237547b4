// Greedy colouring: constraints of one colour share no moving body, so they may be solved in any order, in lanes and
// on threads. A body's mask has a bit for each colour that touches it; a constraint takes the first colour that is
// free on both bodies. First fit stays within a few colours of the best for crowds, and a constraint that persists
// keeps its colour. Static and kinematic bodies have no mask: no constraint writes them, so sharing is safe.
#pragma once

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
    /// The masks of `other`, grown with clear ones to as many as the store has rows.
    void copy(const ColourMasks& other, const BodyStore& bodies)
    {
        for (int kind = 0; kind < moving_kinds; ++kind) {
            masks_[kind] = other.masks_[kind];
            masks_[kind].resize(bodies.rows(static_cast<BodyKind>(kind)).size(), 0U);
        }
    }
    /// Takes the colour and returns true if neither body has it yet. The overflow colour is always free.
    bool try_take(BodyRow a, BodyRow b, std::uint8_t colour)
    {
        if (colour == overflow_colour) {
            note_overflow(a, b);
            return true;
        }
        const std::uint32_t bit = 1U << colour;
        std::uint32_t* mask_a = mask(a);
        std::uint32_t* mask_b = mask(b);
        if (((mask_a ? *mask_a : 0U) | (mask_b ? *mask_b : 0U)) & bit) return false;
        if (mask_a) *mask_a |= bit;
        if (mask_b) *mask_b |= bit;
        return true;
    }
    /// Takes and returns the first colour free on both bodies; overflow_colour when there is none.
    std::uint8_t take_first(BodyRow a, BodyRow b)
    {
        std::uint32_t* mask_a = mask(a);
        std::uint32_t* mask_b = mask(b);
        const std::uint32_t used = (mask_a ? *mask_a : 0U) | (mask_b ? *mask_b : 0U);
        const int colour = std::countr_one(used);
        if (colour >= parallel_colours) {
            note_overflow(a, b);
            return overflow_colour;
        }
        if (mask_a) *mask_a |= 1U << colour;
        if (mask_b) *mask_b |= 1U << colour;
        return static_cast<std::uint8_t>(colour);
    }

    void note_contact(BodyRow a, BodyRow b) { note(contact_bit, a, b); }
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
    /// For bodies whose only constraints overflow.
    void note_overflow(BodyRow a, BodyRow b) { note(1U << overflow_colour, a, b); }
    void note(std::uint32_t bit, BodyRow a, BodyRow b)
    {
        for (std::uint32_t* of_body : {mask(a), mask(b)}) {
            if (of_body) *of_body |= bit;
        }
    }
    std::array<AlignedVector<std::uint32_t>, moving_kinds> masks_;
};

}  // namespace motley
