// The page of `motley view`: a recording and what draws it in one file.
#pragma once

#include <string>

namespace motley::bench {

/// Writes the page of a recording to `page`. Reads the whole recording first, so that a bad one is refused; returns a line that says
/// what is on the page, and whether the recording was cut off. Throws std::runtime_error, also where three.js is missing
/// (Debian's package libjs-three).
std::string write_viewer_page(const std::string& recording, const std::string& page);

}  // namespace motley::bench
