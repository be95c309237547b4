// Handles: a slot and the generation that slot had when it was handed out. A default handle is null.
//
// A handle does not know its scene: one of another scene names whoever has its slot and generation here, if anybody. To tell
// them apart would cost four bytes a handle, eight of the eighty of every contact; or a number of the scene among the bits of
// the generation, and then two scenes built alike, on one machine or on two, would no longer have the same handles.
#pragma once

#include <cstdint>

namespace motley {

/// Names a body of one scene. Stays valid until the body is removed; a stale one is refused, never reused.
struct BodyId {
    std::uint32_t slot = 0;
    std::uint32_t generation = 0;
    friend bool operator==(const BodyId&, const BodyId&) = default;
};

/// Names a joint of one scene, of whatever type.
struct ConstraintId {
    std::uint32_t slot = 0;
    std::uint32_t generation = 0;
    friend bool operator==(const ConstraintId&, const ConstraintId&) = default;
};

}  // namespace motley
