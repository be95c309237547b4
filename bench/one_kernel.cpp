// One kernel and nothing else, for tools that count instructions: bench/count-instructions.
//   motley_one_kernel                        names the kernels
//   motley_one_kernel KERNEL ISA SWEEPS      one step of so many sweeps; prints how many constraints there are
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <string_view>

#include "motley/motley.h"
#include "tie_net.h"

namespace motley::bench {
namespace {

/// A net small enough for a simulated processor: seven colours' blocks and some padding.
constexpr int side = 24;

int run(std::string_view kernel, std::string_view isa_text, std::string_view sweeps_text)
{
    const std::vector<NamedTie> ties = every_tie();
    const auto tie =
        std::find_if(ties.begin(), ties.end(), [&](const NamedTie& t) { return t.name == kernel; });
    const std::vector<Isa> isas = available_isas();
    const auto isa = std::find_if(isas.begin(), isas.end(), [&](Isa i) { return isa_name(i) == isa_text; });
    int sweeps = 0;
    const auto [end, error] =
        std::from_chars(sweeps_text.data(), sweeps_text.data() + sweeps_text.size(), sweeps);
    const bool is_number = error == std::errc() && end == sweeps_text.data() + sweeps_text.size();
    if (tie == ties.end() || isa == isas.end() || !is_number || sweeps < 1 || sweeps > 10000) {
        fmt::print(stderr,
                   "motley_one_kernel: '{}' is a kernel: {}; '{}' is an instruction set here: {}; "
                   "'{}' is 1 to 10000 sweeps: {}\n",
                   kernel, tie != ties.end(), isa_text, isa != isas.end(), sweeps_text,
                   is_number && sweeps >= 1 && sweeps <= 10000);
        return 2;
    }
    const auto net = make_net(tie->tie, tie->model, side);
    Solver solver({.substeps = 1, .iterations = sweeps, .relaxations = 0}, {.isa = *isa});
    const StepReport report = solver.step(net->scene, 1e-3F, net->contacts);
    fmt::print("{}\n", report.contacts + report.joints);
    return report.status == StepStatus::done ? 0 : 1;
}

}  // namespace
}  // namespace motley::bench

int main(int argc, char** argv)
{
    if (argc == 1) {
        for (const auto& tie : motley::bench::every_tie()) fmt::print("{}\n", tie.name);
        return 0;
    }
    if (argc != 4) {
        fmt::print(stderr, "usage: motley_one_kernel [KERNEL ISA SWEEPS]\n");
        return 2;
    }
    return motley::bench::run(argv[1], argv[2], argv[3]);
}
