// See carried_impulses.h.
#include "crowd/carried_impulses.h"

#include <cmath>
#include <utility>

#include "stores/disc_fields.h"
#include "stores/growth.h"

namespace motley {

void CarriedImpulses::begin(const SceneCore& scene)
{
    assign_with_room(heads_, scene.bodies.rows(BodyKind::planar).size(), none);
    assign_with_room(places_, scene.discs.band_count, 0);
}

/// Calls work(row, other, impulse) for each contact that pushed, and for each wall.
template <class Work>
void CarriedImpulses::for_each_kept(const DiscStore& discs, std::size_t band, const Work& work)
{
    for_each_disc_blocks(discs.bands[band], [&](auto c, const DiscBlocks& blocks) {
        using Fields = DiscFieldsOf<c.value>;
        const bool rests = &blocks == &discs.bands[band].resting[static_cast<std::size_t>(c.value)];
        for (std::size_t block = 0; block < static_cast<std::size_t>(blocks.count); ++block) {
            for (std::size_t lane = 0; lane < blocks.lanes[block]; ++lane) {
                const auto held = load_lane<typename Fields::Impulse>(blocks.impulses.data(), block, lane);
                Impulse impulse{held.normal, 0, 0};
                if constexpr (is_rough(c.value)) impulse.tangent = held.tangent;
                if (rests) {
                    const auto sum = load_lane<typename Fields::Impulse>(blocks.sums.data(), block, lane);
                    impulse.step_normal = sum.normal;
                    if constexpr (is_rough(c.value)) impulse.step_tangent = sum.tangent;
                }
                // Not finite where a body had to be contained.
                if (!std::isfinite(impulse.normal) || !std::isfinite(impulse.tangent)) impulse = {};
                constexpr std::int32_t a_row = offsets_a_row(BodyKind::planar);
                const auto b = static_cast<std::uint32_t>(blocks.bodies[block].b[lane] / a_row);
                if (discs.is_forgotten_row(b)) continue;
                if constexpr (is_wall(c.value)) {
                    const WallTouch& touch = blocks.touches[block_lanes * block + lane];
                    if (touch.segment == UINT32_MAX) continue;
                    impulse.side = touch.side;
                    work(b, wall_bit | touch.segment, impulse);
                } else {
                    const auto a = static_cast<std::uint32_t>(blocks.bodies[block].a[lane] / a_row);
                    if ((impulse.normal > 0 || impulse.step_normal > 0) && !discs.is_forgotten_row(a))
                        work(a, b, impulse);
                }
            }
        }
    });
}

void CarriedImpulses::count(const DiscStore& discs, std::size_t band)
{
    std::uint32_t entries = 0;
    for_each_disc_blocks(discs.bands[band], [&](auto, const DiscBlocks& blocks) {
        for (std::size_t block = 0; block < static_cast<std::size_t>(blocks.count); ++block)
            entries += blocks.lanes[block];
    });
    places_[band] = entries;
}

void CarriedImpulses::open()
{
    std::uint32_t next = 0;
    for (std::uint32_t& place : places_) next += std::exchange(place, next);
    grow_to(entries_, next);
    used_ = next;
}

void CarriedImpulses::make_room(std::size_t rows, std::size_t impulses)
{
    grow_to(heads_, rows, none);
    grow_to(entries_, used_ + impulses);
}

void CarriedImpulses::keep(const DiscStore& discs, std::size_t band)
{
    std::uint32_t place = places_[band];
    for_each_kept(discs, band, [&](std::uint32_t row, std::uint32_t other, const Impulse& impulse) {
        entries_[place] = {other, heads_[row], impulse};
        heads_[row] = place++;
    });
}

}  // namespace motley
