// Runs several ways side by side, interleaved so that a slowdown of the machine affects all of them.
#include "commands/demo.h"

#include <fmt/format.h>

#include <thread>
#include <vector>

#include "measuring/host.h"
#include "measuring/median.h"
#include "measuring/runner.h"

namespace motley::bench {
namespace {

struct Way {
    Isa isa;
    int threads;
    bool lists_contacts;                  ///< the host searches, and gives the contacts as a list
    std::vector<double> rates;            ///< agent-steps/s, one a round
    std::vector<double> unsteered_rates;  ///< the same without the host's steering
    RunResult last;
};

/// True when every way ended in the same bits.
bool compare_ways(const DemoOptions& options, std::int64_t agents)
{
    std::vector<Way> ways;
    const Isa widest = available_isas().back();
    for (const Isa isa : available_isas()) ways.push_back({isa, 1, false, {}, {}, {}});
    ways.push_back({widest, 2, false, {}, {}, {}});
    for (const int threads : {1, 2}) ways.push_back({widest, threads, true, {}, {}, {}});
    const SceneEntry& crowd = *find_scene("crowd");
    RunOutputs quiet;
    quiet.progress = false;
    for (int round = 0; round < options.rounds; ++round) {
        for (Way& way : ways) {
            RunOptions run;
            run.agents = agents;
            run.seconds = options.seconds;
            run.solver = {.threads = way.threads, .isa = way.isa};
            run.lists_contacts = way.lists_contacts;
            way.last = run_scene(crowd, run, quiet);
            way.rates.push_back(way.last.bodies / way.last.median_step_seconds);
            way.unsteered_rates.push_back(way.last.bodies / way.last.median_unsteered_seconds);
            fmt::print(stderr, "crowd of {}: round {} of {}, {} x {}\n", agents, round + 1, options.rounds,
                       isa_name(way.isa), way.threads);
        }
    }
    fmt::print(
        "\ncrowd of {} people, 5 per m2, {} steps of 1/60 s, 4 substeps; median over means of 8 steps, "
        "median of {} "
        "interleaved rounds, "
        "host load {:.2f}\n",
        agents, ways[0].last.steps, options.rounds, host_load());
    fmt::print("{:<10}{:>8}{:>10}{:>18}{:>16}{:>11}{:>14}  {}\n", "isa", "threads", "contacts",
               "M agent-steps/s", "steering apart", "x scalar", "overlap p99", "state hash");
    bool same = true;
    for (const Way& way : ways) {
        fmt::print("{:<10}{:>8}{:>10}{:>18.2f}{:>16.2f}{:>11.2f}{:>12.3f} %  {:016x}\n", isa_name(way.isa),
                   way.threads, way.lists_contacts ? "listed" : "found", median(way.rates) * 1e-6,
                   median(way.unsteered_rates) * 1e-6,
                   median(way.unsteered_rates) / median(ways[0].unsteered_rates), 100 * way.last.overlap_p99,
                   way.last.state_hash);
        same = same && (way.lists_contacts || way.last.state_hash == ways[0].last.state_hash);
    }
    fmt::print("{}\n", same ? "every instruction set and number of threads ends in the same bits"
                            : "THE WAYS END IN DIFFERENT BITS");
    return same;
}

}  // namespace

int run_demo(const DemoOptions& options)
{
    fmt::print("{}", table_of(run_scene(*find_scene("bottleneck"), {}, {})));
    bool same = true;
    for (const std::int64_t agents : {10000, 100000}) same = compare_ways(options, agents) && same;
    // A million people for a few steps, once: half a minute.
    const DemoOptions few{.seconds = options.seconds * 0.4, .rounds = 1};
    same = compare_ways(few, 1000000) && same;
    return same ? 0 : 1;
}

}  // namespace motley::bench
