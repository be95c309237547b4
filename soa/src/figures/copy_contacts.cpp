// A body has few contacts, so its slots are a short list.
#include "figures/copy_contacts.h"

#include <algorithm>
#include <utility>

#include "stores/growth.h"

namespace motley {

void CopyContacts::make_room(std::size_t contacts, std::size_t bodies)
{
    if (slots_.capacity() < contacts) slots_.reserve(with_room_to_grow(contacts));
    grow_to(last_slot_, bodies);
    grow_to(bodies_, contacts);
    grow_to(who_, contacts);
    grow_to(present_, contacts * block_lanes);
    grow_to(counts_, contacts);
    grow_to(fixed_offsets_, contacts * block_lanes);
}

void CopyContacts::sort(const FigureBlock& block, std::span<const std::uint32_t> contacts,
                        std::span<const Placement> placements, std::span<const std::int32_t> places)
{
    slots_.clear();
    fixed_count_ = 0;
    std::fill_n(last_slot_.begin(), block.shape->bodies.size(), none);
    for (const std::uint32_t i : contacts) {
        const Placement& contact = placements[i];
        const std::int32_t place = places[contact.a.row()];
        const std::int32_t lane = place % block_lanes;
        const std::size_t slot = at(slot_of(contact, place / block_lanes, block.count));
        bodies_[slot].a[lane] = offset_of(contact.a);
        bodies_[slot].b[lane] = offset_of(contact.b);
        who_[slot].lane[lane] = contact.constraint;
        present_[slot * block_lanes + static_cast<std::size_t>(lane)] = 1;
    }
    std::sort(slots_.begin(), slots_.end(), [](const Slot& x, const Slot& y) {
        return std::pair(x.colour, x.lanes) < std::pair(y.colour, y.lanes);
    });
    for (Slot& slot : slots_) share_fixed_body(slot);
    std::replace(fixed_offsets_.begin(), fixed_offsets_.begin() + std::ptrdiff_t{fixed_count_} * block_lanes,
                 none, 0);
}

/// The slot of a contact; a new one has only padding: the null bodies, and the parameters of the contact.
CopyContacts::Slot& CopyContacts::slot_of(const Placement& contact, int body, int copies)
{
    int& last = last_slot_[static_cast<std::size_t>(body)];
    for (int i = last; i != none; i = slots_[static_cast<std::size_t>(i)].next) {
        Slot& slot = slots_[static_cast<std::size_t>(i)];
        if (slot.colour == contact.colour && slot.type == contact.type) return slot;
    }
    const auto lanes = static_cast<int>(slots_.size());
    slots_.push_back({contact.type, contact.colour, body, none, lanes, std::exchange(last, lanes)});
    const std::size_t i = at(slots_.back());
    bodies_[i] = {};
    std::fill_n(who_[i].lane, block_lanes, contact.constraint);
    std::fill_n(present_.begin() + std::ptrdiff_t{lanes} * block_lanes, block_lanes, 0.0F);
    counts_[i] = static_cast<std::uint8_t>(copies);
    return slots_.back();
}

/// Gives a slot the first fixed bodies that are its own, or not yet anybody's, in every lane in which it has a contact.
void CopyContacts::share_fixed_body(Slot& slot)
{
    const std::int32_t* const wanted = bodies_[at(slot)].b;
    const float* const present = this->present(slot);
    const auto of_entry = [&](int entry) {
        return &fixed_offsets_[static_cast<std::size_t>(entry * block_lanes)];
    };
    const auto suits = [&](int entry) {
        const std::int32_t* const held = of_entry(entry);
        for (int lane = 0; lane < block_lanes; ++lane) {
            if (present[lane] > 0 && held[lane] != none && held[lane] != wanted[lane]) return false;
        }
        return true;
    };
    slot.fixed = 0;
    while (slot.fixed < fixed_count_ && !suits(slot.fixed)) ++slot.fixed;
    std::int32_t* const held = of_entry(slot.fixed);
    if (slot.fixed == fixed_count_) {
        std::fill_n(held, block_lanes, none);
        ++fixed_count_;
    }
    for (int lane = 0; lane < block_lanes; ++lane) {
        if (present[lane] > 0) held[lane] = wanted[lane];
    }
}

}  // namespace motley
