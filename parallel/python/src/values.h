// From a value of Python to one of the library, with errors that name it. Whatever comes in, nothing is guessed: a string is no
// number, and a vector has its length.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <array>
#include <bit>
#include <cstdint>
#include <string>
#include <utility>

#include "motley/motley.h"

namespace motley::python {

namespace py = pybind11;

/// What Python would print of it, shortened.
std::string shown(const py::handle& value);
/// Throws InvalidInput: "`name` is `value`; expected `expected`".
[[noreturn]] void refuse_value(const std::string& name, const py::handle& value, const std::string& expected);

/// Handles are integers in Python, so that arrays of them are arrays of uint64.
template <class Id>
std::uint64_t number_of(const Id& id)
{
    return std::bit_cast<std::uint64_t>(id);
}
template <class Id>
Id id_of(std::uint64_t number)
{
    return std::bit_cast<Id>(number);
}

double number_from(const std::string& name, const py::handle& value);
std::uint64_t whole_from(const std::string& name, const py::handle& value, std::uint64_t most);
bool truth_from(const std::string& name, const py::handle& value);

/// The numbers of a vector: a sequence or an array of `count`.
template <std::size_t count>
std::array<double, count> numbers_from(const std::string& name, const py::handle& value)
{
    const std::string expected = std::to_string(count) + " numbers";
    const bool is_sequence = py::isinstance<py::sequence>(value) || py::isinstance<py::array>(value);
    if (py::isinstance<py::str>(value) || !is_sequence) refuse_value(name, value, expected);
    const auto items = py::reinterpret_borrow<py::object>(value);
    if (py::len(items) != count) refuse_value(name, value, expected);
    std::array<double, count> numbers{};
    std::size_t i = 0;
    for (const py::handle item : items) {
        numbers[i] = number_from(name + "[" + std::to_string(i) + "]", item);
        ++i;
    }
    return numbers;
}

/// set(name, value, target) for every type that a field of a definition has.
inline void set(const std::string& name, const py::handle& value, float& target)
{
    target = static_cast<float>(number_from(name, value));
}
inline void set(const std::string& name, const py::handle& value, double& target)
{
    target = number_from(name, value);
}
inline void set(const std::string& name, const py::handle& value, bool& target)
{
    target = truth_from(name, value);
}
inline void set(const std::string& name, const py::handle& value, int& target)
{
    target = static_cast<int>(whole_from(name, value, INT32_MAX));
}
inline void set(const std::string& name, const py::handle& value, std::uint32_t& target)
{
    target = static_cast<std::uint32_t>(whole_from(name, value, UINT32_MAX));
}
inline void set(const std::string& name, const py::handle& value, BodyId& target)
{
    target = id_of<BodyId>(whole_from(name, value, UINT64_MAX));
}
template <class Real>
void set(const std::string& name, const py::handle& value, Vec2<Real>& target)
{
    const auto v = numbers_from<2>(name, value);
    target = {static_cast<Real>(v[0]), static_cast<Real>(v[1])};
}
template <class Real>
void set(const std::string& name, const py::handle& value, Vec3<Real>& target)
{
    const auto v = numbers_from<3>(name, value);
    target = {static_cast<Real>(v[0]), static_cast<Real>(v[1]), static_cast<Real>(v[2])};
}
template <class Real>
void set(const std::string& name, const py::handle& value, Quat<Real>& target)
{
    const auto q = numbers_from<4>(name, value);
    target = {static_cast<Real>(q[0]), static_cast<Real>(q[1]), static_cast<Real>(q[2]),
              static_cast<Real>(q[3])};
}
/// A number stands for a sphere: the same about every axis.
template <class Real>
void set(const std::string& name, const py::handle& value, Sym3<Real>& target)
{
    if (PyNumber_Check(value.ptr()) != 0 && !py::isinstance<py::array>(value)) {
        const auto about_all = static_cast<Real>(number_from(name, value));
        target = {about_all, 0, 0, about_all, 0, about_all};
        return;
    }
    const auto m = numbers_from<6>(name, value);
    target = {static_cast<Real>(m[0]), static_cast<Real>(m[1]), static_cast<Real>(m[2]),
              static_cast<Real>(m[3]), static_cast<Real>(m[4]), static_cast<Real>(m[5])};
}

/// One of the names of an enumeration, in the order of its values.
template <class Enum, std::size_t count>
Enum named(const std::string& field, const py::handle& value, const std::array<const char*, count>& names)
{
    std::string all;
    for (std::size_t i = 0; i < count; ++i) {
        if (py::isinstance<py::str>(value) && py::cast<std::string>(value) == names[i])
            return static_cast<Enum>(i);
        all += (i == 0 ? "'" : ", '") + std::string(names[i]) + "'";
    }
    refuse_value(field, value, all);
}
inline constexpr std::array model_names{"particle", "planar", "rigid"};
inline constexpr std::array motion_names{"dynamic", "kinematic", "static"};
inline void set(const std::string& name, const py::handle& value, BodyModel& target)
{
    target = named<BodyModel>(name, value, model_names);
}
inline void set(const std::string& name, const py::handle& value, BodyMotion& target)
{
    target = named<BodyMotion>(name, value, motion_names);
}
inline constexpr std::array method_names{"soft_step", "sequential_impulse", "direct"};
inline constexpr std::array drift_names{"by_method", "none", "baumgarte", "projection"};
inline constexpr std::array bad_contact_names{"refuse", "skip"};
inline void set(const std::string& name, const py::handle& value, Method& target)
{
    target = named<Method>(name, value, method_names);
}
inline void set(const std::string& name, const py::handle& value, DriftCorrection& target)
{
    target = named<DriftCorrection>(name, value, drift_names);
}
inline void set(const std::string& name, const py::handle& value, BadContacts& target)
{
    target = named<BadContacts>(name, value, bad_contact_names);
}
inline void set(const std::string& name, const py::handle& value, EulerAngle& target)
{
    target = named<EulerAngle>(name, value, std::array{"x", "y", "z"});
}
inline void set(const std::string& name, const py::handle& value, SixDofRotation& target)
{
    target = named<SixDofRotation>(name, value, std::array{"about_axes", "euler"});
}
/// A place, or a dict with position and rotation.
void set(const std::string& name, const py::handle& value, JointFrame& target);
/// Hz, or a dict with hertz and damping_ratio.
void set(const std::string& name, const py::handle& value, JointStiffness& target);
/// Three axes, of which each is "locked", "free", a pair of limits, or a dict with the fields of AxisSetup.
void set(const std::string& name, const py::handle& value, AxisSetup (&target)[3]);

/// An argument of a call.
template <class T>
T value_of(const char* name, const py::object& value)
{
    T target{};
    set(name, value, target);
    return target;
}

template <class Real>
py::tuple tuple_of(const Vec2<Real>& v)
{
    return py::make_tuple(v.x, v.y);
}
template <class Real>
py::tuple tuple_of(const Vec3<Real>& v)
{
    return py::make_tuple(v.x, v.y, v.z);
}
template <class Real>
py::tuple tuple_of(const Quat<Real>& q)
{
    return py::make_tuple(q.x, q.y, q.z, q.w);
}

/// Takes keyword arguments one by one, and refuses those that nobody took.
class Keywords {
  public:
    Keywords(std::string of, const py::kwargs& arguments)
        : of_(std::move(of)), left_(arguments.attr("copy")())
    {
    }
    /// Sets `target` if the argument is given.
    template <class T>
    void take(const char* name, T& target)
    {
        if (!left_.contains(name)) return;
        const py::object value = left_.attr("pop")(name);
        set(of_ + "." + name, value, target);
    }
    /// Throws TypeError if anything is left.
    void end() const;

  private:
    std::string of_;
    py::dict left_;
};

}  // namespace motley::python
