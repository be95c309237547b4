// See wall_ends.h.
#include "scene/wall_ends.h"

#include <cmath>

namespace motley {
namespace {

Vec2<double> in_plane(const Vec3<PoseReal>& v)
{
    return {static_cast<double>(v.x), static_cast<double>(v.y)};
}

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

}  // namespace motley
