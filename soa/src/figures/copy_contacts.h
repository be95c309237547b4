// Sorts the contacts of a block of copies with bodies that cannot move into blocks of their own: each is of one type, one
// body of the figure and one colour, and has one copy per lane. The bodies that they touch are in lanes too: one for each
// copy, and as few of them as the contacts of a copy need.
#pragma once

#include <cstdint>
#include <span>

#include "figures/figure.h"
#include "layout/batches.h"
#include "stores/array.h"

namespace motley {

class CopyContacts {
  public:
    /// Makes room for as many contacts of a figure of as many bodies. Allocates only beyond the most so far.
    void make_room(std::size_t contacts, std::size_t bodies);
    /// Sorts the placements with these indices. `places` says where a rigid row is in its block of copies: its body
    /// times block_lanes, plus its lane.
    void sort(const FigureBlock& block, std::span<const std::uint32_t> contacts,
              std::span<const Placement> placements, std::span<const std::int32_t> places);

    /// A block of contacts.
    struct Slot {
        std::uint8_t type, colour;
        int body;   ///< of the figure: body a
        int fixed;  ///< body b: see fixed_offsets()
        int lanes;  ///< its index in the arrays below
        int next;   ///< another slot of the body, or none
    };
    /// By colour; valid until the next sort(), like all below.
    [[nodiscard]] std::span<const Slot> slots() const { return slots_; }
    [[nodiscard]] const BlockBodies* bodies(const Slot& slot) const { return &bodies_[at(slot)]; }
    [[nodiscard]] const BlockConstraints* constraints(const Slot& slot) const { return &who_[at(slot)]; }
    [[nodiscard]] const std::uint8_t* count(const Slot& slot) const { return &counts_[at(slot)]; }
    [[nodiscard]] const float* present(const Slot& slot) const { return &present_[at(slot) * block_lanes]; }
    /// The fixed bodies: offset_of, one per lane; the null row where a copy touches none of them.
    [[nodiscard]] const std::int32_t* fixed_offsets() const { return fixed_offsets_.data(); }
    [[nodiscard]] int fixed_count() const { return fixed_count_; }

  private:
    static constexpr int none = -1;
    Array<Slot> slots_;
    Array<int> last_slot_;  ///< by body of the figure
    AlignedVector<BlockBodies> bodies_;
    AlignedVector<BlockConstraints> who_;
    AlignedVector<float> present_;
    Array<std::uint8_t> counts_;
    AlignedVector<std::int32_t> fixed_offsets_;
    int fixed_count_ = 0;

    [[nodiscard]] static std::size_t at(const Slot& slot) { return static_cast<std::size_t>(slot.lanes); }
    Slot& slot_of(const Placement& contact, int body, int copies);
    void share_fixed_body(Slot& slot);
};

}  // namespace motley
