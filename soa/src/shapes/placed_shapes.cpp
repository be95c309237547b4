// See placed_shapes.h.
#include "shapes/placed_shapes.h"

#include <algorithm>
#include <cmath>

#include "maths/scalar.h"

namespace motley {
namespace {

double length_of(const Vec3<double>& v)
{
    return std::sqrt(dot(v, v));
}

/// The orientation of a body from body to world. That of a planar one has the same bits on every system.
Quat<double> orientation_of(const BodyRows& rows, BodyRow where)
{
    if (quads_of(where.kind()) == 2) return convert<double>(rows.orientation[where.row()]);
    if (where.kind() == BodyKind::particle) return {0, 0, 0, 1};
    constexpr double turn = 6.283185307179586;
    double yaw = static_cast<double>(rows.pose[where.row()].yaw);
    if (std::abs(yaw) > turn / 2) yaw = std::remainder(yaw, turn);
    const SineCosine<double> half = sine_cosine(yaw / 2);
    return {0, 0, half.sine, half.cosine};
}

struct Speeds {
    double linear = 0, angular = 0;  ///< m/s, rad/s
};
Speeds speeds_of(const SceneCore& scene, BodyRow where)
{
    const SceneCore::Velocity now = scene.velocity(where);
    return {length_of(convert<double>(now.linear)), length_of(convert<double>(now.angular))};
}

}  // namespace

PlacedCapsule placed(const SceneCore& scene, const Capsule& capsule, double dt)
{
    const BodyRow where = scene.bodies.row_of(capsule.body);
    const BodyRows& rows = scene.bodies.rows(where.kind());
    const Quat<double> orientation = orientation_of(rows, where);
    const Vec3<double> from = convert<double>(capsule.from), to = convert<double>(capsule.to);
    const double arm = std::sqrt(std::max(dot(from, from), dot(to, to)));
    const Speeds speeds = speeds_of(scene, where);
    PlacedCapsule placed;
    placed.centre = convert<double>(rows.pose[where.row()].position);
    placed.axis = {placed.centre + rotate(orientation, from), rotate(orientation, to - from)};
    placed.middle = placed.axis.at(0.5);
    placed.radius = static_cast<double>(capsule.radius);
    placed.goes = dt * (speeds.linear + speeds.angular * (arm + placed.radius));
    placed.is_flat = where.kind() == BodyKind::planar;
    placed.can_move = where.kind() != BodyKind::fixed;
    placed.is_static = !placed.can_move && scene.bodies.motion(capsule.body) == BodyMotion::static_body;
    return placed;
}

PlacedHalfSpace placed(const SceneCore& scene, const HalfSpace& half_space, double dt)
{
    const BodyRow where = scene.bodies.row_of(half_space.body);
    const BodyRows& rows = scene.bodies.rows(where.kind());
    const Quat<double> orientation = orientation_of(rows, where);
    const Speeds speeds = speeds_of(scene, where);
    const Vec3<double> centre = convert<double>(rows.pose[where.row()].position);
    return {centre + rotate(orientation, half_space.point),
            rotate(orientation, convert<double>(half_space.normal)), centre, dt * speeds.linear,
            dt * speeds.angular};
}

PlacedCapsule placed_disc(const SceneCore& scene, std::uint32_t planar_row, const DiscShape& disc, double dt)
{
    const BodyRows& rows = scene.bodies.rows(BodyKind::planar);
    PlacedCapsule placed;
    placed.axis.from = convert<double>(rows.pose[planar_row].position);
    placed.middle = placed.centre = placed.axis.from;
    placed.radius = static_cast<double>(disc.radius);
    placed.goes = dt * speeds_of(scene, {BodyKind::planar, planar_row}).linear;
    placed.is_flat = true;
    placed.can_move = true;
    return placed;
}

}  // namespace motley
