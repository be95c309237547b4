// Handles: a slot, and the generation that the slot had when the handle was given out. A default handle is null.
//
// A handle is of one scene, and refused by others as one of something removed: scenes begin their generations far apart. Of a
// thousand scenes that a process has made, none takes the handle of another one for its own before a slot has been reused 970,000
// times. Copies of a scene, and scenes that are read from its bytes, know its handles; what is added to one of them afterwards
// has handles that may name something else in the others.
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
