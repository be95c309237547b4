// Structs of the library as dicts with the names of their fields in C++.
#pragma once

#include "motley/core/step_report.h"
#include "values.h"

namespace motley::python {

py::dict dict_of(const SceneErrors& errors);
py::dict dict_of(const SolverSettings& settings);
/// `seconds` is of the whole step, and `stages` a dict of those of each stage.
py::dict dict_of(const StepReport& report);

}  // namespace motley::python
