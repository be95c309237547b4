// Contacts of discs that leave their skins between searches of all discs: see DiscFinder::find_late.
//
// What is found does not depend on the solver that finds it, only on the scene: a pair is listed already if the last
// search of all discs found it, which its places then tell, or if it is in DiscStore::late. Discs are taken in the
// order of the strips.
#include <algorithm>
#include <cmath>

#include "crowd/disc_finder.h"

namespace motley {
namespace {

/// Whether two places are nearer than `near`, m; with the arithmetic of DiscFinder::list_pairs.
bool are_near(const Vec2<double>& p, const Vec2<double>& q, float near)
{
    const double along = q.x - p.x, across = q.y - p.y, distance = static_cast<double>(near);
    return along * along + across * across < distance * distance;
}

/// Merges a sorted list into another one, from the back, in place.
void merge_into(std::vector<std::uint64_t>& all, const std::vector<std::uint64_t>& more)
{
    std::size_t left = all.size(), take = more.size();
    make_room_for(all, take);
    all.resize(left + take);
    for (std::size_t to = all.size(); take > 0;)
        all[--to] = left > 0 && all[left - 1] > more[take - 1] ? all[--left] : more[--take];
}

}  // namespace

/// Notes that the strips are those of the scene's last search of all discs.
void DiscFinder::name_search(DiscStore& discs)
{
    discs.searcher = self_;
    discs.search = ++searches_;
    places_.clear();
}

/// Makes the strips of the scene's last search of all discs, unless they are those that are there.
void DiscFinder::make_strips_of(SceneCore& scene)
{
    DiscStore& discs = scene.discs;
    if (discs.searcher != self_ || discs.search != searches_) {
        strips.restore(scene);
        place_segments(discs);
        name_search(discs);
    }
    if (workers_.empty()) workers_.resize(1);
    const std::size_t rows = scene.bodies.rows(BodyKind::planar).size();
    grow_to(is_new_, rows);
    if (!places_.empty()) return;
    places_.assign(with_room_to_grow(rows), 0);
    const std::span<const PlacedDisc> placed = strips.discs();
    for (std::size_t place = 0; place < placed.size(); ++place)
        places_[placed[place].row] = static_cast<std::uint32_t>(place);
}

bool DiscFinder::find_late(SceneCore& scene, std::span<std::uint32_t> rows, float dt)
{
    make_strips_of(scene);
    DiscStore& discs = scene.discs;
    std::sort(rows.begin(), rows.end(),
              [&](std::uint32_t a, std::uint32_t b) { return places_[a] < places_[b]; });
    fresh_.clear();
    begin_fillers(discs.bands[0], workers_[0], scene.bodies.rows(BodyKind::planar).size(), true);
    looked_at_ = 0;
    bool is_sparse = true;
    for (const std::uint32_t row : rows) {
        const std::size_t before = fresh_.size();
        find_late_of(scene, row, dt);
        is_sparse = looked_at_ <= 16 * strips.discs().size() + 4096 &&
                    fresh_.size() - before <= 2 * most_later_neighbours;
        if (!is_sparse) break;
    }
    workers_[0].finish();
    for (const std::uint32_t row : rows) is_new_[row] = 0;
    std::sort(fresh_.begin(), fresh_.end());
    merge_into(discs.late, fresh_);
    return is_sparse;
}

void DiscFinder::find_late_of(SceneCore& scene, std::uint32_t row, float dt)
{
    DiscStore& discs = scene.discs;
    const BodyRows& rows = scene.bodies.rows(BodyKind::planar);
    const float* v = &rows.velocity[std::size_t{4} * row];
    discs.anchors[row].skin = DiscStrips::skin_at(speed_of(v), dt);
    discs.place_anchor(row, rows.pose[row].position);
    is_new_[row] = 1;
    const float radius = discs.shapes[rows.slot[row]].radius;
    const Vec2<double> at = strips.to_strips(discs.anchors[row]);
    const PlacedDisc me{
        at.x, at.y, radius + discs.anchors[row].skin, radius, DiscStrips::inverse_mass_of(scene, row), row};
    const Vec2<double> drift = at - strips.to_strips(discs.found_at[row]);
    discs.late_drift = std::max(discs.late_drift, static_cast<float>(1.001 * std::sqrt(dot(drift, drift))));
    discs.late_reach = std::max(discs.late_reach, me.reach);
    find_late_pairs(scene, me);
    find_late_walls(scene, me);
}

bool DiscFinder::is_listed(const DiscStore& discs, std::uint64_t key, bool may_be_fresh) const
{
    return std::binary_search(discs.late.begin(), discs.late.end(), key) ||
           (may_be_fresh && std::find(fresh_.begin(), fresh_.end(), key) != fresh_.end());
}

void DiscFinder::find_late_pairs(SceneCore& scene, const PlacedDisc& me)
{
    DiscStore& discs = scene.discs;
    const DiscAnchor& was = discs.found_at[me.row];
    const auto try_pair = [&](const PlacedDisc& placed) {
        ++looked_at_;
        if (placed.row == me.row) return;
        const DiscAnchor& anchor = discs.anchors[placed.row];
        const Vec2<double> at = strips.to_strips(anchor);
        const float reach = placed.radius + anchor.skin;
        if (!are_near({me.along, me.across}, at, reach + me.reach)) return;
        if (are_near(strips.to_strips(was), {placed.along, placed.across},
                     placed.reach + (me.radius + was.skin)))
            return;
        const std::uint64_t key = late_key(me.row, placed.row);
        if (is_listed(discs, key, is_new_[placed.row] != 0)) return;
        fresh_.push_back(key);
        const PlacedDisc other{at.x, at.y, reach, placed.radius, placed.inverse_mass, placed.row};
        add_pair(scene, discs.bands[0], workers_[0], me, other, {}, me.row, other.row);
    };
    const double reach = static_cast<double>(me.reach) + static_cast<double>(discs.late_drift) +
                         static_cast<double>(std::max(strips.most_reach(), discs.late_reach));
    for (std::int32_t s = strips.strip_at(me.across - reach); s <= strips.strip_at(me.across + reach); ++s)
        strips.for_each_between(s, me.along - reach, me.along + reach, try_pair);
    for (const PlacedDisc& disc : strips.wide()) try_pair(disc);
}

void DiscFinder::find_late_walls(SceneCore& scene, const PlacedDisc& me)
{
    DiscStore& discs = scene.discs;
    if (discs.segments.empty()) return;
    const DiscAnchor& was = discs.found_at[me.row];
    const Vec2<double> then = strips.to_strips(was);
    const PlacedDisc before{then.x, then.y, me.radius + was.skin, me.radius, me.inverse_mass, me.row};
    const double reach = static_cast<double>(me.reach) + static_cast<double>(discs.wall_skin);
    const std::size_t last = band_of(strips.strip_at(me.across + reach));
    for (std::size_t band = band_of(strips.strip_at(me.across - reach)); band <= last; ++band) {
        for (const PlacedSegment& segment : segments_[band]) {
            if (!is_near(discs, segment, me) || is_near(discs, segment, before)) continue;
            const std::uint64_t key = late_wall_key(me.row, segment.index);
            if (is_listed(discs, key, true)) continue;
            fresh_.push_back(key);
            add_touch(scene, discs.bands[0], workers_[0], segment, me, {}, me.row);
        }
    }
}

std::size_t DiscFinder::band_of(std::int32_t strip) const
{
    std::int32_t band = 0, end = strips.band_count();
    while (end - band > 1) {
        const std::int32_t middle = band + (end - band) / 2;
        (strips.first_strip(middle) <= strip ? band : end) = middle;
    }
    return static_cast<std::size_t>(band) + 1;
}

}  // namespace motley
