// Where the fields of a disc contact lie: field f of lane l of block b at 16 (fields b + f) + l of its stream.
#pragma once

#include <cstddef>

#include "maths/disc_contact.h"
#include "stores/disc_store.h"

namespace motley {

template <DiscClass c>
struct DiscFieldsOf {
    using Kind = DiscContactKind<is_rough(c)>;
    static constexpr BodyKind kind_a = is_wall(c) ? BodyKind::fixed : BodyKind::planar;
    using Row = typename Kind::template Row<float, kind_a, BodyKind::planar>;
    using Impulse = typename Kind::template Impulse<float, kind_a, BodyKind::planar>;
    static constexpr int row_floats = sizeof(Row) / sizeof(float);
    static constexpr int impulse_floats = sizeof(Impulse) / sizeof(float);
};

/// Calls work(std::integral_constant<DiscClass, c>) for every class.
template <class Work>
void for_each_disc_class(const Work& work)
{
    work(std::integral_constant<DiscClass, DiscClass::smooth_pair>{});
    work(std::integral_constant<DiscClass, DiscClass::rough_pair>{});
    work(std::integral_constant<DiscClass, DiscClass::smooth_wall>{});
    work(std::integral_constant<DiscClass, DiscClass::rough_wall>{});
}
/// The same for the class `c` alone.
template <class Work>
void with_disc_class(DiscClass c, const Work& work)
{
    for_each_disc_class([&](auto each) {
        if (each.value == c) work(each);
    });
}
/// Calls work(class, blocks) for the blocks of a band that are solved, then for those of bodies that sleep.
template <class Band, class Work>
void for_each_disc_blocks(Band& band, const Work& work)
{
    for_each_disc_class([&](auto c) { work(c, band.blocks[static_cast<std::size_t>(c.value)]); });
    for_each_disc_class([&](auto c) { work(c, band.resting[static_cast<std::size_t>(c.value)]); });
}

/// Calls work(class, blocks) for the blocks of all bands that are solved.
template <class Discs, class Work>
void for_each_solved_blocks(Discs& discs, const Work& work)
{
    for (std::size_t band = 0; band < discs.band_count; ++band)
        for_each_disc_class(
            [&](auto c) { work(c, discs.bands[band].blocks[static_cast<std::size_t>(c.value)]); });
}

/// The floats of a lane of a block as a struct of floats, field by field.
template <class Struct>
Struct load_lane(const float* stream, std::size_t block, std::size_t lane)
{
    constexpr std::size_t fields = sizeof(Struct) / sizeof(float);
    Struct value;
    auto* to = reinterpret_cast<float*>(&value);
    for (std::size_t f = 0; f < fields; ++f) to[f] = stream[block_lanes * (fields * block + f) + lane];
    return value;
}
template <class Struct>
void store_lane(const Struct& value, float* stream, std::size_t block, std::size_t lane)
{
    constexpr std::size_t fields = sizeof(Struct) / sizeof(float);
    const auto* from = reinterpret_cast<const float*>(&value);
    for (std::size_t f = 0; f < fields; ++f) stream[block_lanes * (fields * block + f) + lane] = from[f];
}

/// Calls work(block, lane) for each lane that is not padding.
template <class Work>
void for_each_lane(const DiscBlocks& blocks, const Work& work)
{
    for (std::size_t block = 0; block < static_cast<std::size_t>(blocks.count); ++block) {
        for (std::size_t lane = 0; lane < blocks.lanes[block]; ++lane) work(block, lane);
    }
}

}  // namespace motley
