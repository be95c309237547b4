// See view.h.
#include "commands/view.h"

#include <fmt/format.h>

#include "page/viewer_page.h"

namespace motley::bench {

void ViewCommand::declare(CLI::App& app)
{
    app.add_option("file", file, "what `motley run SCENE --record FILE` wrote")
        ->required()
        ->check(CLI::ExistingFile);
    app.add_option("--output", page, "the page; default: the file's name and .html");
}

int ViewCommand::operator()() const
{
    fmt::print("{}\n", write_viewer_page(file, page.empty() ? file + ".html" : page));
    return 0;
}

}  // namespace motley::bench
