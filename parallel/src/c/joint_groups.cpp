// Definitions of the C interface that make several joints.
#include "handles.h"
#include "joint_mirrors.h"
#include "motley/c/joints.h"
#include "motley/core/six_dof.h"
#include "motley/core/weld.h"
#include "motley/core/wheel.h"

namespace motley::c {

template <>
inline constexpr int value_count<SixDofRotation> = 2;
static_assert(static_cast<int>(SixDofRotation::about_axes) == MOTLEY_ABOUT_AXES);
static_assert(static_cast<int>(SixDofRotation::euler) == MOTLEY_EULER_ANGLES);

template <>
struct Mirror<motley_axis_setup, AxisSetup> : Pair<motley_axis_setup, AxisSetup> {
    static constexpr auto fields = std::tuple(
        MOTLEY_FIELD(lower), MOTLEY_FIELD(upper), MOTLEY_FIELD(motor_speed), MOTLEY_FIELD(motor_max_force),
        MOTLEY_FIELD(spring_hertz), MOTLEY_FIELD(spring_damping_ratio), MOTLEY_FIELD(spring_stiffness),
        MOTLEY_FIELD(spring_damping), MOTLEY_FIELD(spring_target), MOTLEY_FIELD(spring_max_force),
        MOTLEY_FIELD(armature));
};
template <>
struct Mirror<motley_six_dof_definition, SixDofDefinition>
    : Pair<motley_six_dof_definition, SixDofDefinition> {
    static constexpr const char* name = "motley_six_dof_definition";
    static constexpr auto fields =
        std::tuple(MOTLEY_FIELD(body_a), MOTLEY_FIELD(body_b), MOTLEY_FIELD(frame_a), MOTLEY_FIELD(frame_b),
                   MOTLEY_FIELD(position), MOTLEY_FIELD(rotation), MOTLEY_FIELD(rotations),
                   MOTLEY_FIELD(max_swing), MOTLEY_FIELD(stiffness));
};
template <>
struct Mirror<motley_weld_definition, WeldDefinition> : Pair<motley_weld_definition, WeldDefinition> {
    static constexpr const char* name = "motley_weld_definition";
    static constexpr auto fields =
        std::tuple(MOTLEY_FIELD(body_a), MOTLEY_FIELD(body_b), MOTLEY_FIELD(frame_a), MOTLEY_FIELD(frame_b),
                   MOTLEY_FIELD(linear_hertz), MOTLEY_FIELD(linear_damping_ratio),
                   MOTLEY_FIELD(angular_hertz), MOTLEY_FIELD(angular_damping_ratio));
};
template <>
struct Mirror<motley_weld, Weld> : Pair<motley_weld, Weld> {
    static constexpr auto fields = std::tuple(MOTLEY_FIELD(position), MOTLEY_FIELD(rotation));
};
template <>
struct Mirror<motley_wheel_definition, WheelDefinition> : Pair<motley_wheel_definition, WheelDefinition> {
    static constexpr const char* name = "motley_wheel_definition";
    static constexpr auto fields = std::tuple(
        MOTLEY_FIELD(chassis), MOTLEY_FIELD(wheel), MOTLEY_FIELD(position), MOTLEY_FIELD(suspension),
        MOTLEY_FIELD(axle), MOTLEY_FIELD(wheel_axle), MOTLEY_FIELD(lower), MOTLEY_FIELD(upper),
        MOTLEY_FIELD(spring_hertz), MOTLEY_FIELD(spring_damping_ratio), MOTLEY_FIELD(spring_target),
        MOTLEY_FIELD(motor_speed), MOTLEY_FIELD(motor_max_torque));
};
template <>
struct Mirror<motley_wheel, Wheel> : Pair<motley_wheel, Wheel> {
    static constexpr auto fields =
        std::tuple(MOTLEY_FIELD(line), MOTLEY_FIELD(axle), MOTLEY_FIELD(spring), MOTLEY_FIELD(motor));
};

}  // namespace motley::c

using namespace motley;
using namespace motley::c;

MOTLEY_DEFINE_DEFAULT(six_dof_definition, SixDofDefinition)
MOTLEY_DEFINE_DEFAULT(weld_definition, WeldDefinition)
MOTLEY_DEFINE_DEFAULT(wheel_definition, WheelDefinition)

motley_status motley_scene_add_six_dof(motley_scene* scene, const motley_six_dof_definition* definition,
                                       motley_constraint_id* joints, size_t* count)
{
    return call(__func__, [&] {
        Scene& to = scene_of(scene);
        give_list(MOTLEY_SIX_DOF_JOINTS, joints, "joints", count,
                  [&] { return add_six_dof(to, read<SixDofDefinition>(definition, "definition")); });
    });
}

motley_status motley_figure_add_six_dof(motley_figure* figure, const motley_six_dof_definition* definition)
{
    return call(__func__,
                [&] { figure_of(figure).add_six_dof(read<SixDofDefinition>(definition, "definition")); });
}

motley_status motley_scene_add_weld(motley_scene* scene, const motley_weld_definition* definition,
                                    motley_weld* weld)
{
    return call(__func__, [&] {
        give_handle(weld, add_weld(scene_of(scene), read<WeldDefinition>(definition, "definition")));
    });
}

motley_status motley_scene_add_wheel(motley_scene* scene, const motley_wheel_definition* definition,
                                     motley_wheel* wheel)
{
    return call(__func__, [&] {
        give_handle(wheel, add_wheel(scene_of(scene), read<WheelDefinition>(definition, "definition")));
    });
}

motley_status motley_scene_steer(motley_scene* scene, const motley_wheel* wheel,
                                 const motley_wheel_definition* definition, float angle)
{
    return call(__func__, [&] {
        steer(scene_of(scene), as<Wheel>(need(wheel, "wheel")),
              read<WheelDefinition>(definition, "definition"), angle);
    });
}
