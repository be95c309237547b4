// See wall_ends.h.
#include "scene/wall_ends.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace motley {
namespace {

/// The rotation of a body about z.
Vec2<double> heading_of(const Quat<PoseReal>& q)
{
    const auto x = static_cast<double>(q.x), y = static_cast<double>(q.y), z = static_cast<double>(q.z),
               w = static_cast<double>(q.w);
    const double cosine = 1 - 2 * (y * y + z * z), sine = 2 * (x * y + z * w);
    const double length = std::sqrt(cosine * cosine + sine * sine);
    return length > 0 ? Vec2<double>{cosine / length, sine / length} : Vec2<double>{1, 0};
}

}  // namespace

std::pair<Vec2<double>, Vec2<double>> wall_ends_of(const SceneCore& scene, const WallSegment& segment)
{
    if (segment.body == scene.ground) return {segment.from, segment.to};
    const BodyRows& fixed = scene.bodies.rows(BodyKind::fixed);
    const std::uint32_t row = scene.bodies.row_of(segment.body).row();
    const Vec2<double> centre = in_plane(fixed.pose[row].position),
                       heading = heading_of(fixed.orientation[row]);
    const auto to_world = [&](const Vec2<double>& p) {
        return centre + Vec2<double>{heading.x * p.x - heading.y * p.y, heading.y * p.x + heading.x * p.y};
    };
    return {to_world(segment.from), to_world(segment.to)};
}

void find_wall_ends(const SceneCore& scene, Array<Vec2<double>>& ends)
{
    ends.resize(2 * scene.discs.segments.size());
    for (std::size_t i = 0; i < scene.discs.segments.size(); ++i)
        std::tie(ends[2 * i], ends[2 * i + 1]) = wall_ends_of(scene, scene.discs.segments[i]);
}

double speed_of_wall(const SceneCore& scene, const WallSegment& segment)
{
    const BodyRows& fixed = scene.bodies.rows(BodyKind::fixed);
    const float* v = &fixed.velocity[std::size_t{8} * scene.bodies.row_of(segment.body).row()];
    const auto x = static_cast<double>(v[0]), y = static_cast<double>(v[1]), w = static_cast<double>(v[6]);
    if (x == 0 && y == 0 && w == 0) return 0;
    const double arm2 = std::max(dot(segment.from, segment.from), dot(segment.to, segment.to));
    return std::sqrt(x * x + y * y) + std::abs(w) * std::sqrt(arm2);
}

double fastest_wall_end(const SceneCore& scene)
{
    double fastest = 0;
    for (const WallSegment& segment : scene.discs.segments)
        fastest = std::max(fastest, speed_of_wall(scene, segment));
    return fastest;
}

}  // namespace motley
