// `motley view`: a recording as a page that opens from disk.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace motley::bench {

struct ViewCommand {
    std::string file, page;

    void declare(CLI::App& app);
    int operator()() const;
};

}  // namespace motley::bench
