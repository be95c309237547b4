// Scene: many bodies at once, over the memory of numpy.
#include "arrays.h"
#include "scene.h"

namespace motley::python {
namespace {

/// Adds a body at each place, which share the other fields.
py::array_t<std::uint64_t> add_bodies(PythonScene& scene, const py::object& positions, const py::object& mass,
                                      const py::object& model, const py::object& inertia)
{
    const std::vector<Vec3<double>> places = places_from("positions", positions);
    const std::vector<float> masses = for_each_of<float>("mass", mass, places.size());
    BodyDefinition like;
    set("model", model, like.model);
    set("inertia", inertia, like.inertia);
    std::vector<BodyDefinition> bodies(places.size(), like);
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        bodies[i].position = places[i];
        bodies[i].mass = masses[i];
    }
    std::vector<BodyId> ids(bodies.size());
    scene.get().add_bodies(bodies, ids);
    return handles_of<BodyId>(ids);
}

void set_velocities(PythonScene& scene, const py::object& bodies, const py::object& linear,
                    const py::object& angular)
{
    const Handles ids("bodies", bodies);
    const Input<float, Vec3<float>> velocities("linear", linear, ids.size());
    if (angular.is_none()) {
        scene.get().set_velocities(ids.span<BodyId>(), velocities.span());
        return;
    }
    const Input<float, Vec3<float>> spins("angular", angular, ids.size());
    scene.get().set_velocities(ids.span<BodyId>(), velocities.span(), spins.span());
}

void set_forces(PythonScene& scene, const py::object& bodies, const py::object& forces,
                const py::object& torques)
{
    const Handles ids("bodies", bodies);
    const Input<float, Vec3<float>> pulls("forces", forces, ids.size());
    if (torques.is_none()) {
        scene.get().set_forces(ids.span<BodyId>(), pulls.span());
        return;
    }
    const Input<float, Vec3<float>> turns("torques", torques, ids.size());
    scene.get().set_forces(ids.span<BodyId>(), pulls.span(), turns.span());
}

py::array read_positions(PythonScene& scene, const py::object& bodies, const py::object& out)
{
    const Handles ids("bodies", bodies);
    Output<double, Vec3<double>> positions("out", out, ids.size());
    scene.get().read_positions(ids.span<BodyId>(), positions.span());
    return positions.array();
}
py::array read_velocities(PythonScene& scene, const py::object& bodies, const py::object& out)
{
    const Handles ids("bodies", bodies);
    Output<float, Vec3<float>> velocities("out", out, ids.size());
    scene.get().read_velocities(ids.span<BodyId>(), velocities.span());
    return velocities.array();
}
py::array read_angular_velocities(PythonScene& scene, const py::object& bodies, const py::object& out)
{
    const Handles ids("bodies", bodies);
    Output<float, Vec3<float>> spins("out", out, ids.size());
    scene.get().read_velocities(ids.span<BodyId>(), {}, spins.span());
    return spins.array();
}
py::array read_yaws(PythonScene& scene, const py::object& bodies, const py::object& out)
{
    const Handles ids("bodies", bodies);
    Output<double, double> yaws("out", out, ids.size());
    scene.get().read_yaws(ids.span<BodyId>(), yaws.span());
    return yaws.array();
}
py::array read_orientations(PythonScene& scene, const py::object& bodies, const py::object& out)
{
    const Handles ids("bodies", bodies);
    Output<double, Quat<double>> orientations("out", out, ids.size());
    scene.get().read_orientations(ids.span<BodyId>(), orientations.span());
    return orientations.array();
}

}  // namespace

void add_bulk_calls_to(SceneClass& scene)
{
    const py::object none = py::none();
    scene.def("add_bodies", &add_bodies, py::arg("positions"), py::arg("mass") = 1.0,
              py::arg("model") = "rigid", py::arg("inertia") = 1.0,
              "Adds a body at each of positions (n x 2 or n x 3, m). mass: kg, of all or of each. Returns "
              "their handles, an\n"
              "array of uint64.");
    scene.def(
        "bodies",
        [](PythonScene& self) {
            std::vector<BodyId> ids;
            self.get().read_bodies(ids);
            return handles_of<BodyId>(ids);
        },
        "The handles of all bodies but the ground, in the order of their slots.");
    scene.def("set_velocities", &set_velocities, py::arg("bodies"), py::arg("linear"),
              py::arg("angular") = none,
              "Sets velocities (n x 3, m/s and rad/s). Arrays of float32 are read where they lie, others are "
              "converted.");
    scene.def("set_forces", &set_forces, py::arg("bodies"), py::arg("forces"), py::arg("torques") = none,
              "Sets forces (n x 3, N) and torques (N m) that act until changed. Read as by set_velocities.");
    scene.def("read_positions", &read_positions, py::arg("bodies"), py::arg("out") = none,
              "Centres of mass, n x 3, float64, m; written into `out`, without a copy, where it is given.");
    scene.def("read_velocities", &read_velocities, py::arg("bodies"), py::arg("out") = none,
              "Velocities, n x 3, float32, m/s; likewise.");
    scene.def("read_angular_velocities", &read_angular_velocities, py::arg("bodies"), py::arg("out") = none,
              "Angular velocities, n x 3, float32, rad/s; likewise.");
    scene.def("read_yaws", &read_yaws, py::arg("bodies"), py::arg("out") = none,
              "Turns about z of planar bodies, n, float64, rad; likewise.");
    scene.def("read_orientations", &read_orientations, py::arg("bodies"), py::arg("out") = none,
              "Orientations, n x 4 (x, y, z, w), float64; likewise.");
}

}  // namespace motley::python
