// `motley view`: a recording as a page that opens from disk, or is served to this machine.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace motley::bench {

struct ViewCommand {
    std::string file, page;
    bool serves = false;
    int port = 0;

    void declare(CLI::App& app);
    int operator()() const;
};

}  // namespace motley::bench
