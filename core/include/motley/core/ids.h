// Handles: a slot, and the generation that the slot had when the handle was given out. A default handle is null.
//
// A handle does not name its scene: used with another scene it names the body or joint that has its slot and generation
// there, if there is one. Detecting this was not worth its price: a scene number of four bytes in each handle would add
// eight to the eighty bytes of every contact, and one among the bits of the generation would give two scenes that are
// built alike different handles.
#pragma once

#include <cstdint>

#pragma GCC visibility push(default)
namespace motley {

/// Names a body of one scene. Valid until the body is removed; after that it is refused, and never names another body
/// until the slot has been reused 2^32 times.
struct BodyId {
    std::uint32_t slot = 0;
    std::uint32_t generation = 0;
    friend bool operator==(const BodyId&, const BodyId&) = default;
};

/// Names a joint of one scene, of any type; valid as a BodyId is.
struct ConstraintId {
    std::uint32_t slot = 0;
    std::uint32_t generation = 0;
    friend bool operator==(const ConstraintId&, const ConstraintId&) = default;
};

}  // namespace motley
#pragma GCC visibility pop
