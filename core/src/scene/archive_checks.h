// How a scene that was read from a file is refused: the checksum detects accidents, these checks everything else.
#pragma once

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>

#include "stores/array.h"

namespace motley {

inline void demand(bool holds, const char* what)
{
    if (!holds) throw std::runtime_error(std::string("is no scene: ") + what);
}

/// A list of free handles or rows: each index must be valid, not taken, and listed only once.
template <class IsTaken>
void check_free_list(const Array<std::uint32_t>& free, std::size_t size, const IsTaken& is_taken,
                     const char* what)
{
    Array<std::uint8_t> listed(size, 0);
    for (const std::uint32_t one : free) {
        demand(one > 0 && one < size && !is_taken(one) && listed[one] == 0, what);
        listed[one] = 1;
    }
}

}  // namespace motley
