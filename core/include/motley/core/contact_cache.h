// What is remembered of contacts from one step to the next: by key, the bodies, the colour and the impulses.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

#include "motley/core/aligned_vector.h"
#include "motley/core/constraints/contact_definition.h"

namespace motley {

inline constexpr std::uint8_t no_colour = 255;

/// The contacts of one step, in the order of the host's list.
struct ContactList {
    /// What tells a contact of the next step that it is the same one.
    struct Entry {
        std::uint64_t key = 0;
        std::uint32_t body_a = 0, body_b = 0;  ///< fingerprints of the handles
    };
    std::size_t count = 0;
    AlignedVector<Entry> entries;          ///< `count` of them are in use
    AlignedVector<std::uint32_t> tickets;  ///< of the keys in the cache's table
    AlignedVector<std::uint8_t> colours;
    /// Of contact i at i + 1; the first stays zero, where a contact without a past looks for it.
    AlignedVector<ContactImpulse> impulses = AlignedVector<ContactImpulse>(1);
    AlignedVector<std::uint32_t> positions;  ///< by ticket: the index of its contact, or KeyTable::none
};

/// Numbers for keys: a key gets a ticket, a small number of its own, for as long as it is known. Open addressing,
/// linear probing, at most four fifths full, and that only while all keys of two lists are known.
class KeyTable {
  public:
    static constexpr std::uint32_t none = 0xFFFFFFFFU;

    /// Room for `count` keys: until then insert() allocates nothing.
    void reserve(std::size_t count);
    /// The ticket of a key, or none.
    [[nodiscard]] std::uint32_t find(std::uint64_t key) const;
    /// A new ticket, or none when the key has one already.
    std::uint32_t insert(std::uint64_t key);
    /// Takes a known key's ticket back.
    void remove(std::uint64_t key);
    /// Asks for the cache line that any of the three will look at first.
    void prefetch(std::uint64_t key) const { __builtin_prefetch(&buckets_[place_of(hash_of(key))]); }
    [[nodiscard]] std::size_t size() const { return keys_.size() - free_.size(); }
    /// Tickets are below this.
    [[nodiscard]] std::size_t ticket_limit() const { return keys_.size(); }

  private:
    // A bucket holds 32 bits of the key's hash above ticket + 1: zero is empty, and a probe that passes strangers
    // seldom has to fetch their keys. Its place follows from those bits alone, so that moving fetches none.
    static std::uint64_t hash_of(std::uint64_t key)
    {
        return (key ^ key >> 32) * 0x9E3779B97F4A7C15ULL >> 32;
    }
    [[nodiscard]] std::size_t place_of(std::uint64_t hash) const { return hash >> shift_; }
    [[nodiscard]] std::size_t bucket_of(std::uint64_t key) const;

    AlignedVector<std::uint64_t> buckets_ = AlignedVector<std::uint64_t>(64);
    int shift_ = 32 - 6;
    AlignedVector<std::uint64_t> keys_;  ///< by ticket
    std::vector<std::uint32_t> free_;    ///< tickets, last taken back first
};

/// The list of the last step and the one in the making.
class ContactCache {
  public:
    static constexpr std::uint32_t none = KeyTable::none;

    /// Makes room for a list of `count`. Allocates only when the list outgrows every earlier one.
    void begin(std::size_t count);
    [[nodiscard]] const ContactList& current() const { return lists_[current_]; }
    [[nodiscard]] ContactList& staged() { return lists_[1 - current_]; }

    /// Where the last step's list has a key, or none.
    [[nodiscard]] std::uint32_t find(std::uint64_t key) const
    {
        const std::uint32_t ticket = keys_.find(key);
        return ticket == none ? none : current().positions[ticket];
    }
    /// Likewise, but looks only at `cursor` and the few entries behind it, and moves it behind the one found: lists
    /// mostly come in the order of the step before, with a few contacts gone.
    [[nodiscard]] std::uint32_t find_near(std::uint64_t key, std::uint32_t& cursor) const;
    void prefetch(std::uint64_t key) const { keys_.prefetch(key); }
    /// Says that staged contact `index` has the key of contact `before` of the last step, or of none. Safe from
    /// several threads.
    void claim(std::uint32_t index, std::uint32_t before);
    /// Once every contact is staged and has claimed its past: finds the keys that come and go, in parts that may run
    /// on different threads...
    [[nodiscard]] std::int64_t survey_parts() const { return static_cast<std::int64_t>(surveys_.size()); }
    void survey(std::int64_t part);
    /// ...then gives new keys their tickets and forgets those that are gone. False, and nothing changed, when a key
    /// came twice.
    bool admit();
    /// Of an empty cache: these are the contacts of the last step. False, with the cache no longer of use, when a key
    /// comes twice.
    bool restore(std::span<const ContactList::Entry> entries, std::span<const std::uint8_t> colours,
                 std::span<const ContactImpulse> impulses);
    /// The staged list becomes the current one.
    void accept_staged() { current_ = 1 - current_; }
    [[nodiscard]] std::span<const ContactImpulse> impulses() const
    {
        return {current().impulses.data() + 1, current().count};
    }

  private:
    ContactList lists_[2];
    int current_ = 0;
    KeyTable keys_;
    AlignedVector<std::uint32_t>
        newcomers_;  ///< staged contacts without a past, each part's where the part begins
    AlignedVector<std::uint32_t> leavers_;  ///< current contacts without a future, likewise
    struct Survey {
        std::uint32_t first_newcomer = 0, last_newcomer = 0, first_leaver = 0, last_leaver = 0;
        bool has_repeated_key = false;
    };
    std::vector<Survey> surveys_;
};

inline std::uint32_t ContactCache::find_near(std::uint64_t key, std::uint32_t& cursor) const
{
    constexpr std::size_t ahead = 6;
    const ContactList& list = current();
    const auto end = static_cast<std::uint32_t>(std::min(list.count, cursor + ahead));
    for (std::uint32_t i = cursor; i < end; ++i) {
        if (list.entries[i].key != key) continue;
        cursor = i + 1;
        return i;
    }
    return none;
}

inline void ContactCache::claim(std::uint32_t index, std::uint32_t before)
{
    ContactList& list = staged();
    const std::uint32_t ticket = before == none ? none : current().tickets[before];
    list.tickets[index] = ticket;
    // Of two that claim one ticket only one is found here by admit(): no need to see the other in time.
    if (ticket != none) std::atomic_ref(list.positions[ticket]).store(index, std::memory_order_relaxed);
}

}  // namespace motley
