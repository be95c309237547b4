// See disc_pipeline.h.
#include "disc_pipeline.h"

#include <algorithm>
#include <cmath>

#include "scene/wall_ends.h"

namespace motley {
namespace {

/// The most steps from one search of all discs to the next.
constexpr int longest_age = 20;
/// m: a disc that may come so near the end of its skin is searched for anew. It allows for the speed that a disc gains
/// within a step.
constexpr double slack = 0.005;

}  // namespace

void DiscPipeline::find(SceneCore& scene, float dt)
{
    DiscStore& discs = scene.discs;
    if (!discs.is_in_use()) {
        discs.band_count = 0;
        discs.wants_sorting = false;
        return;
    }
    find_wall_ends(scene, wall_ends_);
    if (!discs.is_stale && !is_anyone_awake(scene)) return;
    if (discs.steps_since_sorting < DiscStore::least_steps_between_sortings) ++discs.steps_since_sorting;
    if (!discs.is_stale && ++discs.age < longest_age && !have_walls_left(scene, dt)) {
        list_leaving(scene, dt);
        // A few are searched for one by one; of many, all.
        const std::size_t few = discs.count / 16 + 8;
        if (leaving_.size() <= few && discs.late.size() + 4 * leaving_.size() <= discs.count / 2 + 64) {
            if (leaving_.empty()) return;
            discs.is_stale = true;
            if (find_late(scene, dt)) {
                discs.is_stale = false;
                return;
            }
        }
    }
    // Should memory run out on the way, the next step searches again.
    discs.is_stale = true;
    if (!finder_.has_impulses_of(discs)) carry_impulses(scene);
    finder_.name_search(discs);
    discs.is_torn = true;
    discs.wall_skin = DiscStrips::skin_at(fastest_wall_end(scene), dt);
    discs.wall_ends = wall_ends_;
    sort_into_strips(scene, dt);
    find_contacts(scene);
    DiscFinder::make_room_for_pairs(discs);
    discs.wants_sorting = discs.steps_since_sorting == DiscStore::least_steps_between_sortings &&
                          DiscFinder::are_rows_scattered(discs);
    discs.age = 0;
    discs.is_divided = true;
    discs.is_stale = discs.is_torn = false;
}

/// Nobody has a new neighbour while all planar bodies sleep.
bool DiscPipeline::is_anyone_awake(const SceneCore& scene)
{
    const std::vector<std::uint32_t>& awake = scene.bodies.rows(BodyKind::planar).awake;
    return std::any_of(awake.begin(), awake.end(), [](std::uint32_t count) { return count > 0; });
}

void DiscPipeline::divide(SceneCore& scene)
{
    DiscStore& discs = scene.discs;
    if (discs.is_divided || !discs.is_in_use()) return;
    finder_.make_room_for_workers(runner_.workers());
    // Should memory run out on the way, the next step searches again.
    discs.is_stale = true;
    runner_.run(static_cast<std::int64_t>(discs.band_count), [&](std::int64_t band, int worker) {
        finder_.divide(scene, static_cast<std::size_t>(band), worker);
        place_resting(scene, wall_ends_, discs.bands[static_cast<std::size_t>(band)]);
    });
    discs.is_divided = true;
    discs.is_stale = false;
}

/// Whether a wall may go further in this step than the last search allowed for.
bool DiscPipeline::have_walls_left(const SceneCore& scene, float dt) const
{
    const double goes = fastest_wall_end(scene) * static_cast<double>(dt);
    for (std::size_t end = 0; end < wall_ends_.size(); ++end) {
        const Vec2<double> went = wall_ends_[end] - scene.discs.wall_ends[end];
        if (std::sqrt(dot(went, went)) + goes + slack > static_cast<double>(scene.discs.wall_skin))
            return true;
    }
    return false;
}

/// Lists the discs that may leave their skins in this step: only these may touch others that are not near them yet.
void DiscPipeline::list_leaving(const SceneCore& scene, float dt)
{
    const DiscStore& discs = scene.discs;
    const BodyRows& rows = scene.bodies.rows(BodyKind::planar);
    const double seconds = static_cast<double>(dt);
    // Bodies that were added since the last search have no disc.
    const auto size = static_cast<std::uint32_t>(std::min<std::size_t>(rows.size(), discs.anchors.size()));
    const std::int64_t chunks = disc_chunks(size);
    if (leaving_of_.size() < static_cast<std::size_t>(chunks))
        leaving_of_.resize(static_cast<std::size_t>(chunks));
    runner_.run(chunks, [&](std::int64_t chunk) {
        std::vector<std::uint32_t>& leaving = leaving_of_[static_cast<std::size_t>(chunk)];
        leaving.clear();
        if (!rows.is_chunk_awake(chunk)) return;
        for_each_row_of_chunk(chunk, size, [&](std::uint32_t row) {
            const DiscAnchor& anchor = discs.anchors[row];
            const Vec3<PoseReal>& at = rows.pose[row].position;
            const double x = static_cast<double>(at.x) - discs.frame.origin.x - static_cast<double>(anchor.x);
            const double y = static_cast<double>(at.y) - discs.frame.origin.y - static_cast<double>(anchor.y);
            const double speed = speed_of(&rows.velocity[std::size_t{4} * row]);
            const double goes = std::sqrt(x * x + y * y) + seconds * speed + slack;
            if (!(goes <= static_cast<double>(anchor.skin))) leaving.push_back(row);
        });
    });
    leaving_.clear();
    for (std::int64_t chunk = 0; chunk < chunks; ++chunk) {
        const std::vector<std::uint32_t>& leaving = leaving_of_[static_cast<std::size_t>(chunk)];
        leaving_.insert(leaving_.end(), leaving.begin(), leaving.end());
    }
}

/// Adds the contacts that the discs may have which leave their skins. Returns false where a search of all discs must be
/// made instead.
bool DiscPipeline::find_late(SceneCore& scene, float dt)
{
    DiscStore& discs = scene.discs;
    finder_.begin_late(scene, leaving_, dt);
    if (!finder_.are_late_near(discs)) return false;
    const auto bands = static_cast<std::int64_t>(discs.band_count);
    runner_.run(bands, [&](std::int64_t band) { finder_.list_late(scene, static_cast<std::size_t>(band)); });
    if (!finder_.are_late_sparse(discs)) return false;
    finder_.make_room_for_workers(runner_.workers());
    runner_.run(bands, [&](std::int64_t band, int worker) {
        if (finder_.add_late(scene, static_cast<std::size_t>(band), worker))
            place_resting(scene, wall_ends_, discs.bands[static_cast<std::size_t>(band)]);
    });
    finder_.end_late(discs);
    return true;
}

void DiscPipeline::carry_impulses(SceneCore& scene)
{
    CarriedImpulses& carried = finder_.carried;
    const DiscStore& discs = scene.discs;
    carried.begin(scene);
    const auto bands = static_cast<std::int64_t>(discs.band_count);
    runner_.run(bands, [&](std::int64_t band) { carried.count(discs, static_cast<std::size_t>(band)); });
    carried.open();
    if (bands == 0) return;
    carried.keep(discs, 0);
    runner_.run(bands - 1,
                [&](std::int64_t band) { carried.keep(discs, static_cast<std::size_t>(band) + 1); });
}

void DiscPipeline::sort_into_strips(SceneCore& scene, float dt)
{
    DiscStrips& strips = finder_.strips;
    DiscStore& discs = scene.discs;
    strips.begin(scene, dt);
    const std::int64_t chunks = strips.chunk_count();
    runner_.run(chunks, [&](std::int64_t chunk) { strips.measure(scene, discs, chunk); });
    strips.choose(discs);
    runner_.run(chunks, [&](std::int64_t chunk) {
        strips.anchor(scene, chunk);
        strips.count(scene, chunk);
    });
    strips.open();
    runner_.run(chunks, [&](std::int64_t chunk) { strips.place(scene, chunk); });
    runner_.run(strips.group_count() + 1, [&](std::int64_t group) { strips.sort(scene, group); });
    strips.divide();
}

void DiscPipeline::find_contacts(SceneCore& scene)
{
    finder_.open(scene, runner_.workers());
    runner_.run(static_cast<std::int64_t>(scene.discs.band_count), [&](std::int64_t band, int worker) {
        finder_.find(scene, static_cast<std::size_t>(band), worker);
        place_resting(scene, wall_ends_, scene.discs.bands[static_cast<std::size_t>(band)]);
    });
}

void DiscPipeline::prepare(SceneCore& scene)
{
    if (layout_.discs().empty()) return;
    const float warm = layout_.context.step.warm_start_scale;
    const DiscKernels& kernels = layout_.kernels().discs;
    runner_.run(layout_.disc_bands(), [&](std::int64_t band) {
        for (const SweepChunk& chunk : layout_.discs_of_band(band)) {
            if (chunk.kernels == &kernels.of(DiscClass::smooth_pair))
                kernels.prepare_smooth(layout_.context, chunk.streams, chunk.begin, chunk.end);
            if (chunk.kernels == &kernels.of(DiscClass::rough_pair))
                kernels.prepare_rough(layout_.context, chunk.streams, chunk.begin, chunk.end);
        }
        place_walls(scene, wall_ends_, warm, scene.discs.bands[static_cast<std::size_t>(band)]);
    });
}

}  // namespace motley
