// Handles: a slot and the generation that slot had when it was handed out. A default handle is null.
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
