// See wall_ends.h.
#include "scene/wall_ends.h"

#include <algorithm>
#include <cmath>

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

void find_wall_ends(const SceneCore& scene, std::vector<Vec2<double>>& ends)
{
    ends.resize(2 * scene.discs.segments.size());
    const BodyRows& fixed = scene.bodies.rows(BodyKind::fixed);
    for (std::size_t i = 0; i < scene.discs.segments.size(); ++i) {
        const WallSegment& segment = scene.discs.segments[i];
        const std::uint32_t row = scene.bodies.row_of(segment.body).row();
        const Vec2<double> centre = in_plane(fixed.pose[row].position),
                           heading = heading_of(fixed.orientation[row]);
        const auto to_world = [&](const Vec2<double>& p) {
            if (segment.body == scene.ground) return p;
            return centre +
                   Vec2<double>{heading.x * p.x - heading.y * p.y, heading.y * p.x + heading.x * p.y};
        };
        ends[2 * i] = to_world(segment.from);
        ends[2 * i + 1] = to_world(segment.to);
    }
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
