// The exception that the library throws for bad input, before anything is changed.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

#pragma GCC visibility push(default)
namespace motley {

/// Thrown when a definition, handle, setting or other value is refused. The message names the field, the value and the
/// valid range, as in "BodyDefinition.mass is -1; expected 1e-10 to 1e10 (kg)". Nothing has been changed by the call.
class InvalidInput : public std::invalid_argument {
  public:
    using std::invalid_argument::invalid_argument;
};

/// Throws InvalidInput: "`field` is `value`; expected `expected`".
[[noreturn]] void refuse(std::string_view field, double value, std::string_view expected);
[[noreturn]] void refuse(std::string_view field, std::string_view value, std::string_view expected);

}  // namespace motley
#pragma GCC visibility pop
