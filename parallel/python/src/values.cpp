// See values.h.
#include "values.h"

#include <cmath>

namespace motley::python {

std::string shown(const py::handle& value)
{
    std::string text = py::cast<std::string>(py::repr(value));
    constexpr std::size_t most = 60;
    if (text.size() > most) text = text.substr(0, most) + "...";
    return text;
}

void refuse_value(const std::string& name, const py::handle& value, const std::string& expected)
{
    refuse(name, shown(value), expected);
}

double number_from(const std::string& name, const py::handle& value)
{
    const bool is_number = PyFloat_Check(value.ptr()) != 0 || PyIndex_Check(value.ptr()) != 0 ||
                           (PyNumber_Check(value.ptr()) != 0 && py::hasattr(value, "dtype"));
    if (!is_number || py::isinstance<py::bool_>(value)) refuse_value(name, value, "a number");
    const double number = PyFloat_AsDouble(value.ptr());
    if (PyErr_Occurred() != nullptr) {
        PyErr_Clear();
        refuse_value(name, value, "a number");
    }
    return number;
}

std::uint64_t whole_from(const std::string& name, const py::handle& value, std::uint64_t most)
{
    const std::string expected = "a whole number, 0 to " + std::to_string(most);
    if (PyIndex_Check(value.ptr()) == 0 || py::isinstance<py::bool_>(value))
        refuse_value(name, value, expected);
    const auto index = py::reinterpret_steal<py::object>(PyNumber_Index(value.ptr()));
    const std::uint64_t number = index ? PyLong_AsUnsignedLongLong(index.ptr()) : 0;
    if (PyErr_Occurred() != nullptr || number > most) {
        PyErr_Clear();
        refuse_value(name, value, expected);
    }
    return number;
}

bool truth_from(const std::string& name, const py::handle& value)
{
    if (!py::isinstance<py::bool_>(value)) refuse_value(name, value, "True or False");
    return value.is(py::handle(Py_True));
}

void Keywords::end() const
{
    if (left_.empty()) return;
    const auto first = py::cast<std::string>(py::str(left_.begin()->first));
    throw py::type_error(of_ + " has no field '" + first + "'");
}

void set(const std::string& name, const py::handle& value, JointFrame& target)
{
    if (!py::isinstance<py::dict>(value)) {
        set(name, value, target.position);
        return;
    }
    Keywords given(name, py::reinterpret_borrow<py::kwargs>(value));
    given.take("position", target.position);
    given.take("rotation", target.rotation);
    given.end();
}

void set(const std::string& name, const py::handle& value, JointStiffness& target)
{
    if (!py::isinstance<py::dict>(value)) {
        set(name, value, target.hertz);
        return;
    }
    Keywords given(name, py::reinterpret_borrow<py::kwargs>(value));
    given.take("hertz", target.hertz);
    given.take("damping_ratio", target.damping_ratio);
    given.end();
}

}  // namespace motley::python
