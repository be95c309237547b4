// The impulses of the last step between discs and walls, out of the blocks in which they were solved.
#pragma once

#include "scene/scene_core.h"
#include "stores/disc_fields.h"

namespace motley {

/// A contact that pushed in the last step.
struct DiscImpulse {
    std::uint32_t slot_a, slot_b;  ///< of the bodies
    std::uint32_t segment;         ///< of a wall, or UINT32_MAX
    Vec2<float> normal;            ///< from a to b, when the step began
    float separation;              ///< m, likewise
    double along,
        across;  ///< N s, summed over the substeps: on b along the normal, and along it turned by +90 degrees
    [[nodiscard]] Vec2<double> on_b() const
    {
        const Vec2<double> n{static_cast<double>(normal.x), static_cast<double>(normal.y)};
        return {along * n.x - across * n.y, along * n.y + across * n.x};
    }
};

template <class Work>
void SceneCore::for_each_disc_impulse(const Work& work) const
{
    const BodyRows& planar = bodies.rows(BodyKind::planar);
    const BodyRows& fixed = bodies.rows(BodyKind::fixed);
    for (std::size_t band = 0; band < discs.band_count; ++band) {
        for_each_disc_blocks(discs.bands[band], [&](auto c, const DiscBlocks& blocks) {
            using Fields = DiscFieldsOf<c.value>;
            for (std::size_t block = 0; block < static_cast<std::size_t>(blocks.count); ++block) {
                for (std::size_t lane = 0; lane < blocks.lanes[block]; ++lane) {
                    const auto sum = load_lane<typename Fields::Impulse>(blocks.sums.data(), block, lane);
                    if (!(sum.normal > 0)) continue;
                    const auto row = load_lane<typename Fields::Row>(blocks.rows.data(), block, lane);
                    DiscImpulse impulse{};
                    const auto a = static_cast<std::size_t>(blocks.bodies[block].a[lane] /
                                                            offsets_a_row(Fields::kind_a));
                    const auto b = static_cast<std::size_t>(blocks.bodies[block].b[lane] /
                                                            offsets_a_row(BodyKind::planar));
                    impulse.slot_a = is_wall(c.value) ? fixed.slot[a] : planar.slot[a];
                    impulse.slot_b = planar.slot[b];
                    impulse.segment =
                        is_wall(c.value) ? blocks.touches[block_lanes * block + lane].segment : UINT32_MAX;
                    impulse.normal = row.in_sweep.normal;
                    impulse.separation = row.start_separation;
                    impulse.along = static_cast<double>(sum.normal);
                    if constexpr (is_rough(c.value)) impulse.across = static_cast<double>(sum.tangent);
                    // Bodies and walls may have been removed since, and others may have taken their rows.
                    if (impulse.slot_a == 0 || impulse.slot_b == 0 || discs.is_removed_row(b)) continue;
                    if (is_wall(c.value) ? impulse.segment == UINT32_MAX : discs.is_removed_row(a)) continue;
                    work(impulse);
                }
            }
        });
    }
}

}  // namespace motley
