// See arrays.h.
#include "arrays.h"

namespace motley::python {

Numbers::Numbers(std::string name, const py::handle& value) : name_(std::move(name))
{
    if (py::isinstance<py::str>(value) || value.is_none()) refuse_value(name_, value, "an array of numbers");
    array_ = py::array::ensure(py::reinterpret_borrow<py::object>(value));
    if (!array_) {
        PyErr_Clear();
        refuse_value(name_, value, "an array of numbers");
    }
    const char kind = array_.dtype().kind();
    if (kind != 'f' && kind != 'i' && kind != 'u') refuse_array("an array of numbers");
}

void Numbers::refuse_array(const std::string& expected) const
{
    const auto text = [](const py::object& object) { return py::cast<std::string>(py::str(object)); };
    refuse(name_,
           "an array of " + text(array_.dtype()) + " with shape " + text(array_.attr("shape")) +
               " and strides " + text(array_.attr("strides")) + (array_.writeable() ? "" : ", read-only"),
           expected);
}

Handles::Handles(const std::string& name, const py::handle& value)
{
    const Numbers numbers(name, value);
    const bool is_empty = numbers.array().size() == 0;
    const bool is_whole = numbers.array().dtype().kind() != 'f';
    if (numbers.dimensions() != 1 || (!is_whole && !is_empty))
        numbers.refuse_array("one dimension of whole numbers: handles");
    array_ = py::array_t<std::uint64_t, py::array::c_style | py::array::forcecast>(numbers.array());
}

std::vector<Vec3<double>> places_from(const std::string& name, const py::handle& value)
{
    const Numbers numbers(name, value);
    if (numbers.dimensions() == 2 && numbers.size(1) == 2) {
        std::vector<Vec3<double>> places;
        for (const Vec2<double>& point : points_from(name, value)) places.push_back({point.x, point.y, 0});
        return places;
    }
    if (numbers.dimensions() != 2 || numbers.size(1) != 3) numbers.refuse_array("shape (n, 2) or (n, 3)");
    const Input<double, Vec3<double>> input(name, value, numbers.size(0));
    std::vector<Vec3<double>> places(numbers.size(0));
    for (std::size_t i = 0; i < places.size(); ++i) places[i] = input.span()[i];
    return places;
}

std::vector<Vec2<double>> points_from(const std::string& name, const py::handle& value)
{
    const Numbers numbers(name, value);
    if (numbers.dimensions() != 2 || numbers.size(1) != 2) numbers.refuse_array("shape (n, 2)");
    const Input<double, Vec2<double>> input(name, value, numbers.size(0));
    std::vector<Vec2<double>> points(numbers.size(0));
    for (std::size_t i = 0; i < points.size(); ++i) points[i] = input.span()[i];
    return points;
}

}  // namespace motley::python
