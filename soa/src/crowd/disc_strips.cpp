// See disc_strips.h. A sort by counting, in chunks that do not depend on the number of threads.
#include "crowd/disc_strips.h"

#include <cmath>
#include <utility>

#include "maths/bit_cast.h"
#include "stores/array.h"
#include "stores/growth.h"

namespace motley {
namespace {

/// m: a disc at rest may go so far before its neighbours are found again.
constexpr float skin_at_rest = 0.02F;
/// Steps for which a search looks ahead, at the speed that a disc has; and for which it does at least.
constexpr double steps_ahead = 6, least_ahead = 2;
/// m/s: strips are made for discs of this speed, even if most stand still. A few walk through them any time.
constexpr double walking_speed = 1.5;
/// People of a band: few enough for a core's first cache, and enough that blocks are full.
constexpr std::uint32_t discs_per_band = 512;
/// Two, so that what a disc meets between searches is in its band or beside it.
constexpr std::int32_t least_strips = 2;

}  // namespace

int DiscStrips::bucket_of(float reach)
{
    // Exponent and three digits of the fraction.
    constexpr std::int32_t first = (127 - 20) << 3;
    const auto digits = static_cast<std::int32_t>(bit_cast<std::uint32_t>(reach) >> 20);
    return std::clamp(digits - first, 0, buckets - 1);
}
float DiscStrips::upper_end_of(int bucket)
{
    return bit_cast<float>(static_cast<std::uint32_t>(bucket + 1 + ((127 - 20) << 3)) << 20);
}

/// A disc whose speed is no number is contained when this step ends; until then it is taken for one at rest.
float DiscStrips::skin_at(double speed, float dt, double steps)
{
    const double goes = speed * static_cast<double>(dt) * steps;
    return skin_at_rest + static_cast<float>(goes > 0 ? std::min(goes, 1e9) : 0);
}
float DiscStrips::skin_at(double speed, float dt)
{
    return skin_at(speed, dt, steps_ahead);
}

float DiscStrips::late_skin(double speed, float dt, float radius) const
{
    const float most = most_late_reach() - radius;
    return std::min(skin_at(speed, dt), std::max(skin_at(speed, dt, least_ahead), most));
}

float DiscStrips::inverse_mass_of(const SceneCore& scene, std::uint32_t row)
{
    const BodyRows& rows = scene.bodies.rows(BodyKind::planar);
    const float own = rows.velocity[std::size_t{4} * row + 3];
    return own > 0 ? own : scene.bodies.inverse_masses[rows.slot[row]];
}

void DiscStrips::begin(SceneCore& scene, float dt)
{
    const std::uint32_t rows = scene.bodies.rows(BodyKind::planar).size();
    dt_ = dt;
    chunks_ = disc_chunks(rows);
    measured_.resize(static_cast<std::size_t>(chunks_));
    grow_to(scene.discs.anchors, rows);
    scene.discs.found_at.resize(scene.discs.anchors.size());
}

void DiscStrips::measure(const SceneCore& scene, DiscStore& discs, std::int64_t chunk)
{
    const BodyStore& bodies = scene.bodies;
    const BodyRows& rows = bodies.rows(BodyKind::planar);
    Measured m;
    for_each_row_of_chunk(chunk, rows.size(), [&](std::uint32_t row) {
        DiscAnchor& anchor = discs.anchors[row];
        anchor.skin = INFINITY;
        discs.found_at[row] = anchor;
        const std::uint32_t slot = rows.slot[row];
        const DiscShape* shape = slot == 0 ? nullptr : discs.shape_of(slot);
        if (shape == nullptr || bodies.contained[slot] != 0) return;
        anchor.skin = skin_at(speed_of(&rows.velocity[std::size_t{4} * row]), dt_);
        discs.found_at[row] = anchor;
        const Vec3<PoseReal>& at = rows.pose[row].position;
        const auto x = static_cast<double>(at.x), y = static_cast<double>(at.y);
        m.low = {std::min(m.low.x, x), std::min(m.low.y, y)};
        m.high = {std::max(m.high.x, x), std::max(m.high.y, y)};
        const float least = skin_at(walking_speed, dt_);
        ++m.reaches[static_cast<std::size_t>(bucket_of(shape->radius + std::max(anchor.skin, least)))];
        ++m.discs;
    });
    measured_[static_cast<std::size_t>(chunk)] = m;
}

DiscStrips::Measured DiscStrips::measured() const
{
    Measured all;
    for (const Measured& m : measured_) {
        all.low = {std::min(all.low.x, m.low.x), std::min(all.low.y, m.low.y)};
        all.high = {std::max(all.high.x, m.high.x), std::max(all.high.y, m.high.y)};
        all.discs += m.discs;
        for (std::size_t b = 0; b < buckets; ++b) all.reaches[b] += m.reaches[b];
    }
    return all;
}

/// Chooses the strips: as wide as all but a few discs can reach.
void DiscStrips::choose(DiscStore& discs, const Measured& all)
{
    const Vec2<double> low = all.discs > 0 ? all.low : Vec2<double>{},
                       high = all.discs > 0 ? all.high : Vec2<double>{};
    constexpr std::int64_t one_in = 256;
    int bucket = buckets - 1;
    for (std::int64_t above = 0; bucket > 0; --bucket) {
        above += all.reaches[static_cast<std::size_t>(bucket)];
        if (above * one_in > all.discs) break;
    }
    // Strips are stacked along the longer side. In a crowd that is about square they stay as they were, or the rows of
    // its people would have to be sorted again and again.
    const double x = high.x - low.x, y = high.y - low.y, clearly = 1.25;
    const bool is_turned = discs.frame.is_turned != 0 ? y <= clearly * x : x > clearly * y;
    const double extent = is_turned ? x : y;
    const double most_strips = std::min(4.0 * static_cast<double>(all.discs) + 64, 1e7);
    const float most_reach = upper_end_of(bucket);
    const double per_metre = 1 / std::max(2.0001 * static_cast<double>(most_reach), extent / most_strips);
    frame_ = {low, per_metre, most_reach, static_cast<std::int32_t>(extent * per_metre) + 1,
              is_turned ? 1 : 0};
    discs.frame = frame_;
    strips_ = frame_.strips;
    in_strip_.clear();
}

void DiscStrips::make_room_for(std::int64_t discs)
{
    discs_ = discs;
    strips_ = frame_.strips;
    strips_per_group_ = (strips_ + most_groups - 1) / most_groups;
    groups_ = (strips_ + strips_per_group_ - 1) / strips_per_group_;
    resize_with_room(places_, static_cast<std::size_t>(chunks_) * static_cast<std::size_t>(groups_ + 1));
    std::fill(places_.begin(), places_.end(), 0U);
    resize_with_room(first_in_group_, static_cast<std::size_t>(groups_) + 2);
    resize_with_room(starts_, static_cast<std::size_t>(discs_ + strips_ + groups_));
    grow_to(placed_, static_cast<std::size_t>(discs_));
    sorted_.resize(static_cast<std::size_t>(discs_));
    resize_with_room(first_, static_cast<std::size_t>(strips_) + 1);
}

void DiscStrips::restore(const SceneCore& scene)
{
    const DiscStore& discs = scene.discs;
    const std::uint32_t rows = scene.bodies.rows(BodyKind::planar).size();
    chunks_ = disc_chunks(rows);
    frame_ = discs.frame;
    std::int64_t count_of_discs = 0;
    for (std::int64_t chunk = 0; chunk < chunks_; ++chunk)
        for_each_disc(scene, chunk, [&](std::uint32_t, const BodyRows&) { ++count_of_discs; });
    make_room_for(count_of_discs);
    for (std::int64_t chunk = 0; chunk < chunks_; ++chunk) count(scene, chunk);
    open();
    for (std::int64_t chunk = 0; chunk < chunks_; ++chunk) place(scene, chunk);
    for (std::int64_t group = 0; group <= groups_; ++group) sort(scene, group);
    divide();
}

/// The anchor is a float; the skin grows by what rounding moves it. The skin of a fast disc is cut to what strips are made
/// for, unless it is so fast that it could not be searched for between searches of all discs either.
void DiscStrips::anchor(SceneCore& scene, std::int64_t chunk) const
{
    DiscStore& discs = scene.discs;
    for_each_disc(scene, chunk, [&](std::uint32_t row, const BodyRows& rows) {
        DiscAnchor& anchor = discs.anchors[row];
        discs.place_anchor(row, rows.pose[row].position);
        const float radius = discs.shapes[rows.slot[row]].radius;
        const float most = 0.99999F * (frame_.most_reach - radius);
        const float least = skin_at(speed_of(&rows.velocity[std::size_t{4} * row]), dt_, least_ahead);
        if (most >= skin_at_rest && radius + least <= most_late_reach())
            anchor.skin = std::min(anchor.skin, most);
        discs.found_at[row] = anchor;
    });
}

void DiscStrips::count(const SceneCore& scene, std::int64_t chunk)
{
    std::uint32_t* places = &places_[static_cast<std::size_t>(chunk * (groups_ + 1))];
    const DiscStore& discs = scene.discs;
    for_each_disc(scene, chunk, [&](std::uint32_t row, const BodyRows& rows) {
        const DiscAnchor& anchor = discs.found_at[row];
        const float reach = discs.shapes[rows.slot[row]].radius + anchor.skin;
        ++places[group_of(to_strips(anchor).y, reach)];
    });
}

void DiscStrips::open()
{
    std::uint32_t next = 0;
    for (std::int32_t group = 0; group <= groups_; ++group) {
        first_in_group_[static_cast<std::size_t>(group)] = next;
        for (std::int64_t chunk = 0; chunk < chunks_; ++chunk)
            next += std::exchange(places_[static_cast<std::size_t>(chunk * (groups_ + 1) + group)], next);
    }
    first_in_group_[static_cast<std::size_t>(groups_) + 1] = next;
    first_[static_cast<std::size_t>(strips_)] = first_in_group_[static_cast<std::size_t>(groups_)];
}

void DiscStrips::place(const SceneCore& scene, std::int64_t chunk)
{
    std::uint32_t* places = &places_[static_cast<std::size_t>(chunk * (groups_ + 1))];
    const DiscStore& discs = scene.discs;
    for_each_disc(scene, chunk, [&](std::uint32_t row, const BodyRows& rows) {
        const DiscAnchor& anchor = discs.found_at[row];
        const Vec2<double> at = to_strips(anchor);
        const float radius = discs.shapes[rows.slot[row]].radius, reach = radius + anchor.skin;
        placed_[places[group_of(at.y, reach)]++] = {at.x, at.y, reach, radius, inverse_mass_of(scene, row),
                                                    row};
    });
}

void DiscStrips::sort(const SceneCore& scene, std::int64_t group)
{
    const std::uint32_t begin = first_in_group_[static_cast<std::size_t>(group)],
                        end = first_in_group_[static_cast<std::size_t>(group) + 1];
    const std::span<const PlacedDisc> discs =
        std::span<const PlacedDisc>(placed_).subspan(begin, end - begin);
    const Array<std::uint32_t>& slots = scene.bodies.rows(BodyKind::planar).slot;
    const Array<std::uint64_t>& numbers = scene.discs.numbers;
    const auto comes_before = [&](const PlacedDisc& p, const PlacedDisc& q) {
        if (p.along != q.along) return p.along < q.along;
        if (p.across != q.across) return p.across < q.across;
        const std::uint32_t own = slots[p.row], other = slots[q.row];
        return numbers.empty() ? own < other : numbers[own] < numbers[other];
    };
    const auto order = [&](std::size_t first, std::size_t last) {
        if (last - first > 1)
            std::sort(sorted_.begin() + static_cast<std::ptrdiff_t>(first),
                      sorted_.begin() + static_cast<std::ptrdiff_t>(last), comes_before);
    };
    if (group == groups_) {
        std::copy(discs.begin(), discs.end(), sorted_.begin() + begin);
        order(begin, end);
        return;
    }
    const auto first_strip = static_cast<std::int32_t>(group) * strips_per_group_;
    const std::int32_t strips = std::min(strips_per_group_, strips_ - first_strip);
    double low = 1e300, high = -1e300;
    for (const PlacedDisc& disc : discs) {
        low = std::min(low, disc.along);
        high = std::max(high, disc.along);
    }
    // Bins along each strip, about one a disc.
    const auto bins =
        static_cast<std::int32_t>(std::max<std::size_t>(1, discs.size() / static_cast<std::size_t>(strips)));
    const double per_metre = high > low ? static_cast<double>(bins) / (high - low) : 0;
    const auto bin_of = [&](const PlacedDisc& disc) {
        const std::int32_t bin =
            std::min(static_cast<std::int32_t>((disc.along - low) * per_metre), bins - 1);
        return static_cast<std::size_t>((strip_at(disc.across) - first_strip) * bins + bin);
    };
    // A group has no more bins than discs or strips.
    const std::span<std::uint32_t> starts =
        std::span(starts_).subspan(static_cast<std::size_t>(begin) + static_cast<std::size_t>(first_strip) +
                                       static_cast<std::size_t>(group),
                                   static_cast<std::size_t>(strips * bins) + 1);
    std::fill(starts.begin(), starts.end(), 0U);
    for (const PlacedDisc& disc : discs) ++starts[bin_of(disc) + 1];
    starts[0] = begin;
    for (std::size_t b = 1; b < starts.size(); ++b) starts[b] += starts[b - 1];
    for (std::int32_t s = 0; s < strips; ++s)
        first_[static_cast<std::size_t>(first_strip + s)] = starts[static_cast<std::size_t>(s * bins)];
    for (const PlacedDisc& disc : discs) sorted_[starts[bin_of(disc)]++] = disc;
    // Each start is now the end of its bin.
    for (std::size_t b = 0, first = begin; b + 1 < starts.size(); first = starts[b++])
        order(first, starts[b]);
}

std::size_t DiscStrips::band_of(std::int32_t strip) const
{
    std::int32_t band = 0, end = band_count();
    while (end - band > 1) {
        const std::int32_t middle = band + (end - band) / 2;
        (first_strip(middle) <= strip ? band : end) = middle;
    }
    return static_cast<std::size_t>(band) + 1;
}

void DiscStrips::divide()
{
    band_strips_.clear();
    band_strips_.push_back(0);
    std::uint32_t in_band = 0;
    for (std::int32_t s = 0; s < strips_; ++s) {
        if (in_band >= discs_per_band && s - band_strips_.back() >= least_strips) {
            band_strips_.push_back(s);
            in_band = 0;
        }
        in_band += in_strip_.empty() ? first_of(s + 1) - first_of(s) : in_strip_[static_cast<std::size_t>(s)];
    }
    band_strips_.push_back(strips_);
}

}  // namespace motley
