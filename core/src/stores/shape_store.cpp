// See shape_store.h.
#include "stores/shape_store.h"

#include "stores/generations.h"
#include "stores/growth.h"

namespace motley {

void ShapeStore::make_room(std::size_t more_capsules, std::size_t more_half_spaces)
{
    make_room_for(capsules, more_capsules);
    make_room_for(half_spaces, more_half_spaces);
    make_room_for(slots, more_capsules + more_half_spaces);
    make_room_for(free_slots, 1);
}

std::uint32_t ShapeStore::take_slot(Kind kind, std::size_t index)
{
    if (free_slots.empty()) {
        slots.emplace_back().generation = slots[0].generation;
        free_slots.push_back(static_cast<std::uint32_t>(slots.size() - 1));
    }
    const std::uint32_t slot = free_slots.back();
    free_slots.pop_back();
    slots[slot].kind = kind;
    slots[slot].index = static_cast<std::uint32_t>(index);
    version.reset();
    return slot;
}

ShapeId ShapeStore::put(const Capsule& capsule)
{
    const std::uint32_t slot = take_slot(Kind::capsule, capsules.size());
    capsules.push_back(capsule);
    capsules.back().slot = slot;
    return {slot, slots[slot].generation};
}

ShapeId ShapeStore::put(const HalfSpace& half_space)
{
    const std::uint32_t slot = take_slot(Kind::half_space, half_spaces.size());
    half_spaces.push_back(half_space);
    half_spaces.back().slot = slot;
    return {slot, slots[slot].generation};
}

void ShapeStore::remove(std::uint32_t slot)
{
    Slot& freed = slots[slot];
    const auto take_out = [&](auto& list) {
        list[freed.index] = list.back();
        slots[list[freed.index].slot].index = freed.index;
        list.pop_back();
    };
    if (freed.kind == Kind::capsule) {
        take_out(capsules);
    } else {
        take_out(half_spaces);
    }
    freed.kind = Kind::none;
    freed.index = 0;
    freed.generation = next_generation(freed.generation);
    free_slots.push_back(slot);
    version.reset();
}

}  // namespace motley
