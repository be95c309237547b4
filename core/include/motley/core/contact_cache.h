// What is remembered of contacts from one step to the next: by key, the bodies, the colour and the impulses.
#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

#include "motley/core/aligned_vector.h"
#include "motley/core/constraints/contact_definition.h"

namespace motley {

inline constexpr std::uint8_t no_colour = 255;

/// The contacts of one list: what persists, in list order, and an open-addressing table from key to index.
class ContactList {
  public:
    static constexpr std::uint32_t none = 0xFFFFFFFFU;

    /// Forgets the old list and makes room for `count` contacts. Allocates only when the list outgrows every
    /// earlier one.
    void reset(std::size_t count);
    [[nodiscard]] std::size_t size() const { return count_; }

    /// Puts contact `index`, whose entry is already written, into the table. Safe from several threads at
    /// once, as the final table answers the same whoever comes first. False when another index already has
    /// the key.
    bool insert(std::uint32_t index);
    /// The index of a key, or none. `hint` is looked at first: lists mostly come in the order of the step
    /// before, where the contact after the last one found is the next one wanted.
    [[nodiscard]] std::uint32_t find(std::uint64_t key, std::uint32_t hint) const
    {
        if (hint < count_ && entries[hint].key == key) return hint;
        return count_ == 0 ? none : find_in_table(key);
    }
    /// Asks for the cache line where `key` will be inserted.
    void prefetch(std::uint64_t key) const { __builtin_prefetch(&table_[bucket(mix(key))], 1); }

    /// What tells a contact of the next step that it is the same one.
    struct Entry {
        std::uint64_t key = 0;
        std::uint32_t body_a = 0, body_b = 0;  ///< fingerprints of the handles
    };
    std::vector<Entry> entries;
    std::vector<std::uint8_t> colours;
    /// Of contact i at i + 1; the first stays zero, where a contact without a past looks for it.
    AlignedVector<ContactImpulse> impulses;
    ContactList() : impulses(1) {}

  private:
    static std::uint64_t mix(std::uint64_t key) { return (key ^ key >> 32) * 0x9E3779B97F4A7C15ULL; }
    [[nodiscard]] std::size_t bucket(std::uint64_t hash) const { return hash >> shift_; }
    [[nodiscard]] std::uint32_t find_in_table(std::uint64_t key) const;
    // A bucket holds the low half of the hash above index + 1: zero is empty, and a probe that passes
    // strangers seldom has to fetch their keys.
    std::vector<std::uint64_t> table_;
    int shift_ = 58;
    std::size_t count_ = 0;
};

/// The list of the last step and the one in the making; accepting swaps them.
class ContactCache {
  public:
    [[nodiscard]] const ContactList& current() const { return lists_[current_]; }
    [[nodiscard]] ContactList& current() { return lists_[current_]; }
    [[nodiscard]] ContactList& staged() { return lists_[1 - current_]; }
    void accept_staged() { current_ = 1 - current_; }
    [[nodiscard]] std::span<const ContactImpulse> impulses() const
    {
        return current().size() == 0
                   ? std::span<const ContactImpulse>{}
                   : std::span<const ContactImpulse>{current().impulses.data() + 1, current().size()};
    }

  private:
    ContactList lists_[2];
    int current_ = 0;
};

}  // namespace motley
