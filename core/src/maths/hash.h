// Hashes of bits: of states, to compare runs, and of files, to find what was damaged.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

namespace motley {

/// One round of a multiply-xorshift hash: every bit of the state moves about half of the result.
inline std::uint64_t mix(std::uint64_t hash, std::uint64_t value)
{
    hash ^= value + 0x9E3779B97F4A7C15ULL + (hash << 6) + (hash >> 2);
    hash *= 0xFF51AFD7ED558CCDULL;
    return hash ^ (hash >> 33);
}

/// Of numbers of at most 8 bytes each.
template <class T>
std::uint64_t hash_bytes(std::uint64_t hash, const T* values, std::size_t count)
{
    for (std::size_t i = 0; i < count; ++i) {
        std::uint64_t bits = 0;
        std::memcpy(&bits, &values[i], sizeof(T));
        hash = mix(hash, bits);
    }
    return hash;
}

}  // namespace motley
