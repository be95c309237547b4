// Elements of a file with their attributes: those that they have, and those that their default class gives them.
#pragma once

#include <initializer_list>
#include <map>
#include <optional>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "motley/core/vector.h"

namespace motley::mjcf {

/// Attributes by name.
using Attributes = std::map<std::string, std::string, std::less<>>;

/// The text of a file, for messages.
struct Source {
    std::string_view text;
    /// Throws InvalidInput, saying where and what is wrong.
    [[noreturn]] void refuse(const pugi::xml_node& node, const std::string& what) const;
};

/// An element with the attributes that hold for it.
class Element {
  public:
    Element(const Source& source, const pugi::xml_node& node, Attributes attributes)
        : source_(&source), node_(node), attributes_(std::move(attributes))
    {
    }
    [[noreturn]] void refuse(const std::string& what) const { source_->refuse(node_, what); }
    [[nodiscard]] bool has(std::string_view name) const
    {
        return attributes_.find(name) != attributes_.end();
    }
    [[nodiscard]] std::string text(std::string_view name, const char* otherwise) const;
    /// The numbers of an attribute; refuses others than `least` to `most` of them. Empty where there is no such
    /// attribute.
    [[nodiscard]] std::vector<double> numbers(std::string_view name, std::size_t least,
                                              std::size_t most) const;
    [[nodiscard]] double number(std::string_view name, double otherwise) const;
    [[nodiscard]] Vec3<double> vector(std::string_view name, const Vec3<double>& otherwise) const;
    /// A vector of length 1; refuses one without length.
    [[nodiscard]] Vec3<double> direction(std::string_view name, const Vec3<double>& otherwise) const;
    /// From quat, axisangle, euler, xyaxes or zaxis; the identity without any of them. `per_unit`: rad in a unit of angles.
    [[nodiscard]] Quat<double> orientation(double per_unit) const;
    /// Refuses attributes that are in none of the lists.
    void allow_only(std::initializer_list<const char*> read,
                    std::initializer_list<const char*> passed_over) const;
    /// Refuses an attribute unless it is a zero.
    void demand_zero(std::string_view name) const;

  private:
    const Source* source_;
    pugi::xml_node node_;
    Attributes attributes_;
};

/// The default classes of a file.
class Defaults {
  public:
    /// Reads a <default> element of the file.
    void read(const Source& source, const pugi::xml_node& node);
    /// An element with what its own class, or else the class of the body around it, gives it.
    [[nodiscard]] Element element(const Source& source, const pugi::xml_node& node,
                                  const std::string& around) const;

  private:
    /// By class, then by the name of the element.
    std::map<std::string, std::map<std::string, Attributes, std::less<>>, std::less<>> classes_;
    void read(const Source& source, const pugi::xml_node& node, const std::string& above);
};

/// Rotates by `angle`, rad, about a unit axis.
Quat<double> turn_about(const Vec3<double>& axis, double angle);
/// Takes x to one unit vector and y to another, which is perpendicular to it.
Quat<double> turn_to(const Vec3<double>& x, const Vec3<double>& y);
/// A unit vector perpendicular to another.
Vec3<double> perpendicular_to(const Vec3<double>& axis);

}  // namespace motley::mjcf
