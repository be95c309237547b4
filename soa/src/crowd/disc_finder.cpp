// See disc_finder.h.
#include "crowd/disc_finder.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "motley/core/invalid_input.h"
#include "scene/wall_ends.h"
#include "stores/array.h"
#include "stores/disc_fields.h"
#include "stores/growth.h"

namespace motley {
namespace {

/// m: discs further apart than this start without the impulse that they had.
constexpr double still_touching = 0.005;

/// The range along the strips in which a segment lies between two places across them, m.
struct Range {
    double low, high;
};
Range range_within(const Vec2<double>& from, const Vec2<double>& to, double low, double high)
{
    const double rise = to.y - from.y;
    double first = 0, last = 1;
    if (std::abs(rise) > 1e-12) {
        const double s = (low - from.y) / rise, t = (high - from.y) / rise;
        first = std::clamp(std::min(s, t), 0.0, 1.0);
        last = std::clamp(std::max(s, t), 0.0, 1.0);
    }
    const double x = from.x + first * (to.x - from.x), y = from.x + last * (to.x - from.x);
    return {std::min(x, y), std::max(x, y)};
}

float friction_of(float a, float b)
{
    return a == b ? a : std::sqrt(a * b);
}

/// Sleepers keep what they bore in the step in which they fell asleep.
template <class Fields>
void keep_sum(const CarriedImpulses::Impulse& impulse, DiscBlocks& blocks, const BlockFiller::Place& at)
{
    typename Fields::Impulse sum{};
    sum.normal = impulse.step_normal;
    if constexpr (Fields::Kind::rough) sum.tangent = impulse.step_tangent;
    store_lane(sum, blocks.sums.data(), at.block, at.lane);
}

}  // namespace

void DiscFinder::divide(SceneCore& scene, std::size_t band, int worker)
{
    Worker& own = workers_[static_cast<std::size_t>(worker)];
    own.split.divide(scene, scene.discs.bands[band], own.fillers, own.resting_fillers);
}

void DiscFinder::open(SceneCore& scene, int workers)
{
    DiscStore& discs = scene.discs;
    make_room_for_workers(workers);
    discs.late.clear();
    discs.late_reach = discs.late_drift = 0;
    found_in_all_.store(0, std::memory_order_relaxed);
    const auto bands = static_cast<std::size_t>(strips.band_count()) + 1;
    if (discs.bands.size() < bands) discs.bands.resize(bands);
    discs.band_count = bands;
    place_segments(discs);
    discs.rows_by_place.resize(strips.discs().size());
    // So that sort_disc_rows() need not allocate.
    grow_to(discs.sorted_rows, scene.bodies.rows(BodyKind::planar).size());
}

void DiscFinder::make_room_for_workers(int workers)
{
    if (workers_.size() < static_cast<std::size_t>(workers))
        workers_.resize(static_cast<std::size_t>(workers));
    std::size_t pairs = 0, bodies = 0;
    for (Worker& worker : workers_) {
        pairs = std::max(pairs, worker.pairs.capacity());
        worker.for_each_filler(
            [&](const BlockFiller& filler) { bodies = std::max(bodies, filler.most_bodies()); });
    }
    for (Worker& worker : workers_) {
        worker.pairs.reserve(pairs);
        worker.for_each_filler([&](BlockFiller& filler) { filler.make_room_for(bodies); });
    }
}

/// Lists rows in the order of the strips, for places `first` to `last` - 1.
void DiscFinder::list_rows(DiscStore& discs, std::uint32_t first, std::uint32_t last) const
{
    for (std::uint32_t place = first; place < last; ++place)
        discs.rows_by_place[place] = strips.disc(place).row;
}

/// Gives a band near walls room for so many blocks of contacts with them before the first ones are found: it may get a
/// new block in a step between searches.
void DiscFinder::make_room_for_touches(DiscBand& band, std::size_t blocks)
{
    for_each_disc_class([&](auto c) {
        if constexpr (is_wall(c.value)) {
            using Fields = DiscFieldsOf<c.value>;
            DiscBlocks& own = band.blocks[static_cast<std::size_t>(c.value)];
            BlockFiller::make_room(own, Fields::row_floats, Fields::impulse_floats, blocks);
            grow_to(own.touches, block_lanes * own.lanes.size());
        }
    });
}

/// Gives every band room for a quarter more pairs than the fullest has, so that it seldom grows in a step to come.
void DiscFinder::make_room_for_pairs(DiscStore& discs)
{
    for_each_disc_class([&](auto c) {
        if constexpr (!is_wall(c.value)) {
            using Fields = DiscFieldsOf<c.value>;
            // Not as much as band 0, which has all pairs of discs that reach far.
            std::size_t most = 0;
            for (std::size_t band = 1; band < discs.band_count; ++band)
                most = std::max(most, static_cast<std::size_t>(
                                          discs.bands[band].blocks[static_cast<std::size_t>(c.value)].count));
            if (most == 0) return;
            for (std::size_t band = 0; band < discs.band_count; ++band)
                BlockFiller::make_room(discs.bands[band].blocks[static_cast<std::size_t>(c.value)],
                                       Fields::row_floats, Fields::impulse_floats,
                                       with_room_to_grow(most + 4));
        }
    });
}

/// Whether neighbours in the strips lie too far apart in memory: whether the rows of 64 discs in line are in more than
/// twice as many cache lines as they would be in order. A sample of the crowd is looked at.
bool DiscFinder::are_rows_scattered(const DiscStore& discs)
{
    constexpr std::size_t window = 64, most_windows = 256, rows_a_line = 4;
    const std::size_t windows = discs.rows_by_place.size() / window;
    const std::size_t stride = windows / most_windows + 1;
    std::array<std::uint32_t, window> lines;
    std::size_t seen = 0, in_order = 0;
    for (std::size_t w = 0; w < windows; w += stride) {
        for (std::size_t i = 0; i < window; ++i) lines[i] = discs.rows_by_place[w * window + i] / rows_a_line;
        std::sort(lines.begin(), lines.end());
        seen += static_cast<std::size_t>(std::unique(lines.begin(), lines.end()) - lines.begin());
        in_order += window / rows_a_line;
    }
    return seen > 2 * in_order;
}

DiscFinder::PlacedSegment DiscFinder::place_segment(const DiscStore& discs, std::uint32_t index) const
{
    return {strips.to_strips(discs.wall_ends[2 * std::size_t{index}]),
            strips.to_strips(discs.wall_ends[2 * std::size_t{index} + 1]), index};
}

/// Lists for every band the walls near its strips.
void DiscFinder::place_segments(const DiscStore& discs)
{
    const auto bands = static_cast<std::size_t>(strips.band_count()) + 1;
    if (segments_.size() < bands) segments_.resize(bands);
    for (Array<PlacedSegment>& list : segments_) list.clear();
    const double reach = static_cast<double>(strips.most_reach()) + static_cast<double>(discs.wall_skin);
    for (std::size_t i = 0; i < discs.segments.size(); ++i) {
        const PlacedSegment segment = place_segment(discs, static_cast<std::uint32_t>(i));
        segments_[0].push_back(segment);
        const std::int32_t low = strips.strip_at(std::min(segment.from.y, segment.to.y) - reach);
        const std::int32_t high = strips.strip_at(std::max(segment.from.y, segment.to.y) + reach);
        for (std::size_t band = strips.band_of(low); band <= strips.band_of(high); ++band)
            segments_[band].push_back(segment);
    }
}

void DiscFinder::find(SceneCore& scene, std::size_t band, int worker)
{
    Worker& own = workers_[static_cast<std::size_t>(worker)];
    DiscBand& found = scene.discs.bands[band];
    if (band == 0) {
        const auto all = static_cast<std::uint32_t>(strips.discs().size());
        list_rows(scene.discs, all - static_cast<std::uint32_t>(strips.wide().size()), all);
    } else {
        const std::int32_t first = strips.first_strip(static_cast<std::int32_t>(band) - 1);
        const std::int32_t last = strips.first_strip(static_cast<std::int32_t>(band));
        list_rows(scene.discs, strips.first_of(first), strips.first_of(last));
    }
    if (!segments_[band].empty()) make_room_for_touches(found, 12);
    begin_fillers(found, own, numbers_of(scene, band));
    if (band == 0) {
        find_wide(scene, own);
    } else {
        find_in_strips(scene, band, own);
    }
    own.finish();
}

void DiscFinder::leave(DiscStore& discs, std::size_t band)
{
    list_rows(discs, strips.first_place(band), strips.first_place(band + 1));
    for_each_disc_blocks(discs.bands[band], [](auto, DiscBlocks& blocks) { blocks.count = 0; });
    discs.bands[band].half_awake = 0;
}

std::size_t DiscFinder::numbers_of(const SceneCore& scene, std::size_t band) const
{
    // Contacts of discs that reach far are with any disc: rows are their numbers.
    if (band == 0) return strips.wide().empty() ? 0 : scene.bodies.rows(BodyKind::planar).size();
    const auto last_band = static_cast<std::size_t>(strips.band_count());
    return strips.first_place(std::min(band + 1, last_band) + 1) - strips.first_place(band);
}

void DiscFinder::begin_fillers(DiscBand& band, Worker& worker, std::size_t numbers)
{
    for_each_disc_class([&](auto c) {
        using Fields = DiscFieldsOf<c.value>;
        const auto i = static_cast<std::size_t>(c.value);
        worker.fillers[i].begin(band.blocks[i], Fields::row_floats, Fields::impulse_floats, numbers);
        worker.resting_fillers[i].begin(band.resting[i], Fields::row_floats, Fields::impulse_floats, numbers);
    });
    band.half_awake = 0;
}

/// Memory might not hold the contacts of a large crowd on one spot.
void DiscFinder::count_pairs(const DiscStore& discs, std::size_t more)
{
    const std::size_t most = (std::size_t{1} << 21) + 24 * discs.count;
    if (found_in_all_.fetch_add(more, std::memory_order_relaxed) + more > most)
        refuse("pairs of " + std::to_string(discs.count) + " discs that may touch",
               "more than " + std::to_string(most), "fewer: discs that are not all in one place");
}

/// The pairs of a strip with itself and with the next one, in order.
void DiscFinder::list_pairs(std::int32_t strip, Array<Pair>& pairs) const
{
    const std::span<const PlacedDisc> here = strips.strip(strip);
    const std::span<const PlacedDisc> next =
        strip + 1 < strips.strip_count() ? strips.strip(strip + 1) : std::span<const PlacedDisc>();
    const std::uint32_t first_here = strips.first_of(strip),
                        first_next = first_here + static_cast<std::uint32_t>(here.size());
    const double most = static_cast<double>(strips.most_reach());
    std::size_t found = 0, behind = 0;
    for (std::size_t i = 0; i < here.size(); ++i) {
        const PlacedDisc& me = here[i];
        const double limit = me.along + static_cast<double>(me.reach) + most;
        while (behind < next.size() && next[behind].along < me.along - 2 * most) ++behind;
        const std::size_t most_found = found + here.size() - i + next.size() - behind;
        if (pairs.size() < most_found) pairs.resize(with_room_to_grow(most_found));
        const auto look = [&](std::span<const PlacedDisc> others, std::size_t from, std::uint32_t first) {
            const std::size_t full = found + most_later_neighbours;
            for (std::size_t j = from; j < others.size() && others[j].along <= limit && found < full; ++j) {
                const double along = others[j].along - me.along, across = others[j].across - me.across;
                const double near = static_cast<double>(others[j].reach + me.reach);
                // The pair is always written, and counted only when near: a branch would often mispredict.
                pairs[found] = {first_here + static_cast<std::uint32_t>(i),
                                first + static_cast<std::uint32_t>(j)};
                found += along * along + across * across < near * near ? 1 : 0;
            }
        };
        look(here, i + 1, first_here);
        look(next, behind, first_next);
    }
    pairs.resize(found);
}

/// The impulse that two discs had, if they still touch, or nearly.
CarriedImpulses::Impulse DiscFinder::carried_of(const PlacedDisc& a, const PlacedDisc& b) const
{
    const double along = b.along - a.along, across = b.across - a.across;
    const double near = static_cast<double>(a.radius + b.radius) + still_touching;
    if (along * along + across * across >= near * near) return {};
    return carried.of_pair(a.row, b.row);
}

/// A contact of two discs, if they may meet.
void DiscFinder::add_pair(SceneCore& scene, DiscBand& band, Worker& worker, const PlacedDisc& a,
                          const PlacedDisc& b, const CarriedImpulses::Impulse& impulse,
                          std::uint32_t number_a, std::uint32_t number_b) const
{
    DiscStore& discs = scene.discs;
    float friction = 0;
    if (discs.rough_discs > 0 || discs.filtered_discs > 0) {
        const Array<std::uint32_t>& slots = scene.bodies.rows(BodyKind::planar).slot;
        const DiscShape& shape_a = discs.shapes[slots[a.row]];
        const DiscShape& shape_b = discs.shapes[slots[b.row]];
        if (!do_meet(shape_a, shape_b)) return;
        friction = friction_of(shape_a.friction, shape_b.friction);
    }
    with_disc_class(friction > 0 ? DiscClass::rough_pair : DiscClass::smooth_pair, [&](auto c) {
        if constexpr (!is_wall(c.value)) {
            using Fields = DiscFieldsOf<c.value>;
            const auto i = static_cast<std::size_t>(c.value);
            const bool a_rests = scene.bodies.is_asleep(BodyRow(BodyKind::planar, a.row)),
                       b_rests = scene.bodies.is_asleep(BodyRow(BodyKind::planar, b.row));
            const bool rests = a_rests && b_rests;
            band.half_awake += a_rests != b_rests ? 1 : 0;
            DiscBlocks& blocks = rests ? band.resting[i] : band.blocks[i];
            const BlockFiller::Place at =
                (rests ? worker.resting_fillers : worker.fillers)[i].take(number_a, number_b);
            blocks.bodies[at.block].a[at.lane] = offset_of(BodyRow(BodyKind::planar, a.row));
            blocks.bodies[at.block].b[at.lane] = offset_of(BodyRow(BodyKind::planar, b.row));
            typename Fields::Row row{};
            row.in_sweep.effective_mass = 1 / (a.inverse_mass + b.inverse_mass);
            typename Fields::Impulse held{};
            held.normal = impulse.normal;
            if constexpr (is_rough(c.value)) {
                row.in_sweep.friction = friction;
                row.radius_a = a.radius;
                row.radius_b = b.radius;
                held.tangent = impulse.tangent;
            } else {
                row.reach = a.radius + b.radius;
            }
            store_lane(row, blocks.rows.data(), at.block, at.lane);
            store_lane(held, blocks.impulses.data(), at.block, at.lane);
            if (rests) keep_sum<Fields>(impulse, blocks, at);
        }
    });
}

bool DiscFinder::is_near(const DiscStore& discs, const PlacedSegment& segment, const PlacedDisc& disc)
{
    const double near = static_cast<double>(disc.reach) + static_cast<double>(discs.wall_skin);
    return distance2({disc.along, disc.across}, segment.from, segment.to) < near * near;
}

/// A contact of a disc with a wall, if it is near and they may meet.
void DiscFinder::add_touch(SceneCore& scene, DiscBand& band, Worker& worker, const PlacedSegment& segment,
                           const PlacedDisc& disc, CarriedImpulses::Impulse impulse,
                           std::uint32_t number) const
{
    DiscStore& discs = scene.discs;
    if (!is_near(discs, segment, disc)) return;
    const BodyRows& rows = scene.bodies.rows(BodyKind::planar);
    const WallSegment& wall = discs.segments[segment.index];
    const DiscShape& shape = discs.shapes[rows.slot[disc.row]];
    if (!do_meet(shape, wall)) return;
    const float friction = friction_of(shape.friction, wall.friction);
    if (impulse.side == 0) {
        const Vec2<double>& from = discs.wall_ends[2 * std::size_t{segment.index}];
        const Vec2<double>& to = discs.wall_ends[2 * std::size_t{segment.index} + 1];
        const bool is_right = cross(to - from, in_plane(rows.pose[disc.row].position) - from) < 0;
        // place_walls() finds out whether the disc has passed a one-way wall already.
        impulse.side = wall.is_one_way != 0 ? WallTouch::passing : is_right ? -1.0F : 1.0F;
    }
    with_disc_class(friction > 0 ? DiscClass::rough_wall : DiscClass::smooth_wall, [&](auto c) {
        if constexpr (is_wall(c.value)) {
            using Fields = DiscFieldsOf<c.value>;
            const auto i = static_cast<std::size_t>(c.value);
            const bool rests = scene.bodies.is_asleep(BodyRow(BodyKind::planar, disc.row));
            DiscBlocks& blocks = rests ? band.resting[i] : band.blocks[i];
            // First, so that every lane in use has a touch even if memory runs out.
            grow_to(blocks.touches, block_lanes * (static_cast<std::size_t>(blocks.count) + 1));
            const BlockFiller::Place at =
                (rests ? worker.resting_fillers : worker.fillers)[i].take(BlockFiller::no_body, number);
            blocks.bodies[at.block].a[at.lane] = offset_of(scene.bodies.row_of(wall.body));
            blocks.bodies[at.block].b[at.lane] = offset_of(BodyRow(BodyKind::planar, disc.row));
            blocks.touches[block_lanes * at.block + at.lane] = {segment.index, impulse.side};
            typename Fields::Row row{};
            row.in_sweep.effective_mass = 1 / disc.inverse_mass;
            typename Fields::Impulse held{};
            held.normal = impulse.normal;
            if constexpr (is_rough(c.value)) {
                row.in_sweep.friction = friction;
                row.radius_b = disc.radius;
                held.tangent = impulse.tangent;
            } else {
                row.reach = disc.radius;
            }
            store_lane(row, blocks.rows.data(), at.block, at.lane);
            store_lane(held, blocks.impulses.data(), at.block, at.lane);
            if (rests) keep_sum<Fields>(impulse, blocks, at);
        }
    });
}

void DiscFinder::find_in_strips(SceneCore& scene, std::size_t band, Worker& worker)
{
    DiscBand& found = scene.discs.bands[band];
    const std::int32_t first = strips.first_strip(static_cast<std::int32_t>(band) - 1);
    const std::int32_t last = strips.first_strip(static_cast<std::int32_t>(band));
    const std::uint32_t base = strips.first_of(first);
    const PlacedDisc* const zero = strips.discs().data() + base;  // there may be none
    for (std::int32_t strip = first; strip < last; ++strip) {
        list_pairs(strip, worker.pairs);
        count_pairs(scene.discs, worker.pairs.size());
        for (const Pair& pair : worker.pairs)
            add_pair(scene, found, worker, strips.disc(pair.a), strips.disc(pair.b),
                     carried_of(strips.disc(pair.a), strips.disc(pair.b)), pair.a - base, pair.b - base);
    }
    const double skin = static_cast<double>(scene.discs.wall_skin);
    const double reach = static_cast<double>(strips.most_reach()) + skin;
    for (const PlacedSegment& segment : segments_[band]) {
        const double low = std::min(segment.from.y, segment.to.y) - reach,
                     high = std::max(segment.from.y, segment.to.y) + reach;
        for (std::int32_t s = std::max(first, strips.strip_at(low));
             s <= std::min(last - 1, strips.strip_at(high)); ++s) {
            const Range near = range_within(segment.from, segment.to, strips.low_edge_of(s) - reach,
                                            strips.low_edge_of(s + 1) + reach);
            strips.for_each_between(s, near.low - reach, near.high + reach, [&](const PlacedDisc& disc) {
                add_touch(scene, found, worker, segment, disc, carried.of_wall(disc.row, segment.index),
                          static_cast<std::uint32_t>(&disc - zero));
            });
        }
    }
}

/// Discs that reach further than the strips are made for: each with all discs and walls in its reach.
void DiscFinder::find_wide(SceneCore& scene, Worker& worker)
{
    DiscBand& found = scene.discs.bands[0];
    const std::span<const PlacedDisc> wide = strips.wide();
    for (std::size_t w = 0; w < wide.size(); ++w) {
        const PlacedDisc& me = wide[w];
        const auto try_pair = [&](const PlacedDisc& other) {
            const double along = other.along - me.along, across = other.across - me.across;
            const double near = static_cast<double>(other.reach + me.reach);
            if (along * along + across * across >= near * near) return;
            count_pairs(scene.discs, 1);
            add_pair(scene, found, worker, me, other, carried_of(me, other), me.row, other.row);
        };
        for (std::size_t v = w + 1; v < wide.size(); ++v) try_pair(wide[v]);
        const double reach = static_cast<double>(me.reach) + static_cast<double>(strips.most_reach());
        for (std::int32_t s = strips.strip_at(me.across - reach); s <= strips.strip_at(me.across + reach);
             ++s)
            strips.for_each_between(s, me.along - reach, me.along + reach, try_pair);
        for (const PlacedSegment& segment : segments_[0])
            add_touch(scene, found, worker, segment, me, carried.of_wall(me.row, segment.index), me.row);
    }
}

}  // namespace motley
