// A hash set of contact keys that several threads fill at once: see ContactCache.
#pragma once

#include <bit>
#include <cstdint>

#include "stores/aligned_vector.h"
#include "stores/atomic_ref.h"

namespace motley {

/// Open addressing with linear probing, at most three quarters full. An entry is a list and an index in it (below
/// 2^31), not the key itself; the lists belong to the caller.
class KeyTable {
  public:
    /// The list of an entry: contacts of the last step that are not matched (lost), or of the new list (fresh).
    enum class List : std::uint8_t { lost, fresh };
    struct Found {
        List list;
        std::uint32_t index;  ///< in the list, or none
        static constexpr std::uint32_t none = 0xFFFFFFFFU;
    };

    /// Reserves memory so that clear() allocates nothing for up to `count` keys, up to `fresh` of them fresh. Does not
    /// touch that memory.
    void reserve(std::size_t count, std::size_t fresh);
    /// Empties the table, and makes room for `count` keys, `fresh` of them fresh.
    void clear(std::size_t count, std::size_t fresh);
    /// Prefetches the cache line that enter() will read first.
    void prefetch(std::uint64_t key) const { __builtin_prefetch(&buckets_[place_of(hash_of(key))]); }

    /// Enters entry `index` of `list`, whose key is `key`, and returns none; or returns the entry that has this key
    /// already. `key_of(list, index)` must return the key of an entry.
    template <class KeyOf>
    Found enter(std::uint64_t key, List list, std::uint32_t index, const KeyOf& key_of)
    {
        const std::uint64_t hash = hash_of(key);
        const std::uint64_t own = hash << 32 | std::uint64_t{index} << 1 | static_cast<std::uint64_t>(list);
        for (std::size_t i = place_of(hash);; i = (i + 1) & mask_) {
            std::uint64_t held = 0;
            if (AtomicRef(buckets_[i]).compare_exchange(held, own)) break;
            const Found found = unpack(held);
            if (held >> 32 == hash && key_of(found.list, found.index) == key) return found;
        }
        if (list == List::fresh) {
            const std::uint64_t bit = hash >> filter_shift_;
            AtomicRef(filter_[bit / 64]).set_bits(std::uint64_t{1} << bit % 64);
        }
        return {list, Found::none};
    }
    /// Whether a fresh entry has this key. Must not run at the same time as enter().
    template <class KeyOf>
    [[nodiscard]] bool is_fresh(std::uint64_t key, const KeyOf& key_of) const
    {
        const std::uint64_t hash = hash_of(key), bit = hash >> filter_shift_;
        if ((filter_[bit / 64] >> bit % 64 & 1) == 0) return false;
        for (std::size_t i = place_of(hash); buckets_[i] != 0; i = (i + 1) & mask_) {
            const Found found = unpack(buckets_[i]);
            if (buckets_[i] >> 32 == hash && found.list == List::fresh &&
                key_of(found.list, found.index) == key)
                return true;
        }
        return false;
    }

  private:
    // A bucket holds 32 bits of the key's hash, never all zero, above the index and its list. Zero is an empty bucket.
    // Because hashes are compared first, a probe that passes other keys seldom has to fetch them.
    static std::uint64_t hash_of(std::uint64_t key)
    {
        return (key ^ key >> 32) * 0x9E3779B97F4A7C15ULL >> 32 | 1;
    }
    static Found unpack(std::uint64_t bucket)
    {
        return {static_cast<List>(bucket & 1), static_cast<std::uint32_t>(bucket) >> 1};
    }
    [[nodiscard]] std::size_t place_of(std::uint64_t hash) const { return hash >> shift_; }

    AlignedVector<std::uint64_t> buckets_;  ///< the first mask_ + 1 are in use
    AlignedVector<std::uint64_t> filter_;   ///< the bit at the leading hash bits of each fresh key is set
    std::size_t mask_ = 0;
    int shift_ = 32, filter_shift_ = 32;
};

}  // namespace motley
