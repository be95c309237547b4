// Solver, its settings, and the list of contacts of a step.
#include "motley/parallel/solver.h"

#include <cstddef>
#include <tuple>

#include "arrays.h"
#include "c/solver_mirrors.h"
#include "reports.h"
#include "scene.h"

namespace motley::python {
namespace {

constexpr auto& setting_fields = c::Mirror<motley_solver_settings, SolverSettings>::fields;

template <class Member>
void take(py::dict& left, const char* name, Member SolverSettings::*member, SolverSettings& settings)
{
    if (!left.contains(name)) return;
    const py::object value = left.attr("pop")(name);
    set("SolverSettings." + std::string(name), value, settings.*member);
}

/// These settings, with those changed that are given by name.
SolverSettings changed(SolverSettings settings, const py::kwargs& given)
{
    py::dict left = given.attr("copy")();
    std::apply([&](const auto&... field) { (take(left, field.name, field.cpp_member, settings), ...); },
               setting_fields);
    if (!left.empty())
        throw py::type_error("SolverSettings has no field '" +
                             py::cast<std::string>(py::str(left.begin()->first)) + "'");
    return settings;
}

Solver make_solver(int threads, const py::object& isa, std::size_t alone_below, const py::kwargs& settings)
{
    SolverOptions options;
    options.threads = threads;
    options.alone_below = alone_below;
    if (!isa.is_none())
        options.isa = named<Isa>("isa", isa, std::array{"scalar", "sse2", "avx2", "avx512", "neon"});
    return Solver(changed({}, settings), options);
}

/// The type of an array of contacts: that of Contact in memory.
py::dtype contact_dtype()
{
    const auto vector = py::dtype::from_args(py::make_tuple("f4", py::make_tuple(3)));
    const py::dtype number = py::dtype::of<float>(), handle = py::dtype::of<std::uint64_t>();
    py::list names, formats, offsets;
    const auto field = [&](const char* name, const py::dtype& type, std::size_t offset) {
        names.append(name);
        formats.append(type);
        offsets.append(offset);
    };
    field("body_a", handle, offsetof(Contact, body_a));
    field("body_b", handle, offsetof(Contact, body_b));
    field("key", handle, offsetof(Contact, key));
    field("normal", vector, offsetof(Contact, normal));
    field("separation", number, offsetof(Contact, separation));
    field("arm_a", vector, offsetof(Contact, arm_a));
    field("friction", number, offsetof(Contact, friction));
    field("arm_b", vector, offsetof(Contact, arm_b));
    field("restitution", number, offsetof(Contact, restitution));
    return py::dtype(names, formats, offsets, sizeof(Contact));
}

std::span<const Contact> contacts_from(const py::object& contacts)
{
    if (contacts.is_none()) return {};
    const std::string expected = "a contiguous array of motley.contact_dtype, with one dimension";
    if (!py::isinstance<py::array>(contacts)) refuse_value("contacts", contacts, expected);
    const auto array = py::reinterpret_borrow<py::array>(contacts);
    const bool fits = array.dtype().equal(contact_dtype()) && array.ndim() == 1 &&
                      (array.shape(0) < 2 || array.strides(0) == sizeof(Contact)) &&
                      reinterpret_cast<std::uintptr_t>(array.data()) % alignof(Contact) == 0;
    if (!fits) refuse("contacts", "an array of " + shown(array.dtype()), expected);
    return {static_cast<const Contact*>(array.data()), static_cast<std::size_t>(array.shape(0))};
}

/// The report of a step; the interpreter's lock is free meanwhile. A refused step throws.
py::dict step(Solver& solver, PythonScene& scene, float dt, const py::object& contacts)
{
    const std::span<const Contact> list = contacts_from(contacts);
    PythonScene::InStep guard(scene);
    StepReport report;
    {
        const py::gil_scoped_release free;
        report = solver.step(guard.scene(), dt, list);
    }
    if (report.status == StepStatus::refused) throw InvalidInput(report.error);
    return dict_of(report);
}

}  // namespace

void add_solver_to(py::module_& module)
{
    module.attr("contact_dtype") = contact_dtype();
    py::class_<Solver>(
        module, "Solver",
        "Steps scenes: Solver(threads=1, isa=None, alone_below=8192, **settings). Settings "
        "are the fields of\n"
        "SolverSettings: method, substeps, iterations, exact_joints, exact_limits, exact_contacts, gravity, "
        "sleep_speed, ...")
        .def(py::init(&make_solver), py::arg("threads") = 1, py::arg("isa") = py::none(),
             py::arg("alone_below") = SolverOptions{}.alone_below)
        .def("step", &step, py::arg("scene"), py::arg("dt"), py::arg("contacts") = py::none(),
             "Advances the scene by dt seconds (0 to 1), with contacts of the host's own beside those that "
             "are found: an array of\n"
             "contact_dtype. Other threads of Python run meanwhile. A refused step raises InvalidInput and "
             "changes nothing. Returns\n"
             "the fields of StepReport as a dict: seconds is of the whole step, stages a dict of those of "
             "each stage, measures a\n"
             "dict of residuals, penetrations, and errors before and after.")
        .def(
            "change",
            [](Solver& self, const py::kwargs& settings) {
                self.set_settings(changed(self.settings(), settings));
            },
            "Changes settings by name; if one is refused, all stay.")
        .def_property_readonly(
            "settings", [](const Solver& self) { return dict_of(self.settings()); },
            "All settings, as a dict.")
        .def_property_readonly("isa", [](const Solver& self) { return std::string(isa_name(self.isa())); })
        .def_property_readonly("threads", &Solver::threads);
}

}  // namespace motley::python
