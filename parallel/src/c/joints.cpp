// Joints of the C interface: the calls of every type follow from MOTLEY_JOINT_TYPES.
#include "motley/c/joints.h"

#include "contract/constraint_types.h"
#include "joint_mirrors.h"
#include "joint_reports.h"

namespace motley::c {
namespace {

#define MOTLEY_IS_DEFINITION(name, Cpp) || std::is_same_v<Definition, Cpp>
/// Whether a definition is in MOTLEY_JOINT_TYPES.
template <class Definition>
constexpr bool has_calls = false MOTLEY_JOINT_TYPES(MOTLEY_IS_DEFINITION);
#undef MOTLEY_IS_DEFINITION

template <class Definition>
constexpr bool check_calls()
{
    static_assert(has_calls<Definition>,
                  "the C interface lacks this joint: write its struct and its name into "
                  "motley/c/joint_definitions.h and its "
                  "fields into joint_mirrors.h");
    return true;
}
template <class... Types>
constexpr bool all_have_calls(TypeList<Types...>)
{
    return (check_calls<typename Types::Definition>() && ...);
}
static_assert(all_have_calls(AllJointTypes{}));

template <class Definition>
void add_to(Figure& figure, const Definition& definition)
{
    if constexpr (requires { definition.point_a; }) {
        refuse("definition", "a pulley", "a joint without points of the world, which cannot be copied");
    } else {
        figure.add_joint(definition);
    }
}

}  // namespace
}  // namespace motley::c

using namespace motley;
using namespace motley::c;

#define MOTLEY_DEFINE_JOINT(name, Cpp)                                                                       \
    MOTLEY_DEFINE_DEFAULT(name##_definition, Cpp)                                                            \
    motley_status motley_scene_add_##name(motley_scene* scene, const motley_##name##_definition* definition, \
                                          motley_constraint_id* joint)                                       \
    {                                                                                                        \
        return call(__func__, [&] {                                                                          \
            give_handle(joint, scene_of(scene).add_joint(read<Cpp>(definition, "definition")));              \
        });                                                                                                  \
    }                                                                                                        \
    motley_status motley_scene_set_##name(motley_scene* scene, motley_constraint_id joint,                   \
                                          const motley_##name##_definition* definition)                      \
    {                                                                                                        \
        return call(__func__, [&] {                                                                          \
            scene_of(scene).set_joint(as<ConstraintId>(joint), read<Cpp>(definition, "definition"));         \
        });                                                                                                  \
    }                                                                                                        \
    motley_status motley_figure_add_##name(motley_figure* figure,                                            \
                                           const motley_##name##_definition* definition)                     \
    {                                                                                                        \
        return call(__func__, [&] { add_to(figure_of(figure), read<Cpp>(definition, "definition")); });      \
    }
MOTLEY_JOINT_TYPES(MOTLEY_DEFINE_JOINT)

motley_status motley_scene_remove_joint(motley_scene* scene, motley_constraint_id joint)
{
    return call(__func__, [&] { scene_of(scene).remove_joint(as<ConstraintId>(joint)); });
}

motley_status motley_scene_is_joint_alive(const motley_scene* scene, motley_constraint_id joint,
                                          motley_bool* alive)
{
    return call(__func__, [&] { need(alive, "alive") = scene_of(scene).is_alive(as<ConstraintId>(joint)); });
}

motley_status motley_scene_joint_count(const motley_scene* scene, size_t* count)
{
    return call(__func__, [&] { need(count, "count") = scene_of(scene).joint_count(); });
}

motley_status motley_scene_joint_report(const motley_scene* scene, motley_constraint_id joint,
                                        motley_joint_report* report)
{
    return call(__func__, [&] {
        need(report, "report") =
            as<motley_joint_report>(scene_of(scene).joint_report(as<ConstraintId>(joint)));
    });
}

motley_status motley_scene_read_joint_reports(const motley_scene* scene, size_t count,
                                              const motley_constraint_id* joints,
                                              motley_joint_report* reports, size_t stride)
{
    return call(__func__, [&] {
        static_assert(same_layout<motley_joint_report, JointReport>());
        scene_of(scene).read_joint_reports(array<const ConstraintId>(joints, count, "joints"),
                                           strided<JointReport>(reports, count, stride, "reports"));
    });
}

motley_status motley_scene_set_break_limit(motley_scene* scene, motley_constraint_id joint, float force,
                                           float torque)
{
    return call(__func__, [&] { scene_of(scene).set_break_limit(as<ConstraintId>(joint), {force, torque}); });
}

motley_status motley_scene_break_events(const motley_scene* scene, const motley_break_event** events,
                                        size_t* count)
{
    return call(__func__, [&] { give_view(scene_of(scene).break_events(), events, "events", count); });
}

motley_status motley_scene_set_iterations(motley_scene* scene, motley_constraint_id joint, int32_t at_least)
{
    return call(__func__, [&] { scene_of(scene).set_iterations(as<ConstraintId>(joint), at_least); });
}

motley_status motley_scene_set_island_iterations(motley_scene* scene, motley_body_id body, int32_t at_least)
{
    return call(__func__, [&] { scene_of(scene).set_island_iterations(as<BodyId>(body), at_least); });
}
