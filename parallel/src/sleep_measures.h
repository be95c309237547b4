// How far bodies go and how far apart they are: what the rules of sleep (scene/sleep.h) measure, to wake and to tie alike.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "motley/core/settings.h"
#include "sleep_pipeline.h"
#include "stores/disc_fields.h"

namespace motley {

inline constexpr std::array moving_kinds{BodyKind::particle, BodyKind::planar, BodyKind::rigid};

inline const float* velocity_of(const BodyStore& bodies, BodyRow where)
{
    const auto quads = static_cast<std::size_t>(quads_of(where.kind()));
    return &bodies.rows(where.kind()).velocity[4 * quads * where.row()];
}

inline std::uint32_t slot_of(const BodyStore& bodies, BodyRow where)
{
    return bodies.rows(where.kind()).slot[where.row()];
}

/// Whether a body that is not dynamic moves, or was moved since the last step.
inline bool is_moving(const BodyStore& bodies, BodyRow fixed)
{
    const float* v = velocity_of(bodies, fixed);
    return v[0] != 0 || v[1] != 0 || v[2] != 0 || v[4] != 0 || v[5] != 0 || v[6] != 0 ||
           bodies.sleep[slot_of(bodies, fixed)] == Sleep::roused;
}

/// How far a point of a body goes in a step at its present speed and acceleration, m. `arm`, m, leads to the point.
inline double reach_of(const SleepPipeline::Step& step, BodyRow where, const Vec3<float>& arm)
{
    const BodyStore& bodies = step.scene.bodies;
    const BodyRows& rows = bodies.rows(where.kind());
    const auto quads = static_cast<std::size_t>(quads_of(where.kind()));
    const float* v = velocity_of(bodies, where);
    const float* a = &rows.acceleration[4 * quads * where.row()];
    const bool in_plane = where.kind() == BodyKind::planar, moves = where.kind() != BodyKind::fixed;
    const Vec3<float>& g = step.settings.gravity;
    const Vec3<double> velocity = convert<double>(Vec3<float>{v[0], v[1], in_plane ? 0 : v[2]});
    const Vec3<double> acceleration =
        convert<double>(Vec3<float>{a[0] + g.x, a[1] + g.y, in_plane ? 0 : a[2] + g.z});
    const Vec3<double> spin = convert<double>(in_plane     ? Vec3<float>{0, 0, v[2]}
                                              : quads == 2 ? Vec3<float>{v[4], v[5], v[6]}
                                                           : Vec3<float>{});
    const auto length = [](const Vec3<double>& u) { return std::sqrt(dot(u, u)); };
    const double dt = static_cast<double>(step.dt);
    const double speed = length(velocity) + length(spin) * length(convert<double>(arm));
    return dt * (speed + (moves ? dt * length(acceleration) : 0));
}

/// The gap between the two discs of a lane as they are now, m.
template <DiscClass c>
double gap_of(const SceneCore& scene, const DiscBlocks& blocks, std::size_t block, std::size_t lane)
{
    const AlignedVector<BodyPose>& poses = scene.bodies.rows(BodyKind::planar).pose;
    const BlockBodies& bodies = blocks.bodies[block];
    const Vec2<double> between = in_plane(poses[row_at(BodyKind::planar, bodies.b[lane]).row()].position) -
                                 in_plane(poses[row_at(BodyKind::planar, bodies.a[lane]).row()].position);
    const auto row = load_lane<typename DiscFieldsOf<c>::Row>(blocks.rows.data(), block, lane);
    double radii = 0;
    if constexpr (is_rough(c)) {
        radii = static_cast<double>(row.radius_a) + static_cast<double>(row.radius_b);
    } else {
        radii = static_cast<double>(row.reach);
    }
    return std::sqrt(dot(between, between)) - radii;
}

}  // namespace motley
