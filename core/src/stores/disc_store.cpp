// See disc_store.h.
#include "stores/disc_store.h"

#include "stores/disc_fields.h"
#include "stores/generations.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace motley {
namespace {

bool is_filtered(const DiscShape& shape)
{
    return shape.category != 1 || shape.mask != UINT32_MAX;
}

}  // namespace

void DiscStore::set_shape(std::uint32_t slot, const DiscShape& shape)
{
    DiscShape& own = shapes[slot];
    count_shape(own, SIZE_MAX);  // one less
    own = shape;
    count_shape(own, 1);
    is_stale = true;
}

void DiscStore::count_shape(const DiscShape& shape, std::size_t one)
{
    if (shape.radius == 0) return;
    count += one;
    rough_discs += shape.friction > 0 ? one : 0;
    filtered_discs += is_filtered(shape) ? one : 0;
}

void DiscStore::derive()
{
    count = rough_discs = filtered_discs = 0;
    for (const DiscShape& shape : shapes) count_shape(shape, 1);
}

void DiscStore::remove_segments_of(std::uint32_t wall)
{
    Array<std::uint32_t> moved(segments.size(), UINT32_MAX);
    std::uint32_t left = 0;
    for (std::size_t i = 0; i < segments.size(); ++i) {
        if (segments[i].wall == wall) continue;
        moved[i] = left;
        segments[left++] = segments[i];
    }
    segments.resize(left);
    is_torn = false;
    for (std::size_t band = 0; band < band_count; ++band) {
        for_each_disc_blocks(bands[band], [&](auto, DiscBlocks& blocks) {
            for (WallTouch& touch : blocks.touches)
                touch.segment = touch.segment < moved.size() ? moved[touch.segment] : UINT32_MAX;
        });
    }
    is_stale = true;
}

void DiscStore::remove_wall(std::uint32_t slot)
{
    remove_segments_of(slot);
    walls[slot].live = 0;
    walls[slot].generation = next_generation(walls[slot].generation);
    free_walls.push_back(slot);
}

void DiscStore::forget_row(std::uint32_t row)
{
    if (row < anchors.size() && !is_removed_row(row)) anchors[row].skin = forgotten_skin;
    is_stale = true;
    is_torn = false;
}

void DiscStore::forget_removed_row(std::uint32_t row)
{
    if (row < anchors.size()) anchors[row].skin = removed_skin;
    is_stale = true;
    is_torn = false;
}

void DiscStore::renumber(std::span<const std::uint32_t> new_rows)
{
    if (anchors.empty()) return;
    for (AlignedVector<DiscAnchor>* places : {&anchors, &found_at}) {
        AlignedVector<DiscAnchor> moved(places->size(), DiscAnchor{0, 0, INFINITY});
        for (std::size_t row = 1; row < std::min(new_rows.size(), places->size()); ++row) {
            if (new_rows[row] != 0) moved[new_rows[row]] = (*places)[row];
        }
        *places = std::move(moved);
    }
    renumber_contacts(new_rows);
    rows_by_place.clear();
    wants_sorting = false;
}

void DiscStore::renumber_contacts(std::span<const std::uint32_t> new_rows)
{
    for (std::uint64_t& key : late) {
        const auto row_a = static_cast<std::uint32_t>(key >> 32), row_b = static_cast<std::uint32_t>(key);
        key = (key >> 63) != 0 ? key - row_b + new_rows[row_b] : late_key(new_rows[row_a], new_rows[row_b]);
    }
    std::sort(late.begin(), late.end());
    searcher.reset();
    is_torn = false;
    constexpr std::int32_t a_row = offsets_a_row(BodyKind::planar);
    const auto renumber_offset = [&](std::int32_t& offset) {
        offset = static_cast<std::int32_t>(new_rows[static_cast<std::size_t>(offset / a_row)]) * a_row;
    };
    for (std::size_t band = 0; band < band_count; ++band) {
        for_each_disc_blocks(bands[band], [&](auto c, DiscBlocks& blocks) {
            for (std::size_t block = 0; block < static_cast<std::size_t>(blocks.count); ++block) {
                for (std::size_t lane = 0; lane < blocks.lanes[block]; ++lane) {
                    renumber_offset(blocks.bodies[block].b[lane]);
                    if (!is_wall(c.value)) renumber_offset(blocks.bodies[block].a[lane]);
                }
            }
        });
    }
}

}  // namespace motley
