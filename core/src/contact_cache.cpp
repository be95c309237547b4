// The table from contact keys to indices: open addressing, linear probing, at most half full.
#include "motley/core/contact_cache.h"

#include <algorithm>
#include <bit>

namespace motley {

void ContactList::reset(std::size_t count)
{
    count_ = count;
    if (entries.size() < count) {
        // Room to grow into, so that a crowd that keeps pressing together does not allocate at each new
        // contact.
        const std::size_t room = std::max<std::size_t>(64, count + count / 2);
        entries.resize(room);
        colours.resize(room);
        impulses.resize(room + 1);
    }
    const std::size_t wanted = std::bit_ceil(std::max<std::size_t>(64, 2 * entries.size()));
    if (table_.size() < wanted) table_.resize(wanted);
    // A fixed share of the table would waste cache on small lists, so the hash uses only what this list
    // needs.
    const std::size_t used = std::min(table_.size(), std::bit_ceil(std::max<std::size_t>(64, 2 * count)));
    shift_ = 64 - std::countr_zero(used);
    std::fill_n(table_.begin(), used, std::uint64_t{0});
}

bool ContactList::insert(std::uint32_t index)
{
    const std::uint64_t hash = mix(entries[index].key);
    const std::uint64_t value = hash << 32 | (index + 1);
    const std::size_t mask = (std::size_t{1} << (64 - shift_)) - 1;
    for (std::size_t i = bucket(hash);; i = (i + 1) & mask) {
        std::atomic_ref<std::uint64_t> entry(table_[i]);
        std::uint64_t held = entry.load(std::memory_order_acquire);
        if (held == 0 && entry.compare_exchange_strong(held, value, std::memory_order_acq_rel)) return true;
        const bool same_hash = (held ^ value) >> 32 == 0;
        if (same_hash && entries[static_cast<std::uint32_t>(held) - 1].key == entries[index].key)
            return false;
    }
}

std::uint32_t ContactList::find_in_table(std::uint64_t key) const
{
    const std::uint64_t hash = mix(key);
    const std::size_t mask = (std::size_t{1} << (64 - shift_)) - 1;
    for (std::size_t i = bucket(hash);; i = (i + 1) & mask) {
        const std::uint64_t held = table_[i];
        if (held == 0) return none;
        const std::uint32_t index = static_cast<std::uint32_t>(held) - 1;
        if ((held ^ (hash << 32)) >> 32 == 0 && entries[index].key == key) return index;
    }
}

}  // namespace motley
