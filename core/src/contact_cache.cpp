// The table from contact keys to indices: open addressing, linear probing, at most half full.
#include "motley/core/contact_cache.h"

#include <algorithm>
#include <bit>

namespace motley {

void ContactList::reset(std::size_t count)
{
    count_ = count;
    if (keys.size() < count) {
        // Room to grow into, so that a crowd that keeps pressing together does not allocate at each new
        // contact.
        const std::size_t room = std::max<std::size_t>(64, count + count / 2);
        keys.resize(room);
        slot_a.resize(room);
        slot_b.resize(room);
        colours.resize(room);
        impulses.resize(room + 1);
    }
    const std::size_t wanted = std::bit_ceil(std::max<std::size_t>(64, 2 * keys.size()));
    if (table_.size() < wanted) table_.resize(wanted);
    // A fixed share of the table would waste cache on small lists, so the hash uses only what this list
    // needs.
    const std::size_t used = std::min(table_.size(), std::bit_ceil(std::max<std::size_t>(64, 2 * count)));
    shift_ = 64 - std::countr_zero(used);
    std::fill_n(table_.begin(), used, 0U);
}

bool ContactList::insert(std::uint64_t key, std::uint32_t index)
{
    const std::size_t mask = (std::size_t{1} << (64 - shift_)) - 1;
    keys[index] = key;
    for (std::size_t i = bucket(key);; i = (i + 1) & mask) {
        std::atomic_ref<std::uint32_t> entry(table_[i]);
        std::uint32_t held = entry.load(std::memory_order_acquire);
        if (held == 0 && entry.compare_exchange_strong(held, index + 1, std::memory_order_acq_rel))
            return true;
        if (keys[held - 1] == key) return false;
    }
}

std::uint32_t ContactList::find(std::uint64_t key) const
{
    if (count_ == 0) return none;
    const std::size_t mask = (std::size_t{1} << (64 - shift_)) - 1;
    for (std::size_t i = bucket(key);; i = (i + 1) & mask) {
        const std::uint32_t held = table_[i];
        if (held == 0) return none;
        if (keys[held - 1] == key) return held - 1;
    }
}

}  // namespace motley
