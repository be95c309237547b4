// Bodies of the C interface.
#include "motley/c/bodies.h"

#include "handles.h"
#include "motley/core/body.h"

namespace motley::c {

template <>
inline constexpr int value_count<BodyModel> = 3;
template <>
inline constexpr int value_count<BodyMotion> = 3;
static_assert(static_cast<int>(BodyModel::particle) == MOTLEY_PARTICLE);
static_assert(static_cast<int>(BodyModel::planar) == MOTLEY_PLANAR);
static_assert(static_cast<int>(BodyModel::rigid) == MOTLEY_RIGID);
static_assert(static_cast<int>(BodyMotion::dynamic_body) == MOTLEY_DYNAMIC_BODY);
static_assert(static_cast<int>(BodyMotion::kinematic_body) == MOTLEY_KINEMATIC_BODY);
static_assert(static_cast<int>(BodyMotion::static_body) == MOTLEY_STATIC_BODY);

template <>
struct Mirror<motley_body_definition, BodyDefinition> : Pair<motley_body_definition, BodyDefinition> {
    static constexpr const char* name = "motley_body_definition";
    static constexpr auto fields = std::tuple(
        MOTLEY_FIELD(model), MOTLEY_FIELD(motion), MOTLEY_FIELD(position), MOTLEY_FIELD(orientation),
        MOTLEY_FIELD(yaw), MOTLEY_FIELD(linear_velocity), MOTLEY_FIELD(angular_velocity), MOTLEY_FIELD(mass),
        MOTLEY_FIELD(inertia), MOTLEY_FIELD(linear_damping), MOTLEY_FIELD(angular_damping));
};
template <>
struct Mirror<motley_body_change, BodyChange> : Pair<motley_body_change, BodyChange> {
    static constexpr const char* name = "motley_body_change";
    static constexpr auto fields = std::tuple(MOTLEY_FIELD(model), MOTLEY_FIELD(inertia));
};
template <>
struct Mirror<motley_body_state, BodyState> : Pair<motley_body_state, BodyState> {
    static constexpr auto fields =
        std::tuple(MOTLEY_FIELD(position), MOTLEY_FIELD(orientation), MOTLEY_FIELD(yaw),
                   MOTLEY_FIELD(linear_velocity), MOTLEY_FIELD(angular_velocity));
};

}  // namespace motley::c

using namespace motley;
using namespace motley::c;

MOTLEY_DEFINE_DEFAULT(body_definition, BodyDefinition)
MOTLEY_DEFINE_DEFAULT(body_change, BodyChange)

motley_status motley_scene_add_body(motley_scene* scene, const motley_body_definition* definition,
                                    motley_body_id* body)
{
    return call(__func__, [&] {
        give_handle(body, scene_of(scene).add_body(read<BodyDefinition>(definition, "definition")));
    });
}

motley_status motley_figure_add_body(motley_figure* figure, const motley_body_definition* definition,
                                     motley_body_id* body)
{
    return call(__func__, [&] {
        give_handle(body, figure_of(figure).add_body(read<BodyDefinition>(definition, "definition")));
    });
}

motley_status motley_scene_add_bodies(motley_scene* scene, size_t count,
                                      const motley_body_definition* definitions, size_t stride,
                                      motley_body_id* bodies)
{
    return call(__func__, [&] {
        Scene& to = scene_of(scene);
        const auto ids = array<BodyId>(bodies, count, "bodies");
        to.add_bodies(read_all<BodyDefinition>(definitions, count, stride, "definitions"), ids);
    });
}

motley_status motley_scene_remove_body(motley_scene* scene, motley_body_id body)
{
    return call(__func__, [&] { scene_of(scene).remove_body(as<BodyId>(body)); });
}

motley_status motley_scene_remove_bodies(motley_scene* scene, size_t count, const motley_body_id* bodies)
{
    return call(__func__, [&] { scene_of(scene).remove_bodies(bodies_of(bodies, count)); });
}

motley_status motley_scene_is_body_alive(const motley_scene* scene, motley_body_id body, motley_bool* alive)
{
    return call(__func__, [&] { need(alive, "alive") = scene_of(scene).is_alive(as<BodyId>(body)); });
}

motley_status motley_scene_ground(const motley_scene* scene, motley_body_id* ground)
{
    return call(__func__, [&] { need(ground, "ground") = as<motley_body_id>(scene_of(scene).ground()); });
}

motley_status motley_scene_body_count(const motley_scene* scene, size_t* count)
{
    return call(__func__, [&] { need(count, "count") = scene_of(scene).body_count(); });
}

motley_status motley_scene_read_bodies(const motley_scene* scene, size_t capacity, motley_body_id* bodies,
                                       size_t* count)
{
    return call(__func__, [&] {
        give_list(capacity, bodies, "bodies", count, [&] {
            std::vector<BodyId> all;
            scene_of(scene).read_bodies(all);
            return all;
        });
    });
}

motley_status motley_scene_body_model(const motley_scene* scene, motley_body_id body,
                                      motley_body_model* model)
{
    return call(__func__, [&] {
        need(model, "model") = static_cast<motley_body_model>(scene_of(scene).model(as<BodyId>(body)));
    });
}

motley_status motley_scene_body_motion(const motley_scene* scene, motley_body_id body,
                                       motley_body_motion* motion)
{
    return call(__func__, [&] {
        need(motion, "motion") = static_cast<motley_body_motion>(scene_of(scene).motion(as<BodyId>(body)));
    });
}

motley_status motley_scene_body_state(const motley_scene* scene, motley_body_id body,
                                      motley_body_state* state)
{
    return call(__func__, [&] {
        need(state, "state") = as<motley_body_state>(scene_of(scene).state(as<BodyId>(body)));
    });
}

motley_status motley_scene_set_pose(motley_scene* scene, motley_body_id body, motley_vec3d position,
                                    motley_quatd orientation, double yaw)
{
    return call(__func__, [&] {
        scene_of(scene).set_pose(as<BodyId>(body), as<Vec3<double>>(position), as<Quat<double>>(orientation),
                                 yaw);
    });
}

motley_status motley_scene_set_velocity(motley_scene* scene, motley_body_id body, motley_vec3f linear,
                                        motley_vec3f angular)
{
    return call(__func__, [&] {
        scene_of(scene).set_velocity(as<BodyId>(body), as<Vec3<float>>(linear), as<Vec3<float>>(angular));
    });
}

motley_status motley_scene_set_force(motley_scene* scene, motley_body_id body, motley_vec3f force,
                                     motley_vec3f torque)
{
    return call(__func__, [&] {
        scene_of(scene).set_force(as<BodyId>(body), as<Vec3<float>>(force), as<Vec3<float>>(torque));
    });
}

motley_status motley_scene_set_mass(motley_scene* scene, motley_body_id body, float mass,
                                    motley_sym3f inertia)
{
    return call(__func__,
                [&] { scene_of(scene).set_mass(as<BodyId>(body), mass, as<Sym3<float>>(inertia)); });
}

motley_status motley_scene_set_damping(motley_scene* scene, motley_body_id body, float linear, float angular)
{
    return call(__func__, [&] { scene_of(scene).set_damping(as<BodyId>(body), linear, angular); });
}

motley_status motley_scene_change_body(motley_scene* scene, motley_body_id body,
                                       const motley_body_change* change)
{
    return call(__func__,
                [&] { scene_of(scene).change_body(as<BodyId>(body), read<BodyChange>(change, "change")); });
}

motley_status motley_scene_set_user_data(motley_scene* scene, motley_body_id body, uint64_t value)
{
    return call(__func__, [&] { scene_of(scene).set_user_data(as<BodyId>(body), value); });
}

motley_status motley_scene_user_data(const motley_scene* scene, motley_body_id body, uint64_t* value)
{
    return call(__func__, [&] { need(value, "value") = scene_of(scene).user_data(as<BodyId>(body)); });
}

motley_status motley_scene_revive(motley_scene* scene, motley_body_id body, motley_vec3d position,
                                  motley_vec3f linear)
{
    return call(__func__, [&] {
        scene_of(scene).revive(as<BodyId>(body), as<Vec3<double>>(position), as<Vec3<float>>(linear));
    });
}

motley_status motley_scene_is_contained(const motley_scene* scene, motley_body_id body,
                                        motley_bool* contained)
{
    return call(__func__,
                [&] { need(contained, "contained") = scene_of(scene).is_contained(as<BodyId>(body)); });
}

motley_status motley_scene_is_asleep(const motley_scene* scene, motley_body_id body, motley_bool* asleep)
{
    return call(__func__, [&] { need(asleep, "asleep") = scene_of(scene).is_asleep(as<BodyId>(body)); });
}

motley_status motley_scene_wake(motley_scene* scene, motley_body_id body)
{
    return call(__func__, [&] { scene_of(scene).wake(as<BodyId>(body)); });
}

motley_status motley_scene_set_velocities(motley_scene* scene, size_t count, const motley_body_id* bodies,
                                          const motley_vec3f* linear, size_t linear_stride,
                                          const motley_vec3f* angular, size_t angular_stride)
{
    return call(__func__, [&] {
        scene_of(scene).set_velocities(
            bodies_of(bodies, count), strided<const Vec3<float>>(linear, count, linear_stride, "linear"),
            strided_or_none<const Vec3<float>>(angular, count, angular_stride, "angular"));
    });
}

motley_status motley_scene_set_forces(motley_scene* scene, size_t count, const motley_body_id* bodies,
                                      const motley_vec3f* forces, size_t force_stride,
                                      const motley_vec3f* torques, size_t torque_stride)
{
    return call(__func__, [&] {
        scene_of(scene).set_forces(
            bodies_of(bodies, count), strided<const Vec3<float>>(forces, count, force_stride, "forces"),
            strided_or_none<const Vec3<float>>(torques, count, torque_stride, "torques"));
    });
}

motley_status motley_scene_read_positions(const motley_scene* scene, size_t count,
                                          const motley_body_id* bodies, motley_vec3d* positions,
                                          size_t stride)
{
    return call(__func__, [&] {
        scene_of(scene).read_positions(bodies_of(bodies, count),
                                       strided<Vec3<double>>(positions, count, stride, "positions"));
    });
}

motley_status motley_scene_read_velocities(const motley_scene* scene, size_t count,
                                           const motley_body_id* bodies, motley_vec3f* linear,
                                           size_t linear_stride, motley_vec3f* angular, size_t angular_stride)
{
    return call(__func__, [&] {
        scene_of(scene).read_velocities(
            bodies_of(bodies, count), strided_or_none<Vec3<float>>(linear, count, linear_stride, "linear"),
            strided_or_none<Vec3<float>>(angular, count, angular_stride, "angular"));
    });
}

motley_status motley_scene_read_yaws(const motley_scene* scene, size_t count, const motley_body_id* bodies,
                                     double* yaws, size_t stride)
{
    return call(__func__, [&] {
        scene_of(scene).read_yaws(bodies_of(bodies, count), strided<double>(yaws, count, stride, "yaws"));
    });
}

motley_status motley_scene_read_orientations(const motley_scene* scene, size_t count,
                                             const motley_body_id* bodies, motley_quatd* orientations,
                                             size_t stride)
{
    return call(__func__, [&] {
        scene_of(scene).read_orientations(bodies_of(bodies, count),
                                          strided<Quat<double>>(orientations, count, stride, "orientations"));
    });
}
