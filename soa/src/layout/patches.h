// Patches: parts of a large crowd whose contacts are solved on their own, in a core's cache.
//
// A sweep by colours alone reads all bodies once per colour, and a cache line of four bodies for the sake of one: a
// crowd that fits no cache would be read from memory five times a sweep. So the host's list of contacts is cut into
// stretches, one for each patch. A moving body belongs to the patch of the first stretch that touches it. A contact
// is inside the patch of its stretch if its moving bodies belong to that patch. Contacts inside different patches
// share no moving body, so each patch is swept by one thread, colour after colour, apart from the contacts that are
// in no patch. A patch's bodies are listed, so that one visit can solve it, move its bodies and relax it. A list in
// which neighbours in space are neighbours leaves few contacts in no patch; any other list only has fewer inside.
// What is inside depends only on the order of the list, not on threads, lanes or where bodies are in memory.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "stores/aligned_vector.h"
#include "stores/atomic_ref.h"
#include "stores/body_store.h"
#include "stores/growth.h"

namespace motley {

class Patches {
  public:
    /// The length of a stretch. With bodies, rows and impulses its patch takes about 300 KB.
    static constexpr std::size_t contacts_a_patch = 4096;
    /// Fewer contacts get no patches: they fit the caches anyway, and would be too few patches for many threads.
    static constexpr std::size_t from_contacts = std::size_t{1} << 16;

    /// Starts over for a list of `contacts` contacts.
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

    /// Notes that contact `index` of the list touches this body. May be called from several threads: the first
    /// contact of the list wins.
    void claim(BodyRow body, std::uint32_t index)
    {
        if (body.kind() == BodyKind::fixed) return;
        const std::uint32_t mine = claim_of(index / contacts_a_patch);
        const AtomicRef owner(owners_[static_cast<std::size_t>(body.kind())][body.row()]);
        std::uint32_t seen = owner.load();
        while (mine > seen && !owner.compare_exchange(seen, mine)) {
        }
    }
    /// After all claims: is told of every body of a patch's stretch of the list, and lists those that belong to the
    /// patch.
    class Roll {
      public:
        Roll(Patches& patches, std::size_t patch)
            : patches_(patches),
              patch_(patch),
              claim_(patches.claim_of(patch)),
              end_(patches.bodies_.data() + patch * bodies_a_patch)
        {
        }
        /// Sorts the patch's bodies by kind.
        ~Roll();
        Roll(const Roll&) = delete;
        Roll& operator=(const Roll&) = delete;
        /// Whether the body belongs to the patch or cannot move. Lists it when it belongs and is not listed yet.
        [[nodiscard]] bool holds(BodyRow body)
        {
            if (body.kind() == BodyKind::fixed) return true;
            const AtomicRef owner(patches_.owners_[static_cast<std::size_t>(body.kind())][body.row()]);
            const std::uint32_t found = owner.load();
            if ((found | listed) != (claim_ | listed)) return false;
            // Written in any case and counted only when new: a branch on whether a body is new would often be
            // mispredicted.
            owner.store(claim_ | listed);
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
    /// A patch's bodies of one kind, which must be a moving one, in the present list.
    [[nodiscard]] std::span<const BodyRow> bodies_of(std::size_t patch, BodyKind kind) const
    {
        const KindCounts& counts = counts_[patch];
        std::size_t first = patch * bodies_a_patch;
        for (std::size_t before = 0; before < static_cast<std::size_t>(kind); ++before)
            first += counts[before];
        return {bodies_.data() + first, counts[static_cast<std::size_t>(kind)]};
    }
    /// Whether a patch lists the body, which must be of a moving kind.
    [[nodiscard]] bool lists(BodyRow body) const
    {
        return owners_[static_cast<std::size_t>(body.kind())][body.row()] >> list_shift == list_;
    }

  private:
    static constexpr int moving_kinds = 3;
    static constexpr std::size_t bodies_a_patch = 2 * contacts_a_patch + 1;  // one more, for dummy writes
    using KindCounts = std::array<std::uint32_t, moving_kinds>;
    // A claim consists of the number of the list, the patch, and a bit that says that the patch has listed the body.
    static constexpr int patch_bits = 17, list_shift = patch_bits + 1;
    static constexpr std::uint32_t listed = 1;
    static constexpr std::uint32_t most_patches = 1U << patch_bits;
    static constexpr std::uint32_t last_list = (1U << (32 - list_shift)) - 1;
    /// A claim of a later list is larger than any of an earlier one, so old claims need not be cleared. Within a list
    /// the first patch has the largest claim.
    [[nodiscard]] std::uint32_t claim_of(std::size_t patch) const
    {
        return list_ << list_shift | (most_patches - 1 - static_cast<std::uint32_t>(patch)) << 1;
    }

    bool wanted_ = false;
    std::uint32_t list_ = 0;  ///< the number of the list, unique among the last few thousand
    std::array<AlignedVector<std::uint32_t>, moving_kinds> owners_;  ///< the largest claim, by row
    Array<KindCounts> counts_;                                       ///< of each patch's bodies
    AlignedVector<BodyRow> bodies_;                                  ///< of each patch, in a range of its own
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
