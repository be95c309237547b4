// The rows of contacts with walls, one at a time: they are few beside those of people. And those of bodies that fall
// asleep, which is seldom.
#include <cmath>

#include "crowd/disc_finder.h"
#include "scene/wall_ends.h"
#include "stores/disc_fields.h"

namespace motley {
namespace {

/// m: where a wall does not hold a disc, the contact is as far away as if there were none.
constexpr float far_away = 1e6F;

struct Placed {
    Vec2<double> normal, point;
};

/// A disc and a segment of a wall.
struct Meeting {
    Vec2<double> at, from, to;
    double radius;
    Vec2<double> along{};
    double length2 = 0, t = 0;  ///< the point of the segment's line next to the disc is from + t along
    Vec2<double> away{};        ///< of the disc from the nearest point of the segment

    Meeting(const Vec2<double>& at_, const Vec2<double>& from_, const Vec2<double>& to_, double radius_)
        : at(at_), from(from_), to(to_), radius(radius_), along(to - from), length2(dot(along, along))
    {
        t = dot(along, at - from) / length2;
        away = at - (is_beside() ? from + t * along : end());
    }
    [[nodiscard]] bool is_beside() const { return t > 0 && t < 1; }
    [[nodiscard]] Vec2<double> end() const { return t > 0 ? to : from; }
    /// How far to the left of the segment's line the disc is, m.
    [[nodiscard]] double left() const { return cross(along, at - from) / std::sqrt(length2); }
};

/// On which side of the segment the disc now is to be held. Beside the segment it stays on its side, even if its centre
/// has been pressed beyond; when it has walked around an end, it is on the other one. A one-way wall holds it on the left
/// once it has passed.
float side_of(const Meeting& meeting, float side, bool is_one_way)
{
    if (is_one_way) {
        if (side == WallTouch::passing) return meeting.left() >= meeting.radius ? 1.0F : side;
        return meeting.is_beside() || meeting.left() >= 0 ? 1.0F : WallTouch::passing;
    }
    const bool is_clear = dot(meeting.away, meeting.away) > 0.25 * meeting.radius * meeting.radius;
    if (meeting.is_beside() || !is_clear) return side;
    return meeting.left() < 0 ? -1.0F : 1.0F;
}

/// Where a disc would touch a segment on that side.
Placed place(const Meeting& meeting, float side)
{
    const double s = (side == -1.0F ? -1 : 1) / std::sqrt(meeting.length2);
    const Vec2<double> across{-s * meeting.along.y, s * meeting.along.x};
    if (meeting.is_beside()) return {across, meeting.from + meeting.t * meeting.along};
    const double distance = std::sqrt(dot(meeting.away, meeting.away));
    return {distance > 1e-9 ? (1 / distance) * meeting.away : across, meeting.end()};
}

/// The rows of contacts with walls.
template <DiscClass c>
void place_class(const SceneCore& scene, std::span<const Vec2<double>> ends, DiscBlocks& blocks)
{
    using Fields = DiscFieldsOf<c>;
    const BodyRows& planar = scene.bodies.rows(BodyKind::planar);
    const BodyRows& fixed = scene.bodies.rows(BodyKind::fixed);
    for (std::size_t block = 0; block < static_cast<std::size_t>(blocks.count); ++block) {
        for (std::size_t lane = 0; lane < blocks.lanes[block]; ++lane) {
            WallTouch& touch = blocks.touches[block_lanes * block + lane];
            const auto b =
                static_cast<std::size_t>(blocks.bodies[block].b[lane] / offsets_a_row(BodyKind::planar));
            const auto a =
                static_cast<std::size_t>(blocks.bodies[block].a[lane] / offsets_a_row(BodyKind::fixed));
            const Vec2<double> at = in_plane(planar.pose[b].position);
            const WallSegment& segment = scene.discs.segments[touch.segment];
            auto row = load_lane<typename Fields::Row>(blocks.rows.data(), block, lane);
            auto& sweep = row.in_sweep;
            double radius = 0;
            if constexpr (is_rough(c)) {
                radius = static_cast<double>(row.radius_b);
            } else {
                radius = static_cast<double>(row.reach);
            }
            const Meeting meeting(at, ends[2 * std::size_t{touch.segment}],
                                  ends[2 * std::size_t{touch.segment} + 1], radius);
            touch.side = side_of(meeting, touch.side, segment.is_one_way != 0);
            const Placed placed = place(meeting, touch.side);
            const double distance = dot(placed.normal, at - placed.point);
            sweep.normal = {static_cast<float>(placed.normal.x), static_cast<float>(placed.normal.y)};
            sweep.separation =
                touch.side == WallTouch::passing ? far_away : static_cast<float>(distance - radius);
            sweep.most_force = segment.max_force;
            if constexpr (is_rough(c)) {
                sweep.arm_b = static_cast<float>(distance);
                const Vec2<double> tangent{-placed.normal.y, placed.normal.x};
                sweep.surface_speed = segment.surface_speed * static_cast<float>(dot(tangent, meeting.along) /
                                                                                 std::sqrt(meeting.length2));
            }
            row.start_separation = sweep.separation;
            const Vec2<double> arm = placed.point - in_plane(fixed.pose[a].position);
            sweep.arm_a = {static_cast<float>(arm.x), static_cast<float>(arm.y)};
            store_lane(row, blocks.rows.data(), block, lane);
        }
    }
}

/// The impulses to start from, and sums of zero.
template <DiscClass c>
void begin_impulses(float warm_start_scale, DiscBlocks& blocks)
{
    using Impulse = typename DiscFieldsOf<c>::Impulse;
    for (std::size_t block = 0; block < static_cast<std::size_t>(blocks.count); ++block) {
        for (std::size_t lane = 0; lane < blocks.lanes[block]; ++lane) {
            auto impulse = load_lane<Impulse>(blocks.impulses.data(), block, lane);
            impulse.normal *= warm_start_scale;
            if constexpr (is_rough(c)) impulse.tangent *= warm_start_scale;
            store_lane(impulse, blocks.impulses.data(), block, lane);
            store_lane(Impulse{}, blocks.sums.data(), block, lane);
        }
    }
}

/// The rows of contacts of two discs, as the kernels make them.
template <DiscClass c>
void place_pairs(const SceneCore& scene, DiscBlocks& blocks)
{
    using Fields = DiscFieldsOf<c>;
    constexpr std::int32_t a_row = offsets_a_row(BodyKind::planar);
    const AlignedVector<BodyPose>& poses = scene.bodies.rows(BodyKind::planar).pose;
    for (std::size_t block = 0; block < static_cast<std::size_t>(blocks.count); ++block) {
        for (std::size_t lane = 0; lane < blocks.lanes[block]; ++lane) {
            const BlockBodies& bodies = blocks.bodies[block];
            const Vec3<PoseReal>& a = poses[static_cast<std::size_t>(bodies.a[lane] / a_row)].position;
            const Vec3<PoseReal>& b = poses[static_cast<std::size_t>(bodies.b[lane] / a_row)].position;
            auto row = load_lane<typename Fields::Row>(blocks.rows.data(), block, lane);
            Fields::Kind::template place_pair<float>(
                {static_cast<float>(b.x - a.x), static_cast<float>(b.y - a.y)}, row);
            store_lane(row, blocks.rows.data(), block, lane);
        }
    }
}

}  // namespace

void place_walls(const SceneCore& scene, std::span<const Vec2<double>> ends, float warm_start_scale,
                 DiscBand& band)
{
    for_each_disc_class([&](auto c) {
        if constexpr (is_wall(c.value)) {
            DiscBlocks& blocks = band.blocks[static_cast<std::size_t>(c.value)];
            place_class<c.value>(scene, ends, blocks);
            begin_impulses<c.value>(warm_start_scale, blocks);
        }
    });
}

void place_resting(const SceneCore& scene, std::span<const Vec2<double>> ends, DiscBand& band)
{
    for_each_disc_class([&](auto c) {
        DiscBlocks& blocks = band.resting[static_cast<std::size_t>(c.value)];
        if constexpr (is_wall(c.value)) {
            place_class<c.value>(scene, ends, blocks);
        } else {
            place_pairs<c.value>(scene, blocks);
        }
    });
}

}  // namespace motley
