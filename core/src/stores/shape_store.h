// Capsules and half-spaces, as a scene keeps them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <span>

#include "motley/core/constraints/contact_definition.h"
#include "motley/core/shapes.h"
#include "stores/array.h"
#include "stores/disc_store.h"

namespace motley {

/// What all shapes have.
struct ShapeSurface {
    float friction = 0, restitution = 0;
    std::uint32_t category = 1, mask = UINT32_MAX;
};
struct Capsule {
    Vec3<float> from{}, to{};  ///< m, in the frame of the body
    float radius = 0;
    ShapeSurface surface;
    std::uint32_t group = 0;
    BodyId body{};
    std::uint32_t slot = 0;  ///< of its handle
};
struct HalfSpace {
    Vec3<double> point{};  ///< m, in the frame of the body
    Vec3<float> normal{};  ///< unit, likewise
    ShapeSurface surface;
    BodyId body{};
    std::uint32_t slot = 0;  ///< of its handle
};

// Files have them as they lie in memory, so that no byte may be undefined.
static_assert(sizeof(Capsule) == 60 && sizeof(HalfSpace) == 64);

struct ShapeStore {
    enum class Kind : std::uint8_t { none, capsule, half_space };
    struct Slot {
        std::uint32_t generation = 1;
        std::uint32_t index = 0;  ///< in the list of its kind
        Kind kind = Kind::none;
        std::uint8_t unused[3] = {0, 0, 0};  ///< so that files have no undefined bytes
    };
    /// Keys of contacts name shapes in so many bits.
    static constexpr std::uint32_t most_slots = std::uint32_t{1} << 28;

    Array<Slot> slots{1};  ///< the first is the null handle's: new ones get its generation
    Array<std::uint32_t> free_slots;
    Array<Capsule> capsules;  ///< without gaps: removal moves the last one into the gap
    Array<HalfSpace> half_spaces;
    /// The next group that a copy of a figure gets.
    std::uint32_t next_group = first_given_group;
    static constexpr std::uint32_t first_given_group = std::uint32_t{1} << 31;
    /// The contacts that were found in the last step. The contact cache has them behind those of the host's list.
    Array<Contact> contacts;
    Array<WallMet> walls_met;  ///< of each of them, the wall that it is with
    /// Token of this set of shapes, and of what else may meet them: null after a change, made by the next step, shared by
    /// copies of the scene.
    std::shared_ptr<const char> version;

    [[nodiscard]] bool is_in_use() const { return !capsules.empty(); }
    [[nodiscard]] bool is_alive(ShapeId shape) const
    {
        return shape.slot < slots.size() && slots[shape.slot].kind != Kind::none &&
               slots[shape.slot].generation == shape.generation;
    }
    /// Looks at all capsules.
    [[nodiscard]] bool has_capsule(BodyId body) const
    {
        return std::any_of(capsules.begin(), capsules.end(),
                           [body](const Capsule& capsule) { return capsule.body == body; });
    }
    /// Makes room for so many more, so that put() cannot fail.
    void make_room(std::size_t more_capsules, std::size_t more_half_spaces);
    ShapeId put(const Capsule& capsule);
    ShapeId put(const HalfSpace& half_space);
    /// Frees the slot of a live shape. There is room in free_slots.
    void remove(std::uint32_t slot);
    /// Removes all shapes on bodies that are_removed(body), likewise.
    template <class AreRemoved>
    void remove_if(const AreRemoved& are_removed)
    {
        remove_from(capsules, are_removed);
        remove_from(half_spaces, are_removed);
    }

  private:
    std::uint32_t take_slot(Kind kind, std::size_t index);
    template <class List, class AreRemoved>
    void remove_from(List& list, const AreRemoved& are_removed)
    {
        for (std::size_t i = list.size(); i > 0; --i) {
            if (are_removed(list[i - 1].body)) remove(list[i - 1].slot);
        }
    }
};

}  // namespace motley
