// Contacts of discs that leave their skins between searches of all discs: see DiscFinder::begin_late.
//
// A pair is listed already if the last search of all discs found it, which its places then tell, or if it is in
// DiscStore::late. Like those of that search, a contact belongs to the lower of the bands in which its discs were then,
// or to band 0 if one of them reaches far. Discs are taken in the order of the strips.
#include <algorithm>
#include <cmath>

#include "crowd/disc_finder.h"
#include "stores/array.h"
#include "stores/disc_fields.h"
#include "stores/growth.h"

namespace motley {
namespace {

/// Whether two places are nearer than `near`, m; with the arithmetic of DiscFinder::list_pairs.
bool are_near(const Vec2<double>& p, const Vec2<double>& q, float near)
{
    const double along = q.x - p.x, across = q.y - p.y, distance = static_cast<double>(near);
    return along * along + across * across < distance * distance;
}

/// Merges a sorted list into another one, from the back, in place.
void merge_into(Array<std::uint64_t>& all, const Array<std::uint64_t>& more)
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
    const std::size_t rows = scene.bodies.rows(BodyKind::planar).size();
    grow_to(renewed_in_, rows);
    if (!places_.empty()) return;
    places_.assign(with_room_to_grow(rows), 0);
    const std::span<const PlacedDisc> placed = strips.discs();
    for (std::size_t place = 0; place < placed.size(); ++place)
        places_[placed[place].row] = static_cast<std::uint32_t>(place);
}

void DiscFinder::begin_late(SceneCore& scene, std::span<const std::uint32_t> rows, float dt)
{
    make_strips_of(scene);
    const DiscStore& discs = scene.discs;
    resize_with_room(leaving_, rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) leaving_[i] = {places_[rows[i]], rows[i]};
    std::sort(leaving_.begin(), leaving_.end(),
              [](const Leaving& p, const Leaving& q) { return p.place < q.place; });
    cut_leaving_into_bands(discs);
    ++late_call_;
    late_room = INFINITY;
    for (std::size_t band = 0; band < discs.band_count; ++band) {
        for (std::size_t i = late_[band].first; i < late_[band].last; ++i)
            renew(scene, leaving_[i].row, band, dt);
    }
}

void DiscFinder::cut_leaving_into_bands(const DiscStore& discs)
{
    if (late_.size() < discs.band_count) late_.resize(discs.band_count);
    std::size_t next = 0;
    const auto take_below = [&](LateList& list, std::uint32_t end) {
        list.first = next;
        while (next < leaving_.size() && leaving_[next].place < end) ++next;
        list.last = next;
    };
    for (std::size_t band = 1; band < discs.band_count; ++band)
        take_below(late_[band], strips.first_place(band + 1));
    take_below(late_[0], UINT32_MAX);
    // Each list gets the room of the longest, so that a step to come seldom allocates.
    std::size_t room = 64;
    for (const LateList& list : late_) room = std::max(room, list.contacts.capacity());
    for (std::size_t band = 0; band < discs.band_count; ++band) {
        late_[band].contacts.clear();
        late_[band].contacts.reserve(room);
        late_[band].has_wide = false;
        late_[band].is_sparse = true;
    }
}

/// Gives a disc of a band a new anchor and skin.
void DiscFinder::renew(SceneCore& scene, std::uint32_t row, std::size_t band, float dt)
{
    DiscStore& discs = scene.discs;
    const BodyRows& rows = scene.bodies.rows(BodyKind::planar);
    discs.anchors[row].skin = strips.late_skin(speed_of(&rows.velocity[std::size_t{4} * row]), dt,
                                               discs.shapes[rows.slot[row]].radius);
    discs.place_anchor(row, rows.pose[row].position);
    renewed_in_[row] = late_call_;
    const PlacedDisc me = place_now(scene, row);
    const Vec2<double> drift = Vec2<double>{me.along, me.across} - strips.to_strips(discs.found_at[row]);
    discs.late_drift = std::max(discs.late_drift, static_cast<float>(1.001 * std::sqrt(dot(drift, drift))));
    discs.late_reach = std::max(discs.late_reach, me.reach);
    if (band == 0) return;
    const std::size_t last = discs.band_count - 1;
    const auto low_edge = [&](std::size_t of) {
        return strips.low_edge_of(strips.first_strip(static_cast<std::int32_t>(of) - 1));
    };
    const auto reach = static_cast<double>(me.reach);
    if (band > 2) late_room = std::min(late_room, me.across - reach - low_edge(band - 1));
    if (band + 1 < last) late_room = std::min(late_room, low_edge(band + 2) - (me.across + reach));
}

/// A disc where its anchor is now.
PlacedDisc DiscFinder::place_now(const SceneCore& scene, std::uint32_t row) const
{
    const DiscStore& discs = scene.discs;
    const DiscAnchor& anchor = discs.anchors[row];
    const float radius = discs.shapes[scene.bodies.rows(BodyKind::planar).slot[row]].radius;
    const Vec2<double> at = strips.to_strips(anchor);
    return {at.x, at.y, radius + anchor.skin, radius, DiscStrips::inverse_mass_of(scene, row), row};
}

void DiscFinder::list_late(const SceneCore& scene, std::size_t band)
{
    LateList& list = late_[band];
    // Of people on one spot each would look at all others.
    const std::size_t most_looks = 16 * numbers_of(scene, band) + 4096;
    std::size_t looks = 0;
    for (std::size_t i = list.first; i < list.last && list.is_sparse; ++i) {
        const PlacedDisc me = place_now(scene, leaving_[i].row);
        const std::size_t before = list.contacts.size();
        looks += list_late_pairs(scene, me, band, list);
        list_late_walls(scene, me, band, list);
        list.is_sparse = looks <= most_looks && list.contacts.size() - before <= 2 * most_later_neighbours;
    }
}

/// Returns how many discs it looked at.
std::size_t DiscFinder::list_late_pairs(const SceneCore& scene, const PlacedDisc& me, std::size_t band,
                                        LateList& list)
{
    const DiscStore& discs = scene.discs;
    const DiscAnchor& was = discs.found_at[me.row];
    std::size_t looks = 0;
    const auto try_pair = [&](const PlacedDisc& placed, std::size_t owner) {
        ++looks;
        if (placed.row == me.row) return;
        const DiscAnchor& anchor = discs.anchors[placed.row];
        if (!are_near({me.along, me.across}, strips.to_strips(anchor),
                      placed.radius + anchor.skin + me.reach))
            return;
        // Of two that left, the first one lists the pair.
        if (renewed_in_[placed.row] == late_call_ && places_[placed.row] < places_[me.row]) return;
        if (are_near(strips.to_strips(was), {placed.along, placed.across},
                     placed.reach + (me.radius + was.skin)))
            return;
        if (std::binary_search(discs.late.begin(), discs.late.end(), late_key(me.row, placed.row))) return;
        list.contacts.push_back({me.row, placed.row, static_cast<std::uint32_t>(owner), false});
        list.has_wide = list.has_wide || owner == 0;
    };
    const double reach = static_cast<double>(me.reach) + static_cast<double>(discs.late_drift) +
                         static_cast<double>(std::max(strips.most_reach(), discs.late_reach));
    for (std::int32_t s = strips.strip_at(me.across - reach); s <= strips.strip_at(me.across + reach); ++s) {
        const std::size_t owner = std::min(band, strips.band_of(s));
        strips.for_each_between(s, me.along - reach, me.along + reach,
                                [&](const PlacedDisc& placed) { try_pair(placed, owner); });
    }
    for (const PlacedDisc& disc : strips.wide()) try_pair(disc, 0);
    return looks;
}

void DiscFinder::list_late_walls(const SceneCore& scene, const PlacedDisc& me, std::size_t band,
                                 LateList& list)
{
    const DiscStore& discs = scene.discs;
    if (discs.segments.empty()) return;
    const DiscAnchor& was = discs.found_at[me.row];
    const Vec2<double> then = strips.to_strips(was);
    const PlacedDisc before{then.x, then.y, me.radius + was.skin, me.radius, me.inverse_mass, me.row};
    const double reach = static_cast<double>(me.reach) + static_cast<double>(discs.wall_skin);
    const auto own = static_cast<std::ptrdiff_t>(list.contacts.size());
    const std::size_t last = strips.band_of(strips.strip_at(me.across + reach));
    for (std::size_t near = strips.band_of(strips.strip_at(me.across - reach)); near <= last; ++near) {
        for (const PlacedSegment& segment : segments_[near]) {
            if (!is_near(discs, segment, me) || is_near(discs, segment, before)) continue;
            const std::uint64_t key = late_wall_key(me.row, segment.index);
            if (std::binary_search(discs.late.begin(), discs.late.end(), key)) continue;
            // A segment may be near several bands.
            if (std::any_of(list.contacts.begin() + own, list.contacts.end(),
                            [&](const LateContact& contact) { return contact.b == segment.index; }))
                continue;
            list.contacts.push_back({me.row, segment.index, static_cast<std::uint32_t>(band), true});
            list.has_wide = list.has_wide || band == 0;
        }
    }
}

bool DiscFinder::add_late(SceneCore& scene, std::size_t band, int worker)
{
    Worker& own = workers_[static_cast<std::size_t>(worker)];
    DiscBand& found = scene.discs.bands[band];
    const std::size_t bodies =
        band == 0 ? scene.bodies.rows(BodyKind::planar).size() : numbers_of(scene, band);
    const BodyNumbers numbers =
        band == 0 ? BodyNumbers{} : BodyNumbers{places_.data(), strips.first_place(band)};
    bool is_begun = false;
    const auto add_of = [&](const LateList& list) {
        for (const LateContact& contact : list.contacts) {
            if (contact.band != band) continue;
            if (!is_begun) go_on_with_fillers(found, own, bodies, numbers);
            is_begun = true;
            const PlacedDisc a = place_now(scene, contact.a);
            if (contact.is_wall) {
                const PlacedSegment segment = place_segment(scene.discs, contact.b);
                add_touch(scene, found, own, segment, a, {}, numbers.of(contact.a));
            } else {
                add_pair(scene, found, own, a, place_now(scene, contact.b), {}, numbers.of(contact.a),
                         numbers.of(contact.b));
            }
        }
    };
    if (band == 0) {
        for (std::size_t of = 0; of < scene.discs.band_count; ++of) {
            if (late_[of].has_wide) add_of(late_[of]);
        }
    } else {
        add_of(late_[band]);
        if (band + 1 < scene.discs.band_count) add_of(late_[band + 1]);
    }
    if (is_begun) own.finish();
    return is_begun;
}

/// Continues the blocks of a band.
void DiscFinder::go_on_with_fillers(DiscBand& found, Worker& worker, std::size_t bodies,
                                    const BodyNumbers& numbers)
{
    for_each_disc_class([&](auto c) {
        using Fields = DiscFieldsOf<c.value>;
        const auto i = static_cast<std::size_t>(c.value);
        worker.fillers[i].go_on(found.blocks[i], Fields::row_floats, Fields::impulse_floats, bodies, numbers,
                                is_wall(c.value));
        worker.resting_fillers[i].go_on(found.resting[i], Fields::row_floats, Fields::impulse_floats, bodies,
                                        numbers, is_wall(c.value));
    });
}

void DiscFinder::end_late(DiscStore& discs, std::size_t first, std::size_t last)
{
    fresh_.clear();
    for (std::size_t band = 0; band < discs.band_count; ++band) {
        for (const LateContact& contact : late_[band].contacts) {
            if (contact.band == 0 || (contact.band >= first && contact.band < last))
                fresh_.push_back(contact.key());
        }
    }
    std::sort(fresh_.begin(), fresh_.end());
    merge_into(discs.late, fresh_);
}

}  // namespace motley
