// Figure, and many copies of one in a scene.
#include "arrays.h"
#include "motley/core/assembly.h"
#include "scene.h"

namespace motley::python {
namespace {

/// The bodies of each copy in a row of an array.
py::array_t<std::uint64_t> add_copies(PythonScene& scene, const Figure& figure, const py::object& positions,
                                      const py::object& orientations, const py::object& linear_velocities)
{
    const std::vector<Vec3<double>> places = places_from("positions", positions);
    std::vector<Placing> placings(places.size());
    for (std::size_t i = 0; i < placings.size(); ++i) placings[i].position = places[i];
    if (!orientations.is_none()) {
        const Input<double, Quat<double>> turns("orientations", orientations, placings.size());
        for (std::size_t i = 0; i < placings.size(); ++i) placings[i].orientation = turns.span()[i];
    }
    if (!linear_velocities.is_none()) {
        const Input<float, Vec3<float>> speeds("linear_velocities", linear_velocities, placings.size());
        for (std::size_t i = 0; i < placings.size(); ++i) placings[i].linear_velocity = speeds.span()[i];
    }
    const py::array_t<std::uint64_t> bodies = handles_of<BodyId>(add_assembly(scene.get(), figure, placings));
    return bodies.attr("reshape")(placings.size(), figure.bodies().size());
}

}  // namespace

void add_assemblies_to(py::module_& module, SceneClass& scene)
{
    py::class_<Figure>(module, "Figure",
                       "Bodies, joints and capsules to be copied, in the frame of the figure: "
                       "Scene.add_assembly adds copies.")
        .def(py::init<>())
        .def("__len__", [](const Figure& self) { return self.bodies().size(); })
        .def(
            "add_body",
            [](Figure& self, const py::kwargs& fields) {
                return number_of(self.add_body(body_from(fields)));
            },
            "As Scene.add_body. Its handle is for calls of this figure.")
        .def("add_joint", &add_joint, py::arg("type"), py::arg("body_a"), py::arg("body_b"),
             "As Scene.add_joint, between bodies of this figure.")
        .def(
            "add_six_dof",
            [](Figure& self, std::uint64_t body_a, std::uint64_t body_b, const py::kwargs& fields) {
                self.add_six_dof(six_dof_from(body_a, body_b, fields));
            },
            py::arg("body_a"), py::arg("body_b"), "As Scene.add_six_dof, between bodies of this figure.")
        .def(
            "add_capsule",
            [](Figure& self, std::uint64_t body, const py::object& start, const py::object& end,
               const py::kwargs& fields) { self.add_capsule(capsule_from(body, start, end, fields)); },
            py::arg("body"), py::arg("start"), py::arg("end"),
            "As Scene.add_capsule, on a body of this figure.");
    scene.def(
        "add_assembly", &add_copies, py::arg("figure"), py::arg("positions"),
        py::arg("orientations") = py::none(), py::arg("linear_velocities") = py::none(),
        "Adds a copy of a Figure at each of positions (n x 3, m), turned by orientations (n x 4) and "
        "moving with\n"
        "linear_velocities (n x 3, m/s). Returns handles: a row for each copy, in the order of the figure.");
}

}  // namespace motley::python
