// Scene: bodies one by one.
#include "arrays.h"
#include "scene.h"

namespace motley::python {

BodyDefinition body_from(const py::kwargs& arguments)
{
    BodyDefinition body;
    Keywords given("BodyDefinition", arguments);
    given.take("model", body.model);
    given.take("motion", body.motion);
    given.take("position", body.position);
    given.take("orientation", body.orientation);
    given.take("yaw", body.yaw);
    given.take("linear_velocity", body.linear_velocity);
    given.take("angular_velocity", body.angular_velocity);
    given.take("mass", body.mass);
    given.take("inertia", body.inertia);
    given.take("linear_damping", body.linear_damping);
    given.take("angular_damping", body.angular_damping);
    given.end();
    return body;
}

namespace {

py::dict state_of(PythonScene& scene, std::uint64_t body)
{
    const BodyState state = scene.get().state(id_of<BodyId>(body));
    py::dict all;
    all["position"] = tuple_of(state.position);
    all["orientation"] = tuple_of(state.orientation);
    all["yaw"] = state.yaw;
    all["linear_velocity"] = tuple_of(state.linear_velocity);
    all["angular_velocity"] = tuple_of(state.angular_velocity);
    return all;
}

}  // namespace

void add_bodies_to(SceneClass& scene)
{
    scene.def(
        "add_body",
        [](PythonScene& self, const py::kwargs& fields) {
            return number_of(self.get().add_body(body_from(fields)));
        },
        "Adds a body, whose fields are those of BodyDefinition: model ('particle', 'planar' or 'rigid'), "
        "motion\n"
        "('dynamic', 'kinematic' or 'static'), position (m), orientation (x, y, z, w), yaw (rad), "
        "linear_velocity (m/s),\n"
        "angular_velocity (rad/s), mass (kg), inertia (kg m2: a number, or xx, xy, xz, yy, yz, zz), "
        "linear_damping and\n"
        "angular_damping (1/s). Returns its handle.");
    scene.def(
        "remove_body",
        [](PythonScene& self, std::uint64_t body) { self.get().remove_body(id_of<BodyId>(body)); },
        py::arg("body"), "Removes a body and every joint on it.");
    scene.def(
        "remove_bodies",
        [](PythonScene& self, const py::object& bodies) {
            self.get().remove_bodies(Handles("bodies", bodies).span<BodyId>());
        },
        py::arg("bodies"), "Removes many, or none.");
    scene.def(
        "is_alive",
        [](PythonScene& self, std::uint64_t body) { return self.get().is_alive(id_of<BodyId>(body)); },
        py::arg("body"), "Whether a body is in the scene.");
    scene.def("state", &state_of, py::arg("body"),
              "Position (m), orientation (x, y, z, w), yaw (rad), linear_velocity (m/s) and angular_velocity "
              "(rad/s) of a\n"
              "body, as a dict.");
    scene.def(
        "set_pose",
        [](PythonScene& self, std::uint64_t body, const py::object& position, const py::object& orientation,
           const py::object& yaw) {
            self.get().set_pose(id_of<BodyId>(body), value_of<Vec3<double>>("position", position),
                                value_of<Quat<double>>("orientation", orientation),
                                value_of<double>("yaw", yaw));
        },
        py::arg("body"), py::arg("position"), py::arg("orientation") = py::make_tuple(0, 0, 0, 1),
        py::arg("yaw") = 0, "Teleports a body.");
    scene.def(
        "set_velocity",
        [](PythonScene& self, std::uint64_t body, const py::object& linear, const py::object& angular) {
            self.get().set_velocity(id_of<BodyId>(body), value_of<Vec3<float>>("linear", linear),
                                    value_of<Vec3<float>>("angular", angular));
        },
        py::arg("body"), py::arg("linear"), py::arg("angular") = py::make_tuple(0, 0, 0),
        "Sets the velocity of a body, m/s and rad/s.");
    scene.def(
        "set_force",
        [](PythonScene& self, std::uint64_t body, const py::object& force, const py::object& torque) {
            self.get().set_force(id_of<BodyId>(body), value_of<Vec3<float>>("force", force),
                                 value_of<Vec3<float>>("torque", torque));
        },
        py::arg("body"), py::arg("force"), py::arg("torque") = py::make_tuple(0, 0, 0),
        "Sets a force (N) and a torque (N m) that act in every step until changed.");
    scene.def(
        "set_mass",
        [](PythonScene& self, std::uint64_t body, const py::object& mass, const py::object& inertia) {
            self.get().set_mass(id_of<BodyId>(body), value_of<float>("mass", mass),
                                value_of<Sym3<float>>("inertia", inertia));
        },
        py::arg("body"), py::arg("mass"), py::arg("inertia"),
        "Changes the mass (kg) and the inertia (kg m2, as of add_body) of a dynamic body; its velocities "
        "stay.");
    scene.def(
        "set_damping",
        [](PythonScene& self, std::uint64_t body, const py::object& linear, const py::object& angular) {
            self.get().set_damping(id_of<BodyId>(body), value_of<float>("linear", linear),
                                   value_of<float>("angular", angular));
        },
        py::arg("body"), py::arg("linear"), py::arg("angular") = 0, "Changes the damping (1/s) of a body.");
    scene.def(
        "change_body",
        [](PythonScene& self, std::uint64_t body, const py::object& model, const py::object& inertia) {
            self.get().change_body(id_of<BodyId>(body), {value_of<BodyModel>("model", model),
                                                         value_of<Sym3<float>>("inertia", inertia)});
        },
        py::arg("body"), py::arg("model"), py::arg("inertia") = 1,
        "Gives a dynamic body another model in place; its handle, momentum and contacts stay.");
    scene.def(
        "is_asleep",
        [](PythonScene& self, std::uint64_t body) { return self.get().is_asleep(id_of<BodyId>(body)); },
        py::arg("body"), "Whether a body rests and costs nothing: see SolverSettings.sleep_speed.");
    scene.def(
        "wake", [](PythonScene& self, std::uint64_t body) { self.get().wake(id_of<BodyId>(body)); },
        py::arg("body"), "Wakes the island of a body.");
    scene.def(
        "is_contained",
        [](PythonScene& self, std::uint64_t body) { return self.get().is_contained(id_of<BodyId>(body)); },
        py::arg("body"), "Whether a body was frozen because its state became infinite or NaN.");
    scene.def(
        "revive",
        [](PythonScene& self, std::uint64_t body, const py::object& position, const py::object& linear) {
            self.get().revive(id_of<BodyId>(body), value_of<Vec3<double>>("position", position),
                              value_of<Vec3<float>>("linear", linear));
        },
        py::arg("body"), py::arg("position"), py::arg("linear") = py::make_tuple(0, 0, 0),
        "Lets a frozen body move again, from position (m) with the velocity linear (m/s).");
    scene.def(
        "set_island_iterations",
        [](PythonScene& self, std::uint64_t body, const py::object& at_least) {
            self.get().set_island_iterations(id_of<BodyId>(body), value_of<int>("at_least", at_least));
        },
        py::arg("body"), py::arg("at_least"),
        "The least number of sweeps a substep for the island of a body, 0 to 10000; 0: as the settings say.");
}

}  // namespace motley::python
