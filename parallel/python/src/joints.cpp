// Scene: joints of every type, by name. Their fields are those that the C interface lists.
#include "c/joint_mirrors.h"

#include <tuple>

#include "arrays.h"
#include "contract/constraint_types.h"
#include "scene.h"

namespace motley::python {

/// A list of pairs of anchors.
template <std::size_t most>
static void set(const std::string& name, const py::handle& value, ManifoldPoint (&target)[most])
{
    if (!py::isinstance<py::sequence>(value) || py::len(value) > most)
        refuse_value(name, value, "at most " + std::to_string(most) + " pairs of anchors");
    std::size_t i = 0;
    for (const py::handle pair : py::reinterpret_borrow<py::sequence>(value)) {
        const std::string at = name + "[" + std::to_string(i) + "]";
        if (!py::isinstance<py::sequence>(pair) || py::len(pair) != 2) refuse_value(at, pair, "two anchors");
        const auto anchors = py::reinterpret_borrow<py::sequence>(pair);
        set(at, anchors[0], target[i].local_anchor_a);
        set(at, anchors[1], target[i].local_anchor_b);
        ++i;
    }
}

namespace {

/// What Python says of one field of a definition.
template <class Definition, class Member>
void take(const std::string& of, py::dict& left, const char* name, Member Definition::*member,
          Definition& definition)
{
    if (!left.contains(name)) return;
    const py::object value = left.attr("pop")(name);
    set(of + "." + name, value, definition.*member);
}

template <class C, class Definition>
Definition definition_from(const std::string& type, std::uint64_t a, std::uint64_t b,
                           const py::kwargs& fields)
{
    Definition definition;
    py::dict left = fields.attr("copy")();
    std::apply(
        [&](const auto&... field) { (take(type, left, field.name, field.cpp_member, definition), ...); },
        c::Mirror<C, Definition>::fields);
    definition.body_a = id_of<BodyId>(a);
    definition.body_b = id_of<BodyId>(b);
    if (!left.empty()) {
        throw py::type_error("a joint of type " + type + " has no field '" +
                             py::cast<std::string>(py::str(left.begin()->first)) + "'");
    }
    return definition;
}

struct JointType {
    const char* name;
    void (*add_to_figure)(Figure& figure, std::uint64_t a, std::uint64_t b, const py::kwargs& fields);
    ConstraintId (*add)(Scene& scene, std::uint64_t a, std::uint64_t b, const py::kwargs& fields);
    void (*change)(Scene& scene, ConstraintId joint, std::uint64_t a, std::uint64_t b,
                   const py::kwargs& fields);
};

template <class C, class Definition>
constexpr JointType type(const char* name)
{
    return {name,
            [](Figure& figure, std::uint64_t a, std::uint64_t b, const py::kwargs& fields) {
                const auto joint =
                    definition_from<C, Definition>(c::Mirror<C, Definition>::name, a, b, fields);
                if constexpr (requires { joint.point_a; }) {
                    refuse("type", c::Mirror<C, Definition>::name, "a joint without points of the world");
                } else {
                    figure.add_joint(joint);
                }
            },
            [](Scene& scene, std::uint64_t a, std::uint64_t b, const py::kwargs& fields) {
                return scene.add_joint(
                    definition_from<C, Definition>(c::Mirror<C, Definition>::name, a, b, fields));
            },
            [](Scene& scene, ConstraintId joint, std::uint64_t a, std::uint64_t b, const py::kwargs& fields) {
                scene.set_joint(joint,
                                definition_from<C, Definition>(c::Mirror<C, Definition>::name, a, b, fields));
            }};
}

constexpr std::array types{
    type<motley_ball_socket_definition, BallSocketDefinition>("ball_socket"),
    type<motley_distance_definition, DistanceDefinition>("distance"),
    type<motley_frame_joint_definition, FixedDefinition>("fixed"),
    type<motley_frame_joint_definition, HingeDefinition>("hinge"),
    type<motley_frame_joint_definition, SliderDefinition>("slider"),
    type<motley_frame_joint_definition, PointOnPlaneDefinition>("point_on_plane"),
    type<motley_frame_joint_definition, PointOnLineDefinition>("point_on_line"),
    type<motley_frame_joint_definition, RotationLockDefinition>("rotation_lock"),
    type<motley_frame_joint_definition, ParallelAxesDefinition>("parallel_axes"),
    type<motley_frame_joint_definition, PerpendicularAxesDefinition>("perpendicular_axes"),
    type<motley_drive_definition, SlideDriveDefinition>("slide_drive"),
    type<motley_drive_definition, TwistDriveDefinition>("twist_drive"),
    type<motley_drive_definition, EulerDriveDefinition>("euler_drive"),
    type<motley_swing_limit_definition, SwingLimitDefinition>("swing_limit"),
    type<motley_point_servo_definition, PointServoDefinition>("point_servo"),
    type<motley_angular_servo_definition, AngularServoDefinition>("angular_servo"),
    type<motley_gear_definition, GearDefinition>("gear"),
    type<motley_rack_and_pinion_definition, RackAndPinionDefinition>("rack_and_pinion"),
    type<motley_pulley_definition, PulleyDefinition>("pulley"),
    type<motley_manifold_definition, ManifoldDefinition>("manifold"),
    type<motley_screw_definition, ScrewDefinition>("screw"),
};
static_assert(types.size() == AllJointTypes::size, "a type of joint has no name in Python");

const JointType& type_of(const std::string& name)
{
    std::string all;
    for (const JointType& type : types) {
        if (name == type.name) return type;
        all += (all.empty() ? "" : ", ") + std::string(type.name);
    }
    refuse("type", "'" + name + "'", all);
}

py::dict joint_report(PythonScene& scene, std::uint64_t joint)
{
    const JointReport report = scene.get().joint_report(id_of<ConstraintId>(joint));
    constexpr std::array states{"inactive", "active", "lower", "upper"};
    py::dict all;
    all["force"] = tuple_of(report.force);
    all["torque"] = tuple_of(report.torque);
    all["error"] = report.error;
    all["angle_error"] = report.angle_error;
    all["state"] = states[static_cast<std::size_t>(report.state)];
    return all;
}

py::dict break_events(PythonScene& scene)
{
    const std::span<const BreakEvent> events = scene.get().break_events();
    py::dict all;
    all["joint"] = column(events, &BreakEvent::joint);
    all["force"] = column(events, &BreakEvent::force);
    all["torque"] = column(events, &BreakEvent::torque);
    return all;
}

}  // namespace

void add_joint(Figure& figure, const std::string& type, std::uint64_t body_a, std::uint64_t body_b,
               const py::kwargs& fields)
{
    type_of(type).add_to_figure(figure, body_a, body_b, fields);
}

void add_joints_to(SceneClass& scene)
{
    scene.def(
        "add_joint",
        [](PythonScene& self, const std::string& type, std::uint64_t body_a, std::uint64_t body_b,
           const py::kwargs& fields) {
            return number_of(type_of(type).add(self.get(), body_a, body_b, fields));
        },
        py::arg("type"), py::arg("body_a"), py::arg("body_b"),
        "Adds a joint: 'ball_socket', 'hinge', 'slider', 'fixed', 'distance', 'twist_drive', ... "
        "(motley.joint_types). Its\n"
        "fields are those of its definition in C++. A frame is a place, or a dict of position and rotation. "
        "Returns a handle.");
    scene.def(
        "set_joint",
        [](PythonScene& self, std::uint64_t joint, const std::string& type, std::uint64_t body_a,
           std::uint64_t body_b, const py::kwargs& fields) {
            type_of(type).change(self.get(), id_of<ConstraintId>(joint), body_a, body_b, fields);
        },
        py::arg("joint"), py::arg("type"), py::arg("body_a"), py::arg("body_b"),
        "Replaces the definition of a joint: all its fields, of which those that are not given have their "
        "defaults.");
    scene.def(
        "remove_joint",
        [](PythonScene& self, std::uint64_t joint) { self.get().remove_joint(id_of<ConstraintId>(joint)); },
        py::arg("joint"), "Removes a joint.");
    scene.def(
        "set_iterations",
        [](PythonScene& self, std::uint64_t joint, const py::object& at_least) {
            self.get().set_iterations(id_of<ConstraintId>(joint), value_of<int>("at_least", at_least));
        },
        py::arg("joint"), py::arg("at_least"),
        "The least number of sweeps a substep for a joint, 0 to 10000; 0: as the settings say.");
    scene.def("joint_report", &joint_report, py::arg("joint"),
              "Mean force (N) and torque (N m) on body b in the last step, error (m), angle_error (rad) and "
              "state now.");
    scene.def(
        "set_break_limit",
        [](PythonScene& self, std::uint64_t joint, const py::object& force, const py::object& torque) {
            BreakLimit limit;
            if (!force.is_none()) set("force", force, limit.force);
            if (!torque.is_none()) set("torque", torque, limit.torque);
            self.get().set_break_limit(id_of<ConstraintId>(joint), limit);
        },
        py::arg("joint"), py::arg("force") = py::none(), py::arg("torque") = py::none(),
        "break_events() lists the joint after each step in which it bore more than force (N) or torque (N "
        "m); "
        "None: no\n"
        "limit. The joint holds all the same: remove it to break it.");
    scene.def("break_events", &break_events,
              "What the last step asked of joints beyond their limits: arrays joint (handles), force (N) and "
              "torque (N m).");
    scene.def_property_readonly("joint_count", [](PythonScene& self) { return self.get().joint_count(); });
    py::tuple names(types.size());
    for (std::size_t i = 0; i < types.size(); ++i) names[i] = types[i].name;
    scene.attr("joint_types") = names;
}

}  // namespace motley::python
