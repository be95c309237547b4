// Contacts found again from step to step. The table of keys changes only by the keys that come and go, which are
// few: most of a crowd touches the neighbours that it touched before.
#include "motley/core/contact_cache.h"

#include <algorithm>
#include <atomic>
#include <bit>

namespace motley {

void KeyTable::reserve(std::size_t count)
{
    count = std::bit_ceil(count);
    keys_.reserve(count);
    free_.reserve(count);
    const std::size_t wanted = 2 * count;
    if (buckets_.size() >= wanted) return;
    std::vector<std::uint64_t> wider(wanted);
    const int shift = 32 - std::countr_zero(wanted);
    for (const std::uint64_t held : buckets_) {
        if (held == 0) continue;
        std::size_t i = (held >> 32) >> shift;
        while (wider[i] != 0) i = (i + 1) & (wanted - 1);
        wider[i] = held;
    }
    buckets_ = std::move(wider);
    shift_ = shift;
}

/// The bucket that holds a key, or the empty one where it would go.
std::size_t KeyTable::bucket_of(std::uint64_t key) const
{
    const std::uint64_t hash = hash_of(key);
    for (std::size_t i = place_of(hash);; i = (i + 1) & (buckets_.size() - 1)) {
        const std::uint64_t held = buckets_[i];
        if (held == 0) return i;
        if (held >> 32 == hash && keys_[static_cast<std::uint32_t>(held) - 1] == key) return i;
    }
}

std::uint32_t KeyTable::find(std::uint64_t key) const
{
    return static_cast<std::uint32_t>(buckets_[bucket_of(key)]) - 1;  // an empty bucket's 0 becomes none
}

std::uint32_t KeyTable::insert(std::uint64_t key)
{
    reserve(size() + 1);
    const std::size_t bucket = bucket_of(key);
    if (buckets_[bucket] != 0) return none;
    std::uint32_t ticket;
    if (free_.empty()) {
        ticket = static_cast<std::uint32_t>(keys_.size());
        keys_.push_back(key);
    } else {
        ticket = free_.back();
        free_.pop_back();
        keys_[ticket] = key;
    }
    buckets_[bucket] = hash_of(key) << 32 | (ticket + 1);
    return ticket;
}

void KeyTable::remove(std::uint64_t key)
{
    std::size_t hole = bucket_of(key);
    if (buckets_[hole] == 0) return;
    free_.push_back(static_cast<std::uint32_t>(buckets_[hole]) - 1);
    // Knuth, The Art of Computer Programming 3, algorithm 6.4R: whoever probed across the hole moves into it.
    const std::size_t mask = buckets_.size() - 1;
    for (std::size_t i = (hole + 1) & mask; buckets_[i] != 0; i = (i + 1) & mask) {
        const std::size_t home = place_of(buckets_[i] >> 32);
        if (((i - home) & mask) < ((i - hole) & mask)) continue;
        buckets_[hole] = buckets_[i];
        hole = i;
    }
    buckets_[hole] = 0;
}

void ContactCache::begin(std::size_t count)
{
    ContactList& list = staged();
    list.count = count;
    if (list.entries.size() < count) {
        // Room to grow into, so that a crowd that keeps pressing together does not allocate at each new contact.
        const std::size_t room = std::max<std::size_t>(64, count + count / 2);
        list.entries.resize(room);
        list.impulses.resize(room + 1);
        keys_.reserve(2 * room);  // all gone and as many come, at most
        positions_.resize(2 * room);
        newcomers_.reserve(room);
    }
    if (claims_.size() < current().entries.size()) claims_.resize(current().entries.size());
    std::fill_n(claims_.begin(), current().count, 0U);
}

void ContactCache::claim(std::uint32_t before, std::uint32_t index)
{
    staged().entries[index].ticket = before;
    if (before == none) return;
    // Of two that claim one contact only one is found here by admit(): no need to see the other in time.
    std::atomic_ref(claims_[before]).store(index + 1, std::memory_order_relaxed);
}

bool ContactCache::admit()
{
    ContactList& list = staged();
    newcomers_.clear();
    bool twice = false;
    for (std::uint32_t i = 0; i < list.count && !twice; ++i) {
        std::uint32_t& ticket = list.entries[i].ticket;
        if (ticket == none) {
            ticket = keys_.insert(list.entries[i].key);
            twice = ticket == none;
            if (!twice) newcomers_.push_back(i);
        } else {
            twice = claims_[ticket] != i + 1;  // ticket is the place in the current list until here
            ticket = current().entries[ticket].ticket;
        }
    }
    if (twice) {
        for (const std::uint32_t i : newcomers_) keys_.remove(list.entries[i].key);
        return false;
    }
    for (std::size_t i = 0; i < current().count; ++i) {
        if (claims_[i] == 0) keys_.remove(current().entries[i].key);
    }
    for (std::uint32_t i = 0; i < list.count; ++i) positions_[list.entries[i].ticket] = i;
    return true;
}

}  // namespace motley
