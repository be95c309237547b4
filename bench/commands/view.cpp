// See view.h.
#include "commands/view.h"

#include <fmt/format.h>

#include <cstdio>

#include "page/page_server.h"
#include "page/viewer_page.h"

namespace motley::bench {

void ViewCommand::declare(CLI::App& app)
{
    app.add_option("file", file, "what `motley run SCENE --record FILE` wrote")
        ->required()
        ->check(CLI::ExistingFile);
    app.add_option("--output", page, "the page; default: the file's name and .html");
    CLI::Option* const serve =
        app.add_flag("--serve", serves, "serve the page to this machine instead, until interrupted")
            ->excludes("--output");
    app.add_option("--port", port, "of --serve; 0: a free one")
        ->check(CLI::Range(0, 65535))
        ->needs(serve)
        ->capture_default_str();
}

int ViewCommand::operator()() const
{
    if (serves) {
        const ViewerPage made = make_viewer_page(file);
        serve_page(made.html, port, [&](int bound) {
            fmt::print("http://127.0.0.1:{}/: {}; Ctrl-C ends it\n", bound, made.facts);
            std::fflush(stdout);
        });
        return 0;
    }
    fmt::print("{}\n", write_viewer_page(file, page.empty() ? file + ".html" : page));
    return 0;
}

}  // namespace motley::bench
