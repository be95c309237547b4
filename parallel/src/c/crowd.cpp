// Discs and walls of the C interface.
#include "motley/c/crowd.h"

#include <algorithm>

#include "motley/core/crowd.h"
#include "rings.h"

namespace motley::c {

template <>
struct Mirror<motley_disc_definition, DiscDefinition> : Pair<motley_disc_definition, DiscDefinition> {
    static constexpr const char* name = "motley_disc_definition";
    static constexpr auto fields =
        std::tuple(MOTLEY_FIELD(radius), MOTLEY_FIELD(friction), MOTLEY_FIELD(category), MOTLEY_FIELD(mask));
};
template <>
struct Mirror<motley_wall_definition, WallDefinition> : Pair<motley_wall_definition, WallDefinition> {
    static constexpr const char* name = "motley_wall_definition";
    static constexpr std::size_t by_hand = 1;  // the points
    static constexpr auto fields = std::tuple(
        MOTLEY_FIELD(closed), MOTLEY_FIELD(body), MOTLEY_FIELD(friction), MOTLEY_FIELD(category),
        MOTLEY_FIELD(mask), MOTLEY_FIELD(one_way), MOTLEY_FIELD(surface_speed), MOTLEY_FIELD(max_force));
};
template <>
struct Mirror<motley_disc_contact, DiscContact> : Pair<motley_disc_contact, DiscContact> {
    static constexpr auto fields =
        std::tuple(MOTLEY_FIELD(a), MOTLEY_FIELD(b), MOTLEY_FIELD(wall), MOTLEY_FIELD(normal),
                   MOTLEY_FIELD(separation), MOTLEY_FIELD(normal_force), MOTLEY_FIELD(friction_force));
};

namespace {

WallDefinition read_wall(const motley_wall_definition* given, const char* name)
{
    auto wall = read<WallDefinition>(given, name);
    const motley_wall_definition full = in_full<WallDefinition>(given, name);
    wall.points = array<const Vec2<double>>(full.points, full.point_count, "motley_wall_definition.points");
    return wall;
}

}  // namespace
}  // namespace motley::c

using namespace motley;
using namespace motley::c;

MOTLEY_DEFINE_DEFAULT(disc_definition, DiscDefinition)
MOTLEY_DEFINE_DEFAULT(wall_definition, WallDefinition)

motley_status motley_scene_set_disc(motley_scene* scene, motley_body_id body,
                                    const motley_disc_definition* disc)
{
    return call(__func__,
                [&] { scene_of(scene).set_disc(as<BodyId>(body), read<DiscDefinition>(disc, "disc")); });
}

motley_status motley_scene_set_discs(motley_scene* scene, size_t count, const motley_body_id* bodies,
                                     const motley_disc_definition* discs, size_t stride)
{
    return call(__func__, [&] {
        Scene& to = scene_of(scene);
        const std::span<const BodyId> of = bodies_of(bodies, count);
        const auto shapes = read_all<DiscDefinition>(discs, count, stride, "discs");
        to.set_discs(of, shapes);
    });
}

motley_status motley_scene_clear_disc(motley_scene* scene, motley_body_id body)
{
    return call(__func__, [&] { scene_of(scene).clear_disc(as<BodyId>(body)); });
}

motley_status motley_scene_has_disc(const motley_scene* scene, motley_body_id body, motley_bool* has)
{
    return call(__func__, [&] { need(has, "has") = scene_of(scene).has_disc(as<BodyId>(body)); });
}

motley_status motley_scene_add_wall(motley_scene* scene, const motley_wall_definition* definition,
                                    motley_wall_id* wall)
{
    return call(__func__,
                [&] { give_handle(wall, scene_of(scene).add_wall(read_wall(definition, "definition"))); });
}

motley_status motley_scene_remove_wall(motley_scene* scene, motley_wall_id wall)
{
    return call(__func__, [&] { scene_of(scene).remove_wall(as<WallId>(wall)); });
}

motley_status motley_scene_is_wall_alive(const motley_scene* scene, motley_wall_id wall, motley_bool* alive)
{
    return call(__func__, [&] { need(alive, "alive") = scene_of(scene).is_alive(as<WallId>(wall)); });
}

motley_status motley_scene_add_polygon(motley_scene* scene, size_t ring_count, const motley_ring* rings,
                                       const motley_wall_definition* like, motley_wall_id* walls)
{
    return call(__func__, [&] {
        Scene& to = scene_of(scene);
        const Polygon polygon = polygon_of(rings, ring_count);
        const auto ids = array<WallId>(walls, ring_count, "walls");
        const WallDefinition shared = like == nullptr ? WallDefinition{} : read_wall(like, "like");
        const auto added = add_polygon(to, polygon, shared);
        std::copy(added.begin(), added.end(), ids.begin());
    });
}

motley_status motley_scene_disc_contacts(const motley_scene* scene, size_t capacity,
                                         motley_disc_contact* contacts, size_t* count)
{
    return call(__func__, [&] {
        give_list(capacity, contacts, "contacts", count, [&] { return scene_of(scene).disc_contacts(); });
    });
}

motley_status motley_scene_disc_contacts_of(const motley_scene* scene, motley_body_id body, size_t capacity,
                                            motley_disc_contact* contacts, size_t* count)
{
    return call(__func__, [&] {
        give_list(capacity, contacts, "contacts", count,
                  [&] { return scene_of(scene).disc_contacts_of(as<BodyId>(body)); });
    });
}
