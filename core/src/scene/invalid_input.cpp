// Messages for refused input.
#include "motley/core/invalid_input.h"

#include <cstdio>

namespace motley {

void refuse(std::string_view field, std::string_view value, std::string_view expected)
{
    std::string message(field);
    message.append(" is ").append(value).append("; expected ").append(expected);
    throw InvalidInput(message);
}

void refuse(std::string_view field, double value, std::string_view expected)
{
    char digits[40];
    std::snprintf(digits, sizeof digits, "%.9g", value);
    refuse(field, std::string_view(digits), expected);
}

}  // namespace motley
