// Patches: parts of a large crowd whose contacts are solved on their own, in a core's cache.
//
// A sweep by colours alone passes all bodies once a colour, and a cache line of four bodies for the sake of one: a crowd that
// no cache holds would come through memory five times a sweep. So the host's list is cut into stretches. A moving body is of
// the patch of the first stretch that touches it, and a contact among bodies of its own stretch's patch is inside: nothing
// inside one patch touches what is inside another, and each is swept colour after colour by one thread, after the colours of
// all that lies across. A list in which neighbours in space are neighbours leaves little across; any other only has less
// inside. What is inside depends on the order of the list alone, not on threads, lanes or where bodies lie in memory.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

#include "motley/core/aligned_vector.h"
#include "motley/core/body_store.h"

namespace motley {

class Patches {
  public:
    /// A stretch. With bodies, rows and impulses its patch takes about 300 KB.
    static constexpr std::size_t contacts_a_patch = 4096;
    /// Fewer contacts fit the caches by themselves, and make too few patches for many threads to share.
    static constexpr std::size_t from_contacts = std::size_t{1} << 16;

    /// Starts over for a list of so many contacts.
    void begin(const BodyStore& bodies, std::size_t contacts)
    {
        wanted_ = contacts >= from_contacts && contacts / contacts_a_patch < most_patches;
        if (!wanted_) return;
        const bool wraps = ++list_ > last_list;
        if (wraps) list_ = 1;
        for (int kind = 0; kind < moving_kinds; ++kind) {
            if (wraps) owners_[kind].clear();
            owners_[kind].resize(bodies.rows(static_cast<BodyKind>(kind)).size(), 0U);
        }
    }
    [[nodiscard]] bool are_wanted() const { return wanted_; }

    /// Contact `index` of the list touches this body. May be called from several threads: the first of the list wins.
    void claim(BodyRow body, std::uint32_t index)
    {
        if (body.kind() == BodyKind::fixed) return;
        const std::uint32_t mine = claim_of(index);
        std::atomic_ref<std::uint32_t> owner(owners_[static_cast<std::size_t>(body.kind())][body.row()]);
        std::uint32_t seen = owner.load(std::memory_order_relaxed);
        while (mine > seen && !owner.compare_exchange_weak(seen, mine, std::memory_order_relaxed)) {
        }
    }
    /// When all are claimed: whether contact `index` between these bodies is inside a patch.
    [[nodiscard]] bool holds(BodyRow a, BodyRow b, std::uint32_t index) const
    {
        const std::uint32_t claim = claim_of(index);
        return is_under(a, claim) && is_under(b, claim);
    }

  private:
    static constexpr int moving_kinds = 3;
    static constexpr int patch_bits = 18;
    static constexpr std::uint32_t most_patches = 1U << patch_bits;
    static constexpr std::uint32_t last_list = (1U << (32 - patch_bits)) - 1;
    /// A later list beats an earlier one, so that nobody has to take old claims away; in a list the first patch wins.
    [[nodiscard]] std::uint32_t claim_of(std::uint32_t index) const
    {
        const auto patch = index / static_cast<std::uint32_t>(contacts_a_patch);
        return list_ << patch_bits | (most_patches - 1 - patch);
    }
    [[nodiscard]] bool is_under(BodyRow body, std::uint32_t claim) const
    {
        return body.kind() == BodyKind::fixed ||
               owners_[static_cast<std::size_t>(body.kind())][body.row()] == claim;
    }

    bool wanted_ = false;
    std::uint32_t list_ = 0;  ///< a number of its own among the last few thousand lists
    std::array<AlignedVector<std::uint32_t>, moving_kinds> owners_;  ///< the best claim, by row
};

}  // namespace motley
