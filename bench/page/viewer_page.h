// The page of `motley view`: a recording and what draws it in one file.
#pragma once

#include <string>

namespace motley::bench {

struct ViewerPage {
    std::string html;
    std::string facts;  ///< what is on the page, and whether the recording was cut off
};

/// The page of a recording. Reads the whole recording first, so that a bad one is refused. Throws std::runtime_error, also where
/// three.js is missing (Debian's package libjs-three).
ViewerPage make_viewer_page(const std::string& recording);

/// The same, written to `page`. Returns a line that says so.
std::string write_viewer_page(const std::string& recording, const std::string& page);

}  // namespace motley::bench
