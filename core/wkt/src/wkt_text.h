// What is checked of the text itself. GEOS parses it, but does not say where it is wrong, and overlooks what follows.
#pragma once

#include <string>
#include <string_view>

namespace motley {

/// Refuses a text whose parentheses are not balanced or nest deeply, that has something after its geometry, a character
/// that WKT does not have, or a number that is not finite.
void check_wkt_text(std::string_view text);

/// Where the first ring of a polygon is that does not end where it begins, as "ring from (0 0) to (1 1)", or nothing.
std::string find_open_ring(std::string_view text);

/// Throws InvalidInput: "WKT: `what`".
[[noreturn]] void refuse_wkt(const std::string& what);

}  // namespace motley
