// Serves a page to the browsers of this machine.
#pragma once

#include <functional>
#include <string>

namespace motley::bench {

/// Serves `html` at http://127.0.0.1:port/ until the process ends; port 0: a free one. Calls `ready` with the port once browsers are
/// answered. Throws std::runtime_error where the port is taken, or where the program was built without cpp-httplib (Debian's
/// package libcpp-httplib-dev).
void serve_page(const std::string& html, int port, const std::function<void(int)>& ready);

}  // namespace motley::bench
