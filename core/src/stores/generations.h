// Generations of slots: they tell the handles of what is in a slot now from those of what was there before, and from those of
// another scene.
#pragma once

#include <cstdint>

namespace motley {

/// The generation of a slot that is used for the first time, in the scene that was made after so many others. Each scene begins
/// the golden ratio of 2^31 beyond the one before it, so that the beginnings of a thousand scenes are 970,000 apart, and those of
/// ten thousand 140,000: a handle of one is a handle of nothing in the others until a slot has been used so many times. (A rotation
/// by the golden ratio keeps its points apart best: the three-distance theorem, Sos 1958.) Below 2^31, so that slot and generation
/// fit in a signed number of 64 bits. Never 0, which is the null handle's.
constexpr std::uint32_t first_generation(std::uint32_t scenes_before)
{
    const std::uint32_t generation = (1 + scenes_before * 0x4F1BBCDDU) & 0x7FFFFFFFU;
    return generation == 0 ? 1 : generation;
}
/// That of a slot that is used again.
constexpr std::uint32_t next_generation(std::uint32_t generation)
{
    return generation == UINT32_MAX ? 1 : generation + 1;
}

}  // namespace motley
