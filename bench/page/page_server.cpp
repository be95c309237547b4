// See page_server.h.
#include "page/page_server.h"

#include <fmt/format.h>

#include <stdexcept>

#ifdef MOTLEY_HAS_HTTPLIB
#include <httplib.h>
#endif

namespace motley::bench {

void serve_page([[maybe_unused]] const std::string& html, [[maybe_unused]] int port,
                [[maybe_unused]] const std::function<void(int)>& ready)
{
#ifdef MOTLEY_HAS_HTTPLIB
    constexpr const char* loopback = "127.0.0.1";  // nobody else's business
    httplib::Server server;
    // By default two servers may share a port, and neither would know.
    server.set_socket_options([](socket_t socket) {
        const int yes = 1;
        setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    });
    server.Get("/", [&](const httplib::Request&, httplib::Response& response) {
        response.set_content(html, "text/html; charset=utf-8");
    });
    const int bound = port == 0                             ? server.bind_to_any_port(loopback)
                      : server.bind_to_port(loopback, port) ? port
                                                            : -1;
    if (bound < 0) throw std::runtime_error(fmt::format("port {} of {} is taken", port, loopback));
    ready(bound);
    server.listen_after_bind();
#else
    throw std::runtime_error(
        "this program was built without cpp-httplib, which serves pages; it is in Debian's package "
        "libcpp-httplib-dev");
#endif
}

}  // namespace motley::bench
