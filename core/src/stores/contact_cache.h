// What is remembered of contacts from one step to the next: by key, the bodies, the colour and the impulses.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "motley/core/constraints/contact_definition.h"
#include "stores/aligned_vector.h"
#include "stores/atomic_ref.h"
#include "stores/key_table.h"

namespace motley {

/// The number of colours that are solved in parallel. Further constraints of a body that has more (a hub) go to the
/// overflow, which is solved one after another.
inline constexpr int parallel_colours = 30;
inline constexpr std::uint8_t overflow_colour = parallel_colours;
inline constexpr std::uint8_t no_colour = 255;

/// The contacts of one step, in the order of the host's list.
struct ContactList {
    /// What identifies a contact in the next step.
    struct Entry {
        std::uint64_t key = 0;
        std::uint32_t body_a = 0, body_b = 0;  ///< fingerprints of the handles
    };
    std::size_t count = 0;
    AlignedVector<Entry> entries;  ///< `count` of them are in use
    AlignedVector<std::uint8_t> colours;
    /// Of the last substep; that of contact i is at i + 1. The first one stays zero, for contacts that are new.
    AlignedVector<ContactImpulse> impulses = AlignedVector<ContactImpulse>(1);
    AlignedVector<ContactImpulse> step_impulses;  ///< of all substeps together
    /// Of contacts that nobody awake has a part in, the slot of a body that sleeps, else 0. Only if `has_sleepers`.
    AlignedVector<std::uint32_t> sleepers;
    bool has_sleepers = false;
};

/// The contacts of the last step, and the new list, which is matched with them by key.
///
/// Hosts list contacts in about the order of the step before, without those that are gone. So the new list is walked
/// along the last one, and only contacts that this misses are looked up, in a hash table of the contacts of the last
/// list that no walk has matched (lost ones). Lists are cut into parts. The calls of one stage for different parts may
/// run on different threads, after all calls of the stage before:
///   1. one Walk for each part, which is told of every contact
///   2. find_lost(part), then open_table() once
///   3. enter_lost(part)
///   4. trace(part, i) for each of missed(part)
///   5. verify(part), then has_repeated_key()
class ContactCache {
  public:
    static constexpr std::uint32_t none = 0xFFFFFFFFU;
    struct Range {
        std::uint32_t begin, end;
    };

    /// Makes room for a list of `count`. Allocates only when the list outgrows every earlier one.
    void begin(std::size_t count);
    [[nodiscard]] const ContactList& current() const { return lists_[current_]; }
    [[nodiscard]] ContactList& staged() { return lists_[1 - current_]; }
    [[nodiscard]] const ContactList& staged() const { return lists_[1 - current_]; }

    [[nodiscard]] std::int64_t part_count() const { return static_cast<std::int64_t>(parts_.size()); }
    /// The contacts of the new list in a part.
    [[nodiscard]] Range part(std::int64_t part) const { return share(staged().count, part); }

    /// Goes along the last list while the contacts of a part of the new one are read.
    class Walk {
      public:
        Walk(ContactCache& cache, std::int64_t part);
        ~Walk();
        Walk(const Walk&) = delete;
        Walk& operator=(const Walk&) = delete;
        /// Returns the contact of the last list with the key of new contact `index`, and marks it as claimed. Returns
        /// none if the walk does not find one: the new contact is then listed as missed.
        std::uint32_t find(std::uint32_t index, std::uint64_t key);

      private:
        [[nodiscard]] std::uint32_t look_around(std::uint64_t key) const;
        ContactCache& cache_;
        const ContactList& list_;
        std::int64_t part_;
        std::uint32_t cursor_;  ///< where in the last list the next contact is expected
        std::uint32_t index_;   ///< one after the new contact that was found last
        std::uint32_t claims_ = 0, missed_;
        int misses_ = 0, patience_ = 1;  ///< misses in a row, and after how many look_around() is called
    };
    /// Lists the contacts in a part of the last list that no walk has claimed.
    void find_lost(std::int64_t part);
    /// Makes room in the table, and finds repeated keys among the claims.
    void open_table();
    /// Enters the lost contacts of a part into the table.
    void enter_lost(std::int64_t part);
    /// The new contacts that the walk of a part did not find.
    [[nodiscard]] std::span<const std::uint32_t> missed(std::int64_t part) const
    {
        const Part& own = parts_[static_cast<std::size_t>(part)];
        return {missed_.data() + own.missed.begin, own.missed.end - own.missed.begin};
    }
    void prefetch(std::uint32_t index) const { table_.prefetch(staged().entries[index].key); }
    /// Looks up a missed contact. Returns the lost contact with its key, or none: then it is new.
    std::uint32_t trace(std::int64_t part, std::uint32_t index);
    /// After that: calls work(index) for each contact of the last list that is not in the new one.
    template <class Work>
    void for_each_gone(const Work& work) const
    {
        for (std::uint32_t i = 0; i < current().count; ++i) {
            if (claimed_[i] == 0) work(i);
        }
    }
    /// Finds contacts matched by a walk that have the key of a new one.
    void verify(std::int64_t part);
    [[nodiscard]] bool has_repeated_key() const { return repeated_; }

    /// Fills an empty cache with the contacts of a last step. Returns false, and leaves the cache unusable, when a key
    /// occurs twice.
    bool restore(std::span<const ContactList::Entry> entries, std::span<const std::uint8_t> colours,
                 std::span<const ContactImpulse> impulses, std::span<const ContactImpulse> step_impulses,
                 std::span<const std::uint32_t> sleepers);
    /// The staged list becomes the current one.
    void accept_staged() { current_ = 1 - current_; }
    [[nodiscard]] std::span<const ContactImpulse> impulses() const
    {
        return {current().impulses.data() + 1, current().count};
    }
    [[nodiscard]] std::span<const ContactImpulse> step_impulses() const
    {
        return {current().step_impulses.data(), current().count};
    }

  private:
    std::array<ContactList, 2> lists_;
    std::size_t current_ = 0;
    struct Part {
        Range missed{}, lost{};  ///< in missed_ and lost_
        std::uint32_t claims = 0;
        std::int32_t shift = 0;  ///< index in the last list minus that in the new one, where the part ends
    };
    Array<Part> parts_;
    AlignedVector<std::uint8_t> claimed_;  ///< for each contact of the last list
    AlignedVector<std::uint32_t> missed_;  ///< indices in the new list; those of a part start where it begins
    AlignedVector<std::uint32_t> lost_;    ///< indices in the last list, likewise
    KeyTable table_;                       ///< of lost and of new contacts
    bool looks_up_ = false;                ///< whether any contact was missed
    bool repeated_ = false;                ///< whether a key occurs twice

    [[nodiscard]] Range share(std::size_t count, std::int64_t part) const
    {
        const auto at = [&](std::int64_t p) {
            return static_cast<std::uint32_t>(static_cast<std::int64_t>(count) * p / part_count());
        };
        return {at(part), at(part + 1)};
    }
    /// A function that returns the key of an entry of the table.
    [[nodiscard]] auto keys() const
    {
        return [this](KeyTable::List which, std::uint32_t i) {
            return (which == KeyTable::List::lost ? current() : staged()).entries[i].key;
        };
    }
    void mark_repeated() { AtomicRef(repeated_).store(true); }
};

inline std::uint32_t ContactCache::Walk::find(std::uint32_t index, std::uint64_t key)
{
    constexpr std::uint32_t ahead = 6;
    std::uint32_t found = none;
    const auto end = std::min(static_cast<std::uint32_t>(list_.count), cursor_ + ahead);
    for (std::uint32_t i = cursor_; i < end && found == none; ++i) {
        if (list_.entries[i].key == key) found = i;
    }
    if (found == none && ++misses_ >= patience_) {
        found = look_around(key);
        misses_ = 0;
        patience_ = found == none ? 2 * patience_ : 4;
    }
    if (found == none) {
        cache_.missed_[missed_++] = index;
        return none;
    }
    misses_ = 0;
    cursor_ = found + 1;
    index_ = index + 1;
    ++claims_;
    // If two new contacts claim the same one, open_table() finds more claims than claimed contacts.
    AtomicRef(cache_.claimed_[found]).store(1);
    return found;
}

}  // namespace motley
