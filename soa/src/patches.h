// Patches: parts of a large crowd whose contacts are solved on their own, in a core's cache.
//
// A sweep by colours alone passes all bodies once a colour, and a cache line of four bodies for the sake of one: a crowd that
// no cache holds would come through memory five times a sweep. So the host's list is cut into stretches. A moving body is of
// the patch of the first stretch that touches it, and a contact among bodies of its own stretch's patch is inside: nothing
// inside one patch touches what is inside another, and each is swept colour after colour by one thread, apart from all that
// lies across. A patch's bodies are listed, so that one visit can solve it, move its bodies and relax it. A list in which
// neighbours in space are neighbours leaves little across; any other only has less inside. What is inside depends on the order
// of the list alone, not on threads, lanes or where bodies lie in memory.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

#include "motley/core/aligned_vector.h"
#include "motley/core/body_store.h"
#include "motley/core/growth.h"

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
        for (auto& owners : owners_) {
            if (wraps) std::fill(owners.begin(), owners.end(), 0U);
        }
        for (int kind = 0; kind < moving_kinds; ++kind)
            owners_[kind].resize(bodies.rows(static_cast<BodyKind>(kind)).size(), 0U);
        grow_to(counts_, contacts / contacts_a_patch + 1);
        if (bodies_.size() < counts_.size() * bodies_a_patch) bodies_.resize(counts_.size() * bodies_a_patch);
    }
    [[nodiscard]] bool are_wanted() const { return wanted_; }

    /// Contact `index` of the list touches this body. May be called from several threads: the first of the list wins.
    void claim(BodyRow body, std::uint32_t index)
    {
        if (body.kind() == BodyKind::fixed) return;
        const std::uint32_t mine = claim_of(index / contacts_a_patch);
        std::atomic_ref<std::uint32_t> owner(owners_[static_cast<std::size_t>(body.kind())][body.row()]);
        std::uint32_t seen = owner.load(std::memory_order_relaxed);
        while (mine > seen && !owner.compare_exchange_weak(seen, mine, std::memory_order_relaxed)) {
        }
    }
    /// When all are claimed: goes along a patch's stretch of the list, told of every body, and lists those of the patch.
    class Roll {
      public:
        Roll(Patches& patches, std::size_t patch)
            : patches_(patches),
              patch_(patch),
              claim_(patches.claim_of(patch)),
              end_(patches.bodies_.data() + patch * bodies_a_patch)
        {
        }
        /// The patch's bodies of one kind lie in line.
        ~Roll();
        Roll(const Roll&) = delete;
        Roll& operator=(const Roll&) = delete;
        /// Whether the body is of the patch, or cannot move.
        [[nodiscard]] bool holds(BodyRow body)
        {
            if (body.kind() == BodyKind::fixed) return true;
            std::atomic_ref<std::uint32_t> owner(
                patches_.owners_[static_cast<std::size_t>(body.kind())][body.row()]);
            const std::uint32_t found = owner.load(std::memory_order_relaxed);
            if ((found | listed) != (claim_ | listed)) return false;
            // Written always and counted when new: no predictor guesses who has been listed.
            owner.store(claim_ | listed, std::memory_order_relaxed);
            *end_ = body;
            end_ += found == claim_ ? 1 : 0;
            return true;
        }

      private:
        Patches& patches_;
        std::size_t patch_;
        std::uint32_t claim_;
        BodyRow* end_;
    };
    /// Of the present list and a kind that moves.
    [[nodiscard]] std::span<const BodyRow> bodies_of(std::size_t patch, BodyKind kind) const
    {
        const KindCounts& counts = counts_[patch];
        std::size_t first = patch * bodies_a_patch;
        for (std::size_t before = 0; before < static_cast<std::size_t>(kind); ++before)
            first += counts[before];
        return {bodies_.data() + first, counts[static_cast<std::size_t>(kind)]};
    }
    /// Whether a patch lists the body, of a kind that moves.
    [[nodiscard]] bool lists(BodyRow body) const
    {
        return owners_[static_cast<std::size_t>(body.kind())][body.row()] >> list_shift == list_;
    }

  private:
    static constexpr int moving_kinds = 3;
    static constexpr std::size_t bodies_a_patch = 2 * contacts_a_patch + 1;  // and one to write to in vain
    using KindCounts = std::array<std::uint32_t, moving_kinds>;
    // A claim: the number of the list, the patch, and a bit for a body that its patch has listed.
    static constexpr int patch_bits = 17, list_shift = patch_bits + 1;
    static constexpr std::uint32_t listed = 1;
    static constexpr std::uint32_t most_patches = 1U << patch_bits;
    static constexpr std::uint32_t last_list = (1U << (32 - list_shift)) - 1;
    /// A later list beats an earlier one, so that nobody has to take old claims away; in a list the first patch wins.
    [[nodiscard]] std::uint32_t claim_of(std::size_t patch) const
    {
        return list_ << list_shift | (most_patches - 1 - static_cast<std::uint32_t>(patch)) << 1;
    }

    bool wanted_ = false;
    std::uint32_t list_ = 0;  ///< a number of its own among the last few thousand lists
    std::array<AlignedVector<std::uint32_t>, moving_kinds> owners_;  ///< the best claim, by row
    std::vector<KindCounts> counts_;                                 ///< of each patch's bodies
    AlignedVector<BodyRow> bodies_;                                  ///< of each patch, in its own room
};

inline Patches::Roll::~Roll()
{
    BodyRow* const first = patches_.bodies_.data() + patch_ * bodies_a_patch;
    KindCounts& counts = patches_.counts_[patch_];
    counts = {};
    for (const BodyRow* body = first; body != end_; ++body) ++counts[static_cast<std::size_t>(body->kind())];
    static_assert(moving_kinds == 3, "the third kind is what remains");
    const auto of = [](BodyKind kind) { return [kind](BodyRow body) { return body.kind() == kind; }; };
    std::partition(std::partition(first, end_, of(BodyKind{0})), end_, of(BodyKind{1}));
}

}  // namespace motley
