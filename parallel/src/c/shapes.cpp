// Capsules and half-spaces of the C interface.
#include "motley/c/shapes.h"

#include "handles.h"
#include "motley/core/shapes.h"

namespace motley::c {

template <>
struct Mirror<motley_capsule_definition, CapsuleDefinition>
    : Pair<motley_capsule_definition, CapsuleDefinition> {
    static constexpr const char* name = "motley_capsule_definition";
    static constexpr auto fields =
        std::tuple(MOTLEY_FIELD(body), MOTLEY_FIELD(from), MOTLEY_FIELD(to), MOTLEY_FIELD(radius),
                   MOTLEY_FIELD(friction), MOTLEY_FIELD(restitution), MOTLEY_FIELD(category),
                   MOTLEY_FIELD(mask), MOTLEY_FIELD(group));
};
template <>
struct Mirror<motley_half_space_definition, HalfSpaceDefinition>
    : Pair<motley_half_space_definition, HalfSpaceDefinition> {
    static constexpr const char* name = "motley_half_space_definition";
    static constexpr auto fields =
        std::tuple(MOTLEY_FIELD(body), MOTLEY_FIELD(point), MOTLEY_FIELD(normal), MOTLEY_FIELD(friction),
                   MOTLEY_FIELD(restitution), MOTLEY_FIELD(category), MOTLEY_FIELD(mask));
};
template <>
struct Mirror<motley_shape_contact, ShapeContact> : Pair<motley_shape_contact, ShapeContact> {
    static constexpr auto fields = std::tuple(
        MOTLEY_FIELD(a), MOTLEY_FIELD(b), MOTLEY_FIELD(wall), MOTLEY_FIELD(normal), MOTLEY_FIELD(arm_b),
        MOTLEY_FIELD(separation), MOTLEY_FIELD(normal_force), MOTLEY_FIELD(friction_force));
};

}  // namespace motley::c

using namespace motley;
using namespace motley::c;

MOTLEY_DEFINE_DEFAULT(capsule_definition, CapsuleDefinition)
MOTLEY_DEFINE_DEFAULT(half_space_definition, HalfSpaceDefinition)

motley_status motley_scene_add_capsule(motley_scene* scene, const motley_capsule_definition* definition,
                                       motley_shape_id* shape)
{
    return call(__func__, [&] {
        give_handle(shape, scene_of(scene).add_capsule(read<CapsuleDefinition>(definition, "definition")));
    });
}

motley_status motley_figure_add_capsule(motley_figure* figure, const motley_capsule_definition* definition)
{
    return call(__func__,
                [&] { figure_of(figure).add_capsule(read<CapsuleDefinition>(definition, "definition")); });
}

motley_status motley_scene_add_capsules(motley_scene* scene, size_t count,
                                        const motley_capsule_definition* definitions, size_t stride,
                                        motley_shape_id* shapes)
{
    return call(__func__, [&] {
        Scene& to = scene_of(scene);
        const auto ids = array<ShapeId>(shapes, count, "shapes");
        to.add_capsules(read_all<CapsuleDefinition>(definitions, count, stride, "definitions"), ids);
    });
}

motley_status motley_scene_add_half_space(motley_scene* scene, const motley_half_space_definition* definition,
                                          motley_shape_id* shape)
{
    return call(__func__, [&] {
        give_handle(shape,
                    scene_of(scene).add_half_space(read<HalfSpaceDefinition>(definition, "definition")));
    });
}

motley_status motley_scene_remove_shape(motley_scene* scene, motley_shape_id shape)
{
    return call(__func__, [&] { scene_of(scene).remove_shape(as<ShapeId>(shape)); });
}

motley_status motley_scene_is_shape_alive(const motley_scene* scene, motley_shape_id shape,
                                          motley_bool* alive)
{
    return call(__func__, [&] { need(alive, "alive") = scene_of(scene).is_alive(as<ShapeId>(shape)); });
}

motley_status motley_scene_shape_contacts(const motley_scene* scene, size_t capacity,
                                          motley_shape_contact* contacts, size_t* count)
{
    return call(__func__, [&] {
        give_list(capacity, contacts, "contacts", count, [&] { return scene_of(scene).shape_contacts(); });
    });
}

motley_status motley_scene_shape_contacts_of(const motley_scene* scene, motley_body_id body, size_t capacity,
                                             motley_shape_contact* contacts, size_t* count)
{
    return call(__func__, [&] {
        give_list(capacity, contacts, "contacts", count,
                  [&] { return scene_of(scene).shape_contacts_of(as<BodyId>(body)); });
    });
}
