// See mjcf_elements.h.
#include "mjcf_elements.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include "maths/across.h"
#include "motley/core/invalid_input.h"

namespace motley::mjcf {
namespace {

double length_of(const Vec3<double>& v)
{
    return std::sqrt(dot(v, v));
}

Quat<double> unit(const Quat<double>& q, double length)
{
    return {q.x / length, q.y / length, q.z / length, q.w / length};
}

}  // namespace

void Source::refuse(const pugi::xml_node& node, const std::string& what) const
{
    const auto at = static_cast<std::size_t>(std::max<std::ptrdiff_t>(node.offset_debug(), 0));
    const auto line =
        1 +
        std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(std::min(at, text.size())), '\n');
    const std::string name = node.attribute("name").value();
    throw InvalidInput("MJCF: " + std::string(node.name()) + (name.empty() ? "" : " '" + name + "'") +
                       ", line " + std::to_string(line) + ": " + what);
}

std::string Element::text(std::string_view name, const char* otherwise) const
{
    const auto found = attributes_.find(name);
    return found != attributes_.end() ? found->second : otherwise;
}

std::vector<double> Element::numbers(std::string_view name, std::size_t least, std::size_t most) const
{
    const auto found = attributes_.find(name);
    std::vector<double> values;
    if (found == attributes_.end()) return values;
    const std::string& all = found->second;
    const auto refuse_all = [&] {
        refuse(std::string(name) + " is '" + all + "'; expected " + std::to_string(least) +
               (most > least ? " to " + std::to_string(most) : "") + " finite numbers");
    };
    const auto is_space = [](char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; };
    for (const char *at = all.data(), *const end = at + all.size(); at != end;) {
        if (is_space(*at)) {
            ++at;
            continue;
        }
        if (*at == '+') ++at;
        double value = 0;
        const auto [rest, error] = std::from_chars(at, end, value);
        if (error != std::errc() || !std::isfinite(value) || (rest != end && !is_space(*rest))) refuse_all();
        values.push_back(value);
        at = rest;
    }
    if (values.size() < least || values.size() > most) refuse_all();
    return values;
}

double Element::number(std::string_view name, double otherwise) const
{
    const std::vector<double> values = numbers(name, 1, 1);
    return values.empty() ? otherwise : values[0];
}

Vec3<double> Element::vector(std::string_view name, const Vec3<double>& otherwise) const
{
    const std::vector<double> v = numbers(name, 3, 3);
    return v.empty() ? otherwise : Vec3<double>{v[0], v[1], v[2]};
}

Vec3<double> Element::direction(std::string_view name, const Vec3<double>& otherwise) const
{
    const Vec3<double> v = vector(name, otherwise);
    const double length = length_of(v);
    if (!(length > 1e-10)) refuse(std::string(name) + " has no length");
    return (1 / length) * v;
}

Quat<double> Element::orientation(double per_unit) const
{
    if (const auto q = numbers("quat", 4, 4); !q.empty()) {
        const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
        if (!(length > 1e-10)) refuse("quat has no length");
        return unit({q[1], q[2], q[3], q[0]}, length);
    }
    if (const auto a = numbers("axisangle", 4, 4); !a.empty()) {
        const Vec3<double> axis{a[0], a[1], a[2]};
        if (!(length_of(axis) > 1e-10)) refuse("axisangle has an axis without length");
        return turn_about((1 / length_of(axis)) * axis, per_unit * a[3]);
    }
    if (has("euler")) {
        const Vec3<double> e = vector("euler", {});
        return turn_about({1, 0, 0}, per_unit * e.x) * turn_about({0, 1, 0}, per_unit * e.y) *
               turn_about({0, 0, 1}, per_unit * e.z);
    }
    if (const auto v = numbers("xyaxes", 6, 6); !v.empty()) {
        const Vec3<double> x{v[0], v[1], v[2]}, y{v[3], v[4], v[5]};
        if (!(length_of(cross(x, y)) > 1e-10)) refuse("xyaxes are parallel or have no length");
        const Vec3<double> along = (1 / length_of(x)) * x, across = y - dot(y, along) * along;
        return turn_to(along, (1 / length_of(across)) * across);
    }
    if (has("zaxis")) {
        const Vec3<double> z = direction("zaxis", {}), x = perpendicular_to(z);
        return turn_to(x, cross(z, x));
    }
    return {0, 0, 0, 1};
}

void Element::allow_only(std::initializer_list<const char*> read,
                         std::initializer_list<const char*> passed_over) const
{
    for (const auto& [name, value] : attributes_) {
        const auto is_this = [&, &name = name](const char* known) { return name == known; };
        if (std::any_of(read.begin(), read.end(), is_this)) continue;
        if (std::any_of(passed_over.begin(), passed_over.end(), is_this)) continue;
        refuse("has the attribute " + name + ", which is not read here");
    }
}

void Element::demand_zero(std::string_view name) const
{
    if (number(name, 0) != 0) refuse(std::string(name) + " is " + text(name, "") + "; expected 0");
}

void Defaults::read(const Source& source, const pugi::xml_node& node)
{
    read(source, node, "");
}

void Defaults::read(const Source& source, const pugi::xml_node& node, const std::string& above)
{
    std::string name = node.attribute("class").value();
    if (name.empty()) name = "main";
    auto& own = classes_[name];
    // A class has what the class above it has, and may say it anew.
    if (!above.empty()) own = classes_[above];
    for (const pugi::xml_node& child : node.children()) {
        if (child.type() != pugi::node_element || std::string_view(child.name()) == "default") continue;
        Attributes& attributes = own[child.name()];
        for (const pugi::xml_attribute& attribute : child.attributes())
            attributes[attribute.name()] = attribute.value();
    }
    for (const pugi::xml_node& child : node.children("default")) read(source, child, name);
}

Element Defaults::element(const Source& source, const pugi::xml_node& node, const std::string& around) const
{
    Attributes attributes;
    const pugi::xml_attribute named = node.attribute("class");
    const std::string name = named ? named.value() : around.empty() ? "main" : around;
    const auto of_class = classes_.find(name);
    if (of_class != classes_.end()) {
        const auto of_element = of_class->second.find(node.name());
        if (of_element != of_class->second.end()) attributes = of_element->second;
    } else if (named || !around.empty()) {
        source.refuse(node, "class '" + name + "' is not among the defaults");
    }
    for (const pugi::xml_attribute& attribute : node.attributes())
        attributes[attribute.name()] = attribute.value();
    return {source, node, std::move(attributes)};
}

Quat<double> turn_about(const Vec3<double>& axis, double angle)
{
    const double sine = std::sin(angle / 2);
    return {sine * axis.x, sine * axis.y, sine * axis.z, std::cos(angle / 2)};
}

Vec3<double> perpendicular_to(const Vec3<double>& axis)
{
    const Vec3<double> across = some_across(axis);
    return (1 / length_of(across)) * across;
}

Quat<double> turn_to(const Vec3<double>& x, const Vec3<double>& y)
{
    // First x to its place by a half-turn about the bisector, which is always possible; then about x.
    const Vec3<double> from{1, 0, 0};
    const Vec3<double> middle = from + x;
    const double length = length_of(middle);
    const Vec3<double> bisector = length > 1e-6 ? (1 / length) * middle : perpendicular_to(from);
    const Quat<double> first{bisector.x, bisector.y, bisector.z, 0};
    const Vec3<double> turned = rotate(first, Vec3<double>{0, 1, 0});
    const double angle = std::atan2(dot(cross(turned, y), x), dot(turned, y));
    return turn_about(x, angle) * first;
}

}  // namespace motley::mjcf
