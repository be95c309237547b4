// Allocation and clearing of the table of keys.
#include "stores/key_table.h"

#include <algorithm>

namespace motley {
namespace {

std::size_t buckets_for(std::size_t count)
{
    return std::bit_ceil(count + count / 3 + 2);
}

/// Sixteen bits for each key, so that about one in sixteen other keys finds its bit set.
std::size_t bits_for(std::size_t fresh)
{
    return std::bit_ceil(16 * fresh + 64);
}

}  // namespace

void KeyTable::reserve(std::size_t count, std::size_t fresh)
{
    buckets_.reserve(buckets_for(count));
    filter_.reserve(bits_for(fresh) / 64);
}

void KeyTable::clear(std::size_t count, std::size_t fresh)
{
    const auto empty = [](AlignedVector<std::uint64_t>& words, std::size_t wanted) {
        if (words.size() < wanted) words.resize(wanted);
        std::fill_n(words.begin(), wanted, 0);
    };
    const std::size_t buckets = buckets_for(count), bits = bits_for(fresh);
    empty(buckets_, buckets);
    empty(filter_, bits / 64);
    mask_ = buckets - 1;
    shift_ = 32 - std::countr_zero(buckets);
    filter_shift_ = 32 - std::countr_zero(bits);
}

}  // namespace motley
