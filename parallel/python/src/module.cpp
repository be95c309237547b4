// The module motley._motley: what of the library is written in C++. motley/__init__.py is its face.
#include "arrays.h"
#include "reports.h"
#include "scene.h"

namespace motley::python {
namespace {

/// motley.InvalidInput, a ValueError with the field, the value and the valid range of the message.
void raise_invalid_input(const InvalidInput& refused)
{
    const py::object type = py::module_::import("motley._errors").attr("InvalidInput");
    PyErr_SetObject(type.ptr(), type(refused.what()).ptr());
}

void add_whole_scene_to(SceneClass& scene)
{
    scene.def(py::init<>());
    scene.def_property_readonly(
        "ground", [](PythonScene& self) { return number_of(self.get().ground()); },
        "The static body at the origin, to which joints with the world are attached.");
    scene.def(
        "__len__", [](PythonScene& self) { return self.get().body_count(); }, "Bodies without the ground.");
    scene.def(
        "copy", [](PythonScene& self) { return PythonScene(self.get()); },
        "Another scene that goes on from here with the same bits; handles are valid in both.");
    scene.def(
        "state_hash", [](PythonScene& self) { return self.get().state_hash(); },
        "64 bits of every position, orientation and velocity: equal on every machine and for any number of "
        "threads.");
    scene.def(
        "to_bytes",
        [](PythonScene& self) {
            const std::vector<std::byte> bytes = save_scene(self.get());
            return py::bytes(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        },
        "The whole scene as bytes, from which from_bytes goes on with the same bits.");
    scene.def_static(
        "from_bytes",
        [](const py::bytes& bytes) {
            const auto text = static_cast<std::string_view>(bytes);
            return PythonScene(load_scene(std::as_bytes(std::span(text.data(), text.size()))));
        },
        py::arg("bytes"),
        "The scene that to_bytes wrote. Raises RuntimeError that says what is wrong with other bytes.");
    scene.def(
        "errors", [](PythonScene& self) { return dict_of(self.get().errors()); },
        "Errors of joints (m, rad; rms and max), kinetic energy (J) and momentum (kg m/s) now, as a dict.");
    scene.def_property_readonly(
        "last_step", [](PythonScene& self) { return self.get().last_step(); },
        "Seconds that the last step took: impulses divided by it are mean forces.");
    scene.def(
        "contact_impulses",
        [](PythonScene& self) {
            const std::span<const ContactImpulse> impulses = self.get().contact_impulses();
            py::dict all;
            all["normal"] = column(impulses, &ContactImpulse::normal);
            all["friction"] = column(impulses, &ContactImpulse::friction);
            return all;
        },
        "The impulses (N s) on body_b of the host's contacts in the last step, in their order: arrays normal "
        "and friction\n"
        "(n x 3, world).");
}

}  // namespace
}  // namespace motley::python

PYBIND11_MODULE(_motley, module)
{
    using namespace motley::python;
    module.doc() = "Rigid-body constraints for crowds. Import motley, not this.";
    py::register_exception_translator([](std::exception_ptr thrown) {
        try {
            if (thrown) std::rethrow_exception(thrown);
        } catch (const motley::InvalidInput& refused) {
            raise_invalid_input(refused);
        }
    });
    SceneClass scene(module, "Scene",
                     "Bodies, joints, people and walls. Handles are whole numbers. While a step runs on "
                     "another thread of Python\n"
                     "every call raises RuntimeError.");
    add_whole_scene_to(scene);
    add_bodies_to(scene);
    add_bulk_calls_to(scene);
    add_crowds_to(scene);
    add_joints_to(scene);
    add_shapes_to(scene);
    add_composed_joints_to(scene);
    add_assemblies_to(module, scene);
    add_queries_to(module);
    add_solver_to(module);
}
