// See reports.h. The names are those of the mirrors of the C interface, which the compiler keeps complete.
#include "reports.h"

#include <tuple>

#include "c/solver_mirrors.h"

namespace motley::python {
namespace {

/// The fields that a struct shares with its mirror C.
template <class C, class Cpp>
py::dict dict_as(const Cpp& value);

py::object shown_value(const BodyId& body)
{
    return py::cast(number_of(body));
}
py::object shown_value(const Vec3<float>& vector)
{
    return tuple_of(vector);
}
py::object shown_value(Method value)
{
    return py::str(method_names[static_cast<std::size_t>(value)]);
}
py::object shown_value(DriftCorrection value)
{
    return py::str(drift_names[static_cast<std::size_t>(value)]);
}
py::object shown_value(BadContacts value)
{
    return py::str(bad_contact_names[static_cast<std::size_t>(value)]);
}
py::object shown_value(const double (&vector)[3])
{
    return py::make_tuple(vector[0], vector[1], vector[2]);
}
py::object shown_value(const SceneErrors& errors)
{
    return dict_of(errors);
}
py::object shown_value(const StepMeasures& measures)
{
    return dict_as<motley_step_measures>(measures);
}
py::object shown_value(const std::array<double, stage_count>& seconds)
{
    py::dict all;
    for (int stage = 0; stage < stage_count; ++stage)
        all[stage_name(static_cast<Stage>(stage))] = seconds[static_cast<std::size_t>(stage)];
    return all;
}
template <class T>
py::object shown_value(const T& value)
{
    return py::cast(value);
}

template <class C, class Cpp>
py::dict dict_as(const Cpp& value)
{
    py::dict all;
    std::apply([&](const auto&... field) { ((all[field.name] = shown_value(value.*field.cpp_member)), ...); },
               c::Mirror<C, Cpp>::fields);
    return all;
}

}  // namespace

py::dict dict_of(const SceneErrors& errors)
{
    return dict_as<motley_scene_errors>(errors);
}

py::dict dict_of(const SolverSettings& settings)
{
    return dict_as<motley_solver_settings>(settings);
}

py::dict dict_of(const StepReport& report)
{
    py::dict all = dict_as<motley_step_report>(report);
    all["stages"] = all["seconds"];
    all["seconds"] = report.total_seconds();
    return all;
}

}  // namespace motley::python
