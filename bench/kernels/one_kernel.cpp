// One kernel and nothing else, for tools that count instructions: bench/count-instructions.
//   motley_one_kernel                        names the kernels
//   motley_one_kernel KERNEL ISA SWEEPS      one step of so many sweeps; prints how many constraints there are
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <exception>
#include <optional>
#include <stdexcept>
#include <string>

#include "motley/motley.h"
#include "worlds/tie_net.h"

namespace motley::bench {
namespace {

/// A net small enough for a simulated processor: some blocks of each colour, and padding.
constexpr int side = 24;

void run(const std::string& kernel, const std::string& isa, int sweeps)
{
    const NamedTie tie = tie_called(kernel);
    const std::optional<Isa> wanted = isa_from_name(isa);
    if (!wanted) throw std::runtime_error(isa + ": no such instruction set");
    Solver solver({.substeps = 1, .iterations = sweeps, .relaxations = 0}, {.isa = wanted});
    const auto net = make_net(tie.tie, tie.model, side);
    const StepReport report = solver.step(net->scene, 1e-3F, net->contacts);
    if (report.status != StepStatus::done) throw std::runtime_error(report.error);
    fmt::print("{}\n", report.contacts + report.joints);
}

}  // namespace
}  // namespace motley::bench

int main(int argc, char** argv)
{
    CLI::App app{
        "one step of one kernel, for tools that count instructions; without arguments: names the kernels"};
    std::string kernel, isa = "scalar";
    int sweeps = 1;
    app.add_option("kernel", kernel, "what holds the net together, as in hinge/rigid");
    app.add_option("isa", isa, "scalar, sse2, avx2, avx512 or neon")->capture_default_str();
    app.add_option("sweeps", sweeps, "of solve")->check(CLI::Range(1, 10000))->capture_default_str();
    CLI11_PARSE(app, argc, argv);
    try {
        if (kernel.empty()) {
            for (const auto& tie : motley::bench::every_tie()) fmt::print("{}\n", tie.name);
        } else {
            motley::bench::run(kernel, isa, sweeps);
        }
    } catch (const std::exception& error) {
        fmt::print(stderr, "motley_one_kernel: {}\n", error.what());
        return 2;
    }
    return 0;
}
