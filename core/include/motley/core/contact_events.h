// Which contacts of discs and capsules began to push in a step, and which stopped.
#pragma once

#include <span>

#include "motley/core/boxed.h"
#include "motley/core/scene.h"

#pragma GCC visibility push(default)
namespace motley {

struct [[gnu::visibility("hidden")]] ContactEventsCore;
extern template class __attribute__((visibility("default"))) Boxed<ContactEventsCore>;

/// Two bodies that push each other with their discs, capsules or half-spaces, or one and a wall.
struct ContactPair {
    BodyId a{};     ///< the body with the lower slot of two; null with a wall
    BodyId b{};     ///< the other body
    WallId wall{};  ///< null between two bodies
    friend bool operator==(const ContactPair&, const ContactPair&) = default;
};

/// Compares the contacts that pushed in the last step of a scene, which are those of Scene::disc_contacts() and of
/// Scene::shape_contacts() with a force, with those at the update before. Call update() after every step, with the same
/// scene or with copies that continue it. Bodies that touch in several points, or a body that meets several pieces of one
/// wall, are one pair.
///
/// A body or wall that is removed ends its pairs at the next update; ended() then names handles that are no longer
/// alive. Another body in the same slot has another handle, and begins pairs of its own. A teleport ends nothing by
/// itself: the next step decides. All lists are in the order of the slots of b within those of a, pairs of bodies first,
/// then pairs with walls in the order of the slots of b within those of walls. They do not depend on the instruction
/// set or the number of threads.
class ContactEvents {
  public:
    ContactEvents();
    /// Reads the contacts of the last step, as a const call does. A warm update allocates nothing. If memory runs out,
    /// nothing is changed.
    void update(const Scene& scene);
    /// Pairs that pushed in the last step and not at the update before. Valid until the next update.
    [[nodiscard]] std::span<const ContactPair> began() const;
    /// Pairs that pushed at the update before and not in the last step.
    [[nodiscard]] std::span<const ContactPair> ended() const;
    /// Number of pairs that pushed in the last step.
    [[nodiscard]] std::size_t pushing() const;
    /// Forgets all pairs, as if there had been no update.
    void clear();

  private:
    Boxed<ContactEventsCore> core_;
};

}  // namespace motley
#pragma GCC visibility pop
