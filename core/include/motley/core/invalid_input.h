// The one exception of the library: bad input, refused at the door with nothing changed.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace motley {

/// Thrown by Scene when a definition, handle or value is refused. The message names the field, the value,
/// and the valid range, as in "DistanceDefinition.length is -0.3; expected a finite value >= 0 (m)".
/// The scene is as it was before the call.
class InvalidInput : public std::invalid_argument {
  public:
    using std::invalid_argument::invalid_argument;
};

/// Throws InvalidInput: "`field` is `value`; expected `expected`".
[[noreturn]] void refuse(std::string_view field, double value, std::string_view expected);
[[noreturn]] void refuse(std::string_view field, std::string_view value, std::string_view expected);

}  // namespace motley
