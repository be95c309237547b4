// See disc_split.h.
#include "crowd/disc_split.h"

#include "stores/disc_fields.h"
#include "stores/growth.h"

namespace motley {
namespace {

/// How many of a contact's bodies sleep; a wall counts as one that does.
template <DiscClass c>
int sleepers_of(const SceneCore& scene, const BlockBodies& bodies, std::size_t lane)
{
    const auto sleeps = [&](std::int32_t offset) {
        return scene.bodies.is_asleep(row_at(BodyKind::planar, offset)) ? 1 : 0;
    };
    if constexpr (is_wall(c)) {
        return 1 + sleeps(bodies.b[lane]);
    } else {
        return sleeps(bodies.a[lane]) + sleeps(bodies.b[lane]);
    }
}

}  // namespace

template <DiscClass c>
void DiscSplit::take_out(const SceneCore& scene, const DiscBlocks& blocks)
{
    using Fields = DiscFieldsOf<c>;
    const auto take = [&](const auto& value) {
        const auto* const first = reinterpret_cast<const float*>(&value);
        floats_.insert(floats_.end(), first, first + sizeof value / sizeof(float));
    };
    for_each_lane(blocks, [&](std::size_t block, std::size_t lane) {
        take(load_lane<typename Fields::Row>(blocks.rows.data(), block, lane));
        take(load_lane<typename Fields::Impulse>(blocks.impulses.data(), block, lane));
        take(load_lane<typename Fields::Impulse>(blocks.sums.data(), block, lane));
        rows_.push_back(row_at(Fields::kind_a, blocks.bodies[block].a[lane]).row());
        rows_.push_back(row_at(BodyKind::planar, blocks.bodies[block].b[lane]).row());
        if constexpr (is_wall(c)) touches_.push_back(blocks.touches[block_lanes * block + lane]);
        rests_.push_back(sleepers_of<c>(scene, blocks.bodies[block], lane) == 2 ? 1 : 0);
    });
}

template <DiscClass c>
void DiscSplit::divide_class(const SceneCore& scene, DiscBand& band, BlockFiller& filler,
                             BlockFiller& resting)
{
    using Fields = DiscFieldsOf<c>;
    DiscBlocks& solved = band.blocks[static_cast<std::size_t>(c)];
    DiscBlocks& still = band.resting[static_cast<std::size_t>(c)];
    bool changes = false;
    for_each_lane(solved, [&](std::size_t block, std::size_t lane) {
        const int sleepers = sleepers_of<c>(scene, solved.bodies[block], lane);
        changes = changes || sleepers == 2;
        band.half_awake += !is_wall(c) && sleepers == 1 ? 1 : 0;
    });
    for_each_lane(still, [&](std::size_t block, std::size_t lane) {
        const int sleepers = sleepers_of<c>(scene, still.bodies[block], lane);
        changes = changes || sleepers < 2;
        band.half_awake += !is_wall(c) && sleepers == 1 ? 1 : 0;
    });
    if (!changes) return;
    floats_.clear();
    rows_.clear();
    touches_.clear();
    rests_.clear();
    take_out<c>(scene, solved);
    take_out<c>(scene, still);
    const std::size_t bodies = scene.bodies.rows(BodyKind::planar).size();
    filler.begin(solved, Fields::row_floats, Fields::impulse_floats, bodies);
    resting.begin(still, Fields::row_floats, Fields::impulse_floats, bodies);
    const float* next = floats_.data();
    const auto put = [&](std::size_t floats, AlignedVector<float>& stream, const BlockFiller::Place& at) {
        for (std::size_t f = 0; f < floats; ++f)
            stream[block_lanes * (floats * at.block + f) + at.lane] = *next++;
    };
    for (std::size_t i = 0; i < rests_.size(); ++i) {
        DiscBlocks& to = rests_[i] != 0 ? still : solved;
        const std::uint32_t a = rows_[2 * i], b = rows_[2 * i + 1];
        // First, so that every lane in use has a touch even if memory runs out.
        if constexpr (is_wall(c)) grow_to(to.touches, block_lanes * (static_cast<std::size_t>(to.count) + 1));
        const BlockFiller::Place at =
            (rests_[i] != 0 ? resting : filler).take(is_wall(c) ? BlockFiller::no_body : a, b);
        to.bodies[at.block].a[at.lane] = offset_of(BodyRow(Fields::kind_a, a));
        to.bodies[at.block].b[at.lane] = offset_of(BodyRow(BodyKind::planar, b));
        put(Fields::row_floats, to.rows, at);
        put(Fields::impulse_floats, to.impulses, at);
        put(Fields::impulse_floats, to.sums, at);
        if constexpr (is_wall(c)) {
            to.touches[block_lanes * at.block + at.lane] = touches_[i];
        }
    }
    filler.finish();
    resting.finish();
}

void DiscSplit::divide(const SceneCore& scene, DiscBand& band, Fillers& fillers, Fillers& resting_fillers)
{
    band.half_awake = 0;
    for_each_disc_class([&](auto c) {
        const auto i = static_cast<std::size_t>(c.value);
        divide_class<c.value>(scene, band, fillers[i], resting_fillers[i]);
    });
}

}  // namespace motley
