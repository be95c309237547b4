// numpy arrays as the library's views: as they lie in memory where their type fits, and converted once where it does not.
#pragma once

#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "values.h"

namespace motley::python {

/// An array of numbers that the library reads. Keeps what it looks at alive.
class Numbers {
  public:
    /// Accepts what numpy makes a numeric array of. Integers and floats are numbers; strings, objects and complex numbers
    /// are refused.
    Numbers(std::string name, const py::handle& value);
    [[nodiscard]] const py::array& array() const { return array_; }
    [[nodiscard]] const std::string& name() const { return name_; }
    [[nodiscard]] std::size_t dimensions() const { return static_cast<std::size_t>(array_.ndim()); }
    [[nodiscard]] std::size_t size(std::size_t dimension) const
    {
        return static_cast<std::size_t>(array_.shape(static_cast<py::ssize_t>(dimension)));
    }
    /// Throws InvalidInput: "`name` is an array of float64 with shape (3,); expected `expected`".
    [[noreturn]] void refuse_array(const std::string& expected) const;

  private:
    std::string name_;
    py::array array_;
};

/// Handles: an array of whole numbers, or a sequence.
class Handles {
  public:
    Handles(const std::string& name, const py::handle& value);
    [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(array_.size()); }
    template <class Id>
    [[nodiscard]] std::span<const Id> span() const
    {
        static_assert(sizeof(Id) == sizeof(std::uint64_t));
        return {reinterpret_cast<const Id*>(array_.data()), size()};
    }

  private:
    py::array_t<std::uint64_t, py::array::c_style> array_;
};
template <class Id>
py::array_t<std::uint64_t> handles_of(std::span<const Id> ids)
{
    py::array_t<std::uint64_t> array(static_cast<py::ssize_t>(ids.size()));
    std::uint64_t* numbers = array.mutable_data();
    for (std::size_t i = 0; i < ids.size(); ++i) numbers[i] = number_of(ids[i]);
    return array;
}

/// `rows` vectors of `width` numbers, or, with width 1, `rows` numbers, to be read as elements of type Element made of numbers of
/// type Number.
template <class Number, class Element, std::size_t width = sizeof(Element) / sizeof(Number)>
class Input {
  public:
    Input(const std::string& name, const py::handle& value, std::size_t rows)
    {
        const Numbers numbers(name, value);
        const bool fits =
            width == 1 ? numbers.dimensions() == 1 && numbers.size(0) == rows
                       : numbers.dimensions() == 2 && numbers.size(0) == rows && numbers.size(1) == width;
        if (!fits) numbers.refuse_array("shape " + shape(rows));
        const py::array& array = numbers.array();
        const bool as_it_lies = array.dtype().equal(py::dtype::of<Number>()) &&
                                (width == 1 || array.strides(1) == sizeof(Number)) && array.strides(0) > 0 &&
                                reinterpret_cast<std::uintptr_t>(array.data()) % alignof(Element) == 0 &&
                                array.strides(0) % static_cast<py::ssize_t>(alignof(Element)) == 0;
        array_ = as_it_lies ? array : py::array_t<Number, py::array::c_style | py::array::forcecast>(array);
    }
    [[nodiscard]] StridedSpan<const Element> span() const
    {
        return {static_cast<const Element*>(array_.data()), static_cast<std::size_t>(array_.shape(0)),
                static_cast<std::size_t>(array_.strides(0))};
    }
    static std::string shape(std::size_t rows)
    {
        return "(" + std::to_string(rows) + (width == 1 ? ",)" : ", " + std::to_string(width) + ")");
    }

  private:
    py::array array_;
};

/// The same to be written: an array of the caller, which must have this type and shape and be writeable, or a new one.
template <class Number, class Element, std::size_t width = sizeof(Element) / sizeof(Number)>
class Output {
  public:
    Output(const std::string& name, const py::object& out, std::size_t rows)
    {
        const auto count = static_cast<py::ssize_t>(rows), across = static_cast<py::ssize_t>(width);
        if (out.is_none()) {
            array_ = width == 1 ? py::array(py::array_t<Number>({count}))
                                : py::array(py::array_t<Number>({count, across}));
            return;
        }
        const std::string expected = "a writeable array of " +
                                     py::cast<std::string>(py::str(py::dtype::of<Number>())) +
                                     " with shape " + Input<Number, Element, width>::shape(rows);
        if (!py::isinstance<py::array>(out)) refuse_value(name, out, expected);
        array_ = py::reinterpret_borrow<py::array>(out);
        const bool fits =
            array_.dtype().equal(py::dtype::of<Number>()) && array_.writeable() &&
            array_.ndim() == (width == 1 ? 1 : 2) && array_.shape(0) == count &&
            (width == 1 || (array_.shape(1) == across && array_.strides(1) == sizeof(Number))) &&
            (rows < 2 || array_.strides(0) >= static_cast<py::ssize_t>(sizeof(Element))) &&
            reinterpret_cast<std::uintptr_t>(array_.data()) % alignof(Element) == 0 &&
            array_.strides(0) % static_cast<py::ssize_t>(alignof(Element)) == 0;
        if (!fits) Numbers(name, out).refuse_array(expected + ", whose rows lie apart");
    }
    [[nodiscard]] StridedSpan<Element> span()
    {
        return {static_cast<Element*>(array_.mutable_data()), static_cast<std::size_t>(array_.shape(0)),
                static_cast<std::size_t>(array_.strides(0))};
    }
    [[nodiscard]] const py::array& array() const { return array_; }

  private:
    py::array array_;
};

/// One member of each item, as an array: numbers and handles in a row, vectors as n x 2 or n x 3.
template <class Items, class Item, class Member>
py::array column(const Items& items, Member Item::*member)
{
    constexpr bool is_of_floats = std::is_same_v<Member, float> || std::is_same_v<Member, Vec2<float>> ||
                                  std::is_same_v<Member, Vec3<float>>;
    using Number = std::conditional_t<is_of_floats, float, std::uint64_t>;
    constexpr std::size_t width = sizeof(Member) / sizeof(Number);
    static_assert(width * sizeof(Number) == sizeof(Member), "neither floats nor a handle");
    std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(items.size())};
    if (width > 1) shape.push_back(static_cast<py::ssize_t>(width));
    py::array_t<Number> array(shape);
    Number* at = array.mutable_data();
    for (const Item& item : items) {
        std::memcpy(at, &(item.*member), sizeof(Member));
        at += width;
    }
    return array;
}

/// One number for all of `count`, or one for each.
template <class Number>
std::vector<Number> for_each_of(const std::string& name, const py::handle& value, std::size_t count)
{
    if (!py::isinstance<py::array>(value) && !py::isinstance<py::sequence>(value))
        return std::vector<Number>(count, static_cast<Number>(number_from(name, value)));
    const Input<Number, Number> input(name, value, count);
    std::vector<Number> numbers(count);
    for (std::size_t i = 0; i < count; ++i) numbers[i] = input.span()[i];
    return numbers;
}

/// Places in the plane or in space: `count` rows of two or three numbers.
std::vector<Vec3<double>> places_from(const std::string& name, const py::handle& value);
std::vector<Vec2<double>> points_from(const std::string& name, const py::handle& value);

}  // namespace motley::python
