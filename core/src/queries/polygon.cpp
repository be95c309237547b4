// See polygon.h.
#include "motley/core/polygon.h"

#include "motley/core/invalid_input.h"
#include "queries/polygon_checks.h"
#include "queries/polygon_geometry.h"
#include "scene/scene_core.h"

namespace motley {

std::vector<WallId> add_polygon(Scene& scene, const Polygon& polygon, const WallDefinition& like)
{
    if (!like.points.empty())
        refuse("add_polygon.like.points.size()", static_cast<double>(like.points.size()), "no points");
    check_polygon(polygon);
    SceneCore& core = core_of(scene);
    WallDefinition wall = like;
    wall.closed = true;
    std::size_t points = 0;
    for_each_ring(polygon, [&](const std::vector<Vec2<double>>& ring, std::size_t) {
        wall.points = ring;
        core.check_wall(wall);
        points += ring.size();
    });
    const std::size_t rings = polygon.holes.size() + 1;
    core.make_room_for_walls(rings, points);
    std::vector<WallId> walls;
    walls.reserve(rings);
    for_each_ring(polygon, [&](const std::vector<Vec2<double>>& ring, std::size_t) {
        wall.points = ring;
        walls.push_back(core.put_wall(wall));
    });
    return walls;
}

}  // namespace motley
