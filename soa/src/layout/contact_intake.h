// Takes in the contacts of a step: each is checked, matched with the same contact of the last step, and classified.
#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <string>

#include "figures/figures.h"
#include "layout/batches.h"
#include "layout/patches.h"
#include "scene/scene_core.h"
#include "stores/array.h"

namespace motley {

/// What the layout needs of each contact, in list order.
class ContactIntake {
  public:
    /// Starts a list of `count` contacts.
    void begin(SceneCore& scene, std::size_t count);
    /// Checks a part of the list, and matches the contacts that are at about the same place as in the last list.
    void check_and_match(SceneCore& scene, std::span<const Contact> contacts, std::int64_t part);
    /// Looks up by key the contacts that check_and_match() did not match. Runs after ContactCache::enter_lost().
    void look_up(ContactCache& cache, std::int64_t part);
    /// What is wrong with the first bad contact; empty when there is none. Does not look for repeated keys.
    [[nodiscard]] std::string first_error(const SceneCore& scene, std::span<const Contact> contacts) const;

    /// After all contacts are coloured: marks those of a patch's stretch of the list that are inside the patch, and
    /// lists its bodies. Contacts of figures with bodies that cannot move are in no patch, because figures in lockstep
    /// solve them in the order of the colours.
    void fill_patch(std::int64_t patch, const Figures& figures);

    /// The number of contacts that failed the checks.
    [[nodiscard]] std::int64_t bad_contacts() const { return bad_contacts_.load(std::memory_order_relaxed); }
    /// The first contact of the list whose surface is in `surfaces`.
    [[nodiscard]] std::size_t first_surface() const { return count_ - surfaces.size(); }
    /// Whether one of the good contacts has restitution.
    [[nodiscard]] bool bounces() const { return bounces_.load(std::memory_order_relaxed); }
    /// Names the first contact whose key is repeated; empty when there is none. Runs on the calling thread.
    [[nodiscard]] static std::string repeated_key(std::span<const Contact> contacts);

    /// What the surfaces of the last contacts of the list do; those before them, or all, have the default. Set before
    /// begin().
    std::span<const ContactSurface<float>> surfaces;
    /// With the colour of the step before, or no_colour. Body a is of the kind that comes first in BodyKind.
    AlignedVector<Placement> placements;
    /// 1 where body a of the placement is body b of the host, and the other way round, else 0.
    Array<std::uint8_t> exchanged;
    Patches patches;
    Array<std::int32_t> memory_index;  ///< entry in the last list's impulses; 0, the zero entry, when new

  private:
    static constexpr std::size_t none = SIZE_MAX;
    std::size_t count_ = 0;
    std::atomic<std::size_t> first_bad_{none};
    std::atomic<std::int64_t> bad_contacts_{0};
    std::atomic<bool> bounces_{false};

    void mark_bad(std::size_t index);
    bool place(const BodyStore& bodies, std::size_t index, const Contact& contact);
    void remember(ContactCache& cache, std::uint32_t i, std::uint32_t before);
};

}  // namespace motley
