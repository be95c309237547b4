// What is remembered of contacts from one step to the next: by key, the bodies, the colour and the impulses.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

#include "motley/core/aligned_vector.h"
#include "motley/core/constraints/contact_definition.h"
#include "motley/core/key_table.h"

namespace motley {

/// Colours that run in parallel. A body with more constraints than this (a hub) sends the rest to the
/// overflow, which runs in order.
inline constexpr int parallel_colours = 30;
inline constexpr std::uint8_t overflow_colour = parallel_colours;
inline constexpr std::uint8_t no_colour = 255;

/// The contacts of one step, in the order of the host's list.
struct ContactList {
    /// What tells a contact of the next step that it is the same one.
    struct Entry {
        std::uint64_t key = 0;
        std::uint32_t body_a = 0, body_b = 0;  ///< fingerprints of the handles
    };
    std::size_t count = 0;
    AlignedVector<Entry> entries;  ///< `count` of them are in use
    AlignedVector<std::uint8_t> colours;
    /// Of the last substep, of contact i at i + 1; the first stays zero, where a contact without a past looks for it.
    AlignedVector<ContactImpulse> impulses = AlignedVector<ContactImpulse>(1);
    AlignedVector<ContactImpulse> step_impulses;  ///< of all substeps together
};

/// The list of the last step and the one in the making.
///
/// Hosts list contacts in about the order of the step before, less those that are gone. So the new list is walked along
/// the last one, and only what is missed on the way is looked up, in a table of what no walk came by. Lists are cut into
/// parts; the calls for all parts of one stage may run on different threads, and come after those of the stage before:
///   1. a Walk a part, which is told of every contact
///   2. find_lost(part), then open_table()
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

    /// Goes along the last list while a part of the new one is taken in.
    class Walk {
      public:
        Walk(ContactCache& cache, std::int64_t part);
        ~Walk();
        Walk(const Walk&) = delete;
        Walk& operator=(const Walk&) = delete;
        /// The contact of the last list with the key of new contact `index`, which is then claimed; or none, and it is
        /// missed.
        std::uint32_t find(std::uint32_t index, std::uint64_t key);

      private:
        [[nodiscard]] std::uint32_t look_around(std::uint64_t key) const;
        ContactCache& cache_;
        const ContactList& list_;
        std::int64_t part_;
        std::uint32_t cursor_;  ///< where the next one is expected
        std::uint32_t index_;   ///< of the new contact that was found last, and one
        std::uint32_t claims_ = 0, missed_;
        int misses_ = 0, patience_ = 1;  ///< misses in line, and how many until it looks around
    };
    void find_lost(std::int64_t part);
    void open_table();
    void enter_lost(std::int64_t part);
    /// New contacts that no walk found.
    [[nodiscard]] std::span<const std::uint32_t> missed(std::int64_t part) const
    {
        const Part& own = parts_[static_cast<std::size_t>(part)];
        return {missed_.data() + own.missed.begin, own.missed.end - own.missed.begin};
    }
    void prefetch(std::uint32_t index) const { table_.prefetch(staged().entries[index].key); }
    /// The lost contact that new contact `index` was, or none: then it is new.
    std::uint32_t trace(std::int64_t part, std::uint32_t index);
    void verify(std::int64_t part);
    [[nodiscard]] bool has_repeated_key() const { return repeated_; }

    /// Of an empty cache: these are the contacts of the last step. False, with the cache no longer of use, when a key
    /// comes twice.
    bool restore(std::span<const ContactList::Entry> entries, std::span<const std::uint8_t> colours,
                 std::span<const ContactImpulse> impulses, std::span<const ContactImpulse> step_impulses);
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
    ContactList lists_[2];
    int current_ = 0;
    struct Part {
        Range missed{}, lost{};  ///< in the lists of all parts
        std::uint32_t claims = 0;
        std::int32_t shift = 0;  ///< how much further on the last list is at the end of this part
    };
    std::vector<Part> parts_;
    AlignedVector<std::uint8_t> claimed_;  ///< of the last list
    AlignedVector<std::uint32_t> missed_;  ///< of the new list, each part's where the part begins
    AlignedVector<std::uint32_t> lost_;    ///< of the last list, likewise
    KeyTable table_;                       ///< of what is lost, and of what is new
    bool looks_up_ = false;                ///< whether anything was missed
    bool repeated_ = false;                ///< a key came twice

    [[nodiscard]] Range share(std::size_t count, std::int64_t part) const
    {
        const auto at = [&](std::int64_t p) {
            return static_cast<std::uint32_t>(static_cast<std::int64_t>(count) * p / part_count());
        };
        return {at(part), at(part + 1)};
    }
    /// The keys that stand in the table.
    [[nodiscard]] auto keys() const
    {
        return [this](KeyTable::List which, std::uint32_t i) {
            return (which == KeyTable::List::lost ? current() : staged()).entries[i].key;
        };
    }
    void mark_repeated() { std::atomic_ref(repeated_).store(true, std::memory_order_relaxed); }
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
    // Two that claim the same one are found out by their number: find_lost() counts who was claimed.
    std::atomic_ref(cache_.claimed_[found]).store(1, std::memory_order_relaxed);
    return found;
}

}  // namespace motley
