// Moves elements in place.
#pragma once

#include <cstdint>
#include <span>
#include <utility>

namespace motley {

/// Moves element i to new_places[i] by swap(i, j), which swaps two elements. `new_places` is a permutation; afterwards it
/// is the identity.
template <class Swap>
void permute(std::span<std::uint32_t> new_places, const Swap& swap)
{
    for (std::uint32_t i = 0; i < new_places.size(); ++i) {
        while (new_places[i] != i) {
            const std::uint32_t j = new_places[i];
            swap(i, j);
            std::swap(new_places[i], new_places[j]);
        }
    }
}

}  // namespace motley
