// Scene: joints that are composed of several: those of six degrees of freedom, and welds.
#include "motley/core/six_dof.h"

#include "arrays.h"
#include "motley/core/weld.h"
#include "scene.h"

namespace motley::python {

static void set(const std::string& name, const py::handle& value, AxisSetup& target)
{
    if (py::isinstance<py::str>(value)) {
        constexpr std::array names{"locked", "free"};
        enum class Way : std::uint8_t { locked, free };
        target = named<Way>(name, value, names) == Way::free ? AxisSetup::free() : AxisSetup::locked();
        return;
    }
    if (!py::isinstance<py::dict>(value)) {
        const auto limits = numbers_from<2>(name, value);
        target = AxisSetup::limited(static_cast<float>(limits[0]), static_cast<float>(limits[1]));
        return;
    }
    Keywords given(name, py::reinterpret_borrow<py::kwargs>(value));
    given.take("lower", target.lower);
    given.take("upper", target.upper);
    given.take("motor_speed", target.motor_speed);
    given.take("motor_max_force", target.motor_max_force);
    given.take("spring_hertz", target.spring_hertz);
    given.take("spring_damping_ratio", target.spring_damping_ratio);
    given.take("spring_stiffness", target.spring_stiffness);
    given.take("spring_damping", target.spring_damping);
    given.take("spring_target", target.spring_target);
    given.take("spring_max_force", target.spring_max_force);
    given.take("armature", target.armature);
    given.end();
}
void set(const std::string& name, const py::handle& value, AxisSetup (&target)[3])
{
    if (py::isinstance<py::str>(value) || !py::isinstance<py::sequence>(value) || py::len(value) != 3)
        refuse_value(name, value, "three axes");
    const auto axes = py::reinterpret_borrow<py::sequence>(value);
    for (std::size_t i = 0; i < 3; ++i) set(name + "[" + std::to_string(i) + "]", axes[i], target[i]);
}

SixDofDefinition six_dof_from(std::uint64_t body_a, std::uint64_t body_b, const py::kwargs& fields)
{
    SixDofDefinition definition;
    definition.body_a = id_of<BodyId>(body_a);
    definition.body_b = id_of<BodyId>(body_b);
    Keywords given("SixDofDefinition", fields);
    given.take("frame_a", definition.frame_a);
    given.take("frame_b", definition.frame_b);
    given.take("position", definition.position);
    given.take("rotation", definition.rotation);
    given.take("rotations", definition.rotations);
    given.take("max_swing", definition.max_swing);
    given.take("stiffness", definition.stiffness);
    given.end();
    return definition;
}

void add_composed_joints_to(SceneClass& scene)
{
    scene.def(
        "add_six_dof",
        [](PythonScene& self, std::uint64_t body_a, std::uint64_t body_b, const py::kwargs& fields) {
            const SixDofDefinition definition = six_dof_from(body_a, body_b, fields);
            return handles_of<ConstraintId>(add_six_dof(self.get(), definition));
        },
        py::arg("body_a"), py::arg("body_b"),
        "Adds a joint of six degrees of freedom: position and rotation are three axes each, of which one is "
        "'locked' (the\n"
        "default), 'free', a pair of limits (m or rad), or a dict with fields of AxisSetup. Other fields: "
        "frame_a, frame_b,\n"
        "rotations ('about_axes' or 'euler'), max_swing (rad), stiffness. Returns the handles of the joints "
        "that it becomes.");
    scene.def(
        "add_weld",
        [](PythonScene& self, std::uint64_t body_a, std::uint64_t body_b, const py::kwargs& fields) {
            WeldDefinition definition;
            definition.body_a = id_of<BodyId>(body_a);
            definition.body_b = id_of<BodyId>(body_b);
            Keywords given("WeldDefinition", fields);
            given.take("frame_a", definition.frame_a);
            given.take("frame_b", definition.frame_b);
            given.take("linear_hertz", definition.linear_hertz);
            given.take("linear_damping_ratio", definition.linear_damping_ratio);
            given.take("angular_hertz", definition.angular_hertz);
            given.take("angular_damping_ratio", definition.angular_damping_ratio);
            given.end();
            const Weld weld = add_weld(self.get(), definition);
            return py::make_tuple(number_of(weld.position), number_of(weld.rotation));
        },
        py::arg("body_a"), py::arg("body_b"),
        "Adds a joint that holds frame_b on frame_a, rigidly or by springs: of linear_hertz in translation "
        "and of angular_hertz\n"
        "in rotation (Hz; 0, the default: rigid), with linear_damping_ratio and angular_damping_ratio "
        "(default 1). Returns the\n"
        "handles of its two joints, of which the second is 0 where both are rigid.");
}

}  // namespace motley::python
