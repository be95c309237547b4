// See disc_pipeline.h.
#include "disc_pipeline.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "scene/wall_ends.h"
#include "stores/array.h"

namespace motley {
namespace {

/// The most steps from one search of all discs to the next.
constexpr int longest_age = 20;
/// m: a disc that may come so near the end of its skin is searched for anew. It allows for the speed that a disc gains
/// within a step.
constexpr double slack = 0.005;

/// Whether a disc may leave its skin in a step of `dt`, s: whether the way that it has gone since the last search, and the way that
/// it goes in the step at its speed, are longer together than the skin.
bool may_leave(const DiscStore& discs, const BodyRows& rows, std::uint32_t row, float dt)
{
    const DiscAnchor& anchor = discs.anchors[row];
    const Vec3<PoseReal>& at = rows.pose[row].position;
    const double x = static_cast<double>(at.x) - discs.frame.origin.x - static_cast<double>(anchor.x);
    const double y = static_cast<double>(at.y) - discs.frame.origin.y - static_cast<double>(anchor.y);
    const float* const v = &rows.velocity[std::size_t{4} * row];
    const double step_x = static_cast<double>(dt) * static_cast<double>(v[0]),
                 step_y = static_cast<double>(dt) * static_cast<double>(v[1]);
    const double gone2 = x * x + y * y, step2 = step_x * step_x + step_y * step_y,
                 room = static_cast<double>(anchor.skin) - slack;
    // gone + step <= room without roots: 2 gone step <= room^2 - gone^2 - step^2, of which the right side is not negative. Without
    // branches, because they would often be mispredicted. No comparison is true of a state that is no number: such a disc may leave.
    const double left = room * room - gone2 - step2;
    const int stays = static_cast<int>(room >= 0) & static_cast<int>(left >= 0) &
                      static_cast<int>(4 * gone2 * step2 <= left * left);
    return stays == 0;
}

}  // namespace

void DiscPipeline::find(SceneCore& scene, float dt)
{
    DiscStore& discs = scene.discs;
    if (!discs.is_in_use() && region == nullptr) {
        discs.band_count = 0;
        discs.wants_sorting = false;
        return;
    }
    find_wall_ends(scene, wall_ends_);
    if (do_all_rest(scene)) return;
    if (discs.steps_since_sorting < DiscStore::least_steps_between_sortings) ++discs.steps_since_sorting;
    if (may_keep_contacts(scene, dt)) return;
    // Should memory run out on the way, the next step searches again.
    discs.is_stale = true;
    if (!finder_.has_impulses_of(discs)) carry_impulses(scene);
    finder_.name_search(discs);
    discs.is_torn = true;
    discs.wall_skin = DiscStrips::skin_at(fastest_wall_end(scene), dt);
    discs.wall_ends = wall_ends_;
    sort_into_strips(scene, dt);
    find_contacts(scene);
    const bool is_whole = add_those_of_fast_discs(scene, dt);
    DiscFinder::make_room_for_pairs(discs);
    discs.wants_sorting = discs.steps_since_sorting == DiscStore::least_steps_between_sortings &&
                          DiscFinder::are_rows_scattered(discs);
    discs.age = 0;
    discs.is_divided = true;
    discs.is_stale = !is_whole;
    discs.is_torn = false;
}

/// After a search of all discs: adds the contacts of fast discs, whose skins were cut so short that they leave them in this very
/// step. Returns false where people are too close together for this; then the next step must search for all again.
bool DiscPipeline::add_those_of_fast_discs(SceneCore& scene, float dt)
{
    list_leaving(scene, dt);
    return vote(scene, false).leaving == 0 || find_late(scene, dt);
}

/// Whether the contacts are those of the last step, and those that are added here.
bool DiscPipeline::may_keep_contacts(SceneCore& scene, float dt)
{
    DiscStore& discs = scene.discs;
    const bool must_search = discs.is_stale || ++discs.age >= longest_age || have_walls_left(scene, dt);
    leaving_.clear();
    if (!must_search) list_leaving(scene, dt);
    const SearchVote all = vote(scene, must_search);
    if (all.must_search) return false;
    // A few are searched for one by one; of many, all.
    const std::int64_t few = all.discs / 16 + 8;
    if (all.leaving > few || all.late + 4 * all.leaving > all.discs / 2 + 64) return false;
    if (all.leaving == 0) return true;
    discs.is_stale = true;
    if (!find_late(scene, dt)) return false;
    discs.is_stale = false;
    return true;
}

/// The votes of this region and all others.
SearchVote DiscPipeline::vote(const SceneCore& scene, bool must_search) const
{
    const DiscStore& discs = scene.discs;
    SearchVote all{static_cast<std::int64_t>(discs.count), static_cast<std::int64_t>(leaving_.size()),
                   static_cast<std::int64_t>(discs.late.size()), must_search};
    if (region == nullptr) return all;
    const Array<std::uint32_t>& slots = scene.bodies.rows(BodyKind::planar).slot;
    all.leaving = std::count_if(leaving_.begin(), leaving_.end(),
                                [&](std::uint32_t row) { return !region->is_copy(slots[row]); });
    region->agree(all);
    return all;
}

/// Nobody has a new neighbour while all planar bodies sleep.
bool DiscPipeline::do_all_rest(const SceneCore& scene) const
{
    if (region != nullptr && !region->anybody_sleeps()) return false;
    const Array<std::uint16_t>& awake = scene.bodies.rows(BodyKind::planar).awake;
    const bool all_rest_here =
        !scene.discs.is_stale &&
        std::all_of(awake.begin(), awake.end(), [](std::uint16_t rows) { return rows == 0; });
    return region == nullptr ? all_rest_here : region->is_so_everywhere(all_rest_here);
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

/// Lists the discs that may leave their skins in this step: only these may touch others that are not near them yet. Those that
/// sleep stay where they are.
void DiscPipeline::list_leaving(const SceneCore& scene, float dt)
{
    const DiscStore& discs = scene.discs;
    const BodyRows& rows = scene.bodies.rows(BodyKind::planar);
    // Bodies that were added since the last search have no disc.
    const auto size = static_cast<std::uint32_t>(std::min<std::size_t>(rows.size(), discs.anchors.size()));
    const std::int64_t chunks = disc_chunks(size);
    if (leaving_of_.size() < static_cast<std::size_t>(chunks))
        leaving_of_.resize(static_cast<std::size_t>(chunks));
    runner_.run(chunks, [&](std::int64_t chunk) {
        Array<std::uint32_t>& leaving = leaving_of_[static_cast<std::size_t>(chunk)];
        leaving.clear();
        rows.for_each_awake_row(chunk, [&](std::uint32_t row) {
            if (row < size && may_leave(discs, rows, row, dt)) leaving.push_back(row);
        });
    });
    leaving_.clear();
    for (std::int64_t chunk = 0; chunk < chunks; ++chunk) {
        const Array<std::uint32_t>& leaving = leaving_of_[static_cast<std::size_t>(chunk)];
        leaving_.insert(leaving_.end(), leaving.begin(), leaving.end());
    }
}

/// Adds the contacts that the discs may have which leave their skins. Returns false where a search of all discs must be
/// made instead.
bool DiscPipeline::find_late(SceneCore& scene, float dt)
{
    DiscStore& discs = scene.discs;
    finder_.begin_late(scene, leaving_, dt);
    if (region != nullptr) region->agree(discs.late_reach, discs.late_drift, finder_.late_room);
    if (!finder_.are_late_near(discs)) return false;
    const auto bands = static_cast<std::int64_t>(discs.band_count);
    std::atomic<bool> are_sparse{true};
    runner_.run(bands, [&](std::int64_t i) {
        const auto band = static_cast<std::size_t>(i);
        finder_.list_late(scene, band);
        if (is_own(band) && !finder_.are_late_sparse(band)) are_sparse = false;
    });
    if (region != nullptr) are_sparse = region->is_so_everywhere(are_sparse);
    if (!are_sparse) return false;
    finder_.make_room_for_workers(runner_.workers());
    runner_.run(bands, [&](std::int64_t i, int worker) {
        const auto band = static_cast<std::size_t>(i);
        if (is_own(band) && finder_.add_late(scene, band, worker))
            place_resting(scene, wall_ends_, discs.bands[band]);
    });
    if (region == nullptr) {
        finder_.end_late(discs, 1, discs.band_count);
    } else {
        finder_.end_late(discs, region->first_band(), region->last_band());
        region->list_pushed(scene, finder_.strips);
    }
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

void DiscPipeline::measure(SceneCore& scene, float dt)
{
    DiscStrips& strips = finder_.strips;
    strips.begin(scene, dt);
    runner_.run(strips.chunk_count(), [&](std::int64_t chunk) { strips.measure(scene, scene.discs, chunk); });
}

/// Divides all discs of all regions into bands, and moves people to the ranks of their bands.
void DiscPipeline::deal_out_bands(SceneCore& scene, float dt)
{
    DiscStrips& strips = finder_.strips;
    region->leave_copies_out(scene);
    measure(scene, dt);
    DiscStrips::Measured all = strips.measured();
    region->add_up(all);
    strips.choose(scene.discs, all);
    runner_.run(strips.chunk_count(), [&](std::int64_t chunk) { strips.anchor(scene, chunk); });
    const std::int64_t wide = strips.count_by_strip(scene);
    region->refuse_everywhere("discs of a crowd on several ranks that reach further than most others", wide,
                              "0");
    region->add_up(strips.discs_by_strip());
    strips.divide();
    region->move_people(scene, strips, finder_.carried);
}

void DiscPipeline::sort_into_strips(SceneCore& scene, float dt)
{
    DiscStrips& strips = finder_.strips;
    DiscStore& discs = scene.discs;
    if (region != nullptr) deal_out_bands(scene, dt);
    measure(scene, dt);
    const DiscStrips::Measured here = strips.measured();
    if (region == nullptr) strips.choose(discs, here);
    strips.make_room_for(here.discs);
    const std::int64_t chunks = strips.chunk_count();
    runner_.run(chunks, [&](std::int64_t chunk) {
        strips.anchor(scene, chunk);
        strips.count(scene, chunk);
    });
    strips.open();
    runner_.run(chunks, [&](std::int64_t chunk) { strips.place(scene, chunk); });
    runner_.run(strips.group_count() + 1, [&](std::int64_t group) { strips.sort(scene, group); });
    if (region == nullptr) strips.divide();
}

void DiscPipeline::find_contacts(SceneCore& scene)
{
    finder_.open(scene, runner_.workers());
    runner_.run(static_cast<std::int64_t>(scene.discs.band_count), [&](std::int64_t i, int worker) {
        const auto band = static_cast<std::size_t>(i);
        if (!is_own(band)) return finder_.leave(scene.discs, band);
        finder_.find(scene, band, worker);
        place_resting(scene, wall_ends_, scene.discs.bands[band]);
    });
    if (region != nullptr) region->list_pushed(scene, finder_.strips);
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
