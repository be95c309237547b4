// The rows of contacts with walls, one at a time: they are few beside those of people.
#include <algorithm>
#include <cmath>

#include "crowd/disc_finder.h"
#include "stores/disc_fields.h"

namespace motley {
namespace {

struct Placed {
    Vec2<double> normal, point;
};

/// Where a disc at `at` would touch a segment. Beside the segment the normal is that of the wall, towards the side on
/// which the disc was found, even if its centre has been pressed beyond.
Placed place(const Vec2<double>& at, const Vec2<double>& from, const Vec2<double>& to, float side)
{
    const Vec2<double> along = to - from;
    const double length2 = dot(along, along), t = dot(along, at - from) / length2;
    const double s = static_cast<double>(side) / std::sqrt(length2);
    const Vec2<double> across{-s * along.y, s * along.x};
    if (t > 0 && t < 1) return {across, from + t * along};
    const Vec2<double> end = t > 0 ? to : from, away = at - end;
    const double distance = std::sqrt(dot(away, away));
    return {distance > 1e-9 ? (1 / distance) * away : across, end};
}

Vec2<double> in_plane(const Vec3<PoseReal>& v)
{
    return {static_cast<double>(v.x), static_cast<double>(v.y)};
}

template <DiscClass c>
void place_class(const SceneCore& scene, std::span<const Vec2<double>> ends, float warm_start_scale,
                 DiscBlocks& blocks)
{
    using Fields = DiscFieldsOf<c>;
    const BodyRows& planar = scene.bodies.rows(BodyKind::planar);
    const BodyRows& fixed = scene.bodies.rows(BodyKind::fixed);
    for (std::size_t block = 0; block < static_cast<std::size_t>(blocks.count); ++block) {
        for (std::size_t lane = 0; lane < blocks.lanes[block]; ++lane) {
            const WallTouch& touch = blocks.touches[block_lanes * block + lane];
            const auto b =
                static_cast<std::size_t>(blocks.bodies[block].b[lane] / offsets_a_row(BodyKind::planar));
            const auto a =
                static_cast<std::size_t>(blocks.bodies[block].a[lane] / offsets_a_row(BodyKind::fixed));
            const Vec2<double> at = in_plane(planar.pose[b].position);
            const std::size_t segment = touch.segment;
            const Placed placed = place(at, ends[2 * segment], ends[2 * segment + 1], touch.side);
            auto row = load_lane<typename Fields::Row>(blocks.rows.data(), block, lane);
            auto& sweep = row.in_sweep;
            const double distance = dot(placed.normal, at - placed.point);
            sweep.normal = {static_cast<float>(placed.normal.x), static_cast<float>(placed.normal.y)};
            if constexpr (is_rough(c)) {
                sweep.separation = static_cast<float>(distance - static_cast<double>(row.radius_b));
                sweep.arm_b = static_cast<float>(distance);
            } else {
                sweep.separation = static_cast<float>(distance - static_cast<double>(row.reach));
            }
            const Vec2<double> arm = placed.point - in_plane(fixed.pose[a].position);
            sweep.arm_a = {static_cast<float>(arm.x), static_cast<float>(arm.y)};
            store_lane(row, blocks.rows.data(), block, lane);
            auto impulse = load_lane<typename Fields::Impulse>(blocks.impulses.data(), block, lane);
            impulse.normal *= warm_start_scale;
            if constexpr (is_rough(c)) impulse.tangent *= warm_start_scale;
            store_lane(impulse, blocks.impulses.data(), block, lane);
            store_lane(typename Fields::Impulse{}, blocks.sums.data(), block, lane);
        }
    }
}

}  // namespace

void place_walls(const SceneCore& scene, std::span<const Vec2<double>> ends, float warm_start_scale,
                 DiscBand& band)
{
    for_each_disc_class([&](auto c) {
        if constexpr (is_wall(c.value))
            place_class<c.value>(scene, ends, warm_start_scale,
                                 band.blocks[static_cast<std::size_t>(c.value)]);
    });
}

double fastest_wall_end(const SceneCore& scene)
{
    double fastest = 0;
    const BodyRows& fixed = scene.bodies.rows(BodyKind::fixed);
    for (const WallSegment& segment : scene.discs.segments) {
        const float* v = &fixed.velocity[std::size_t{8} * scene.bodies.row_of(segment.body).row()];
        const auto x = static_cast<double>(v[0]), y = static_cast<double>(v[1]),
                   w = static_cast<double>(v[6]);
        const double arm2 = std::max(dot(segment.from, segment.from), dot(segment.to, segment.to));
        if (x != 0 || y != 0 || w != 0)
            fastest = std::max(fastest, std::sqrt(x * x + y * y) + std::abs(w) * std::sqrt(arm2));
    }
    return fastest;
}

}  // namespace motley
