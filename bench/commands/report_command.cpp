// Measures what the page shows, scene by scene.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <ctime>
#include <fstream>
#include <stdexcept>
#include <thread>

#include "measuring/host.h"
#include "measuring/runner.h"
#include "page/page.h"
#include "page/plot.h"

namespace motley::bench {
namespace {

/// A scene of the page, small enough that its slowest peer is done in seconds.
struct PageScene {
    const char* name;
    std::int64_t bodies, quick_bodies;
    double seconds;
};
constexpr PageScene page_scenes[] = {
    {"crowd", 10000, 1000, 1},      {"lean", 10000, 1000, 6},
    {"pulse", 10000, 1000, 2},      {"strip", 10000, 1000, 5},
    {"push", 1800, 600, 3},         {"grid", 2500, 400, 2},
    {"chains", 4000, 400, 2},       {"ragdolls", 2200, 220, 2},
    {"load-hanging", 1100, 110, 2}, {"load-level", 1100, 110, 2},
    {"load-10000", 1100, 110, 2},   {"pyramid", 55, 28, 2},
    {"pendulum", 1000, 100, 5},     {"double-pendulum", 1000, 100, 2},
    {"four-bar", 999, 99, 5},
};

std::string first_line_of(const char* command)
{
    FILE* pipe = popen(command, "r");
    std::array<char, 256> line{};
    if (pipe == nullptr) return {};
    if (fgets(line.data(), line.size(), pipe) == nullptr) line[0] = '\0';
    pclose(pipe);
    std::string text = line.data();
    text.erase(std::remove(text.begin(), text.end(), '\n'), text.end());
    return text;
}

void write_text(const std::string& path, const std::string& text)
{
    std::ofstream file(path);
    file << text;
    file.close();
    if (!file) throw std::runtime_error(path + ": cannot be written");
}

}  // namespace

MachineFacts machine_facts()
{
    MachineFacts facts;
    std::ifstream cpuinfo("/proc/cpuinfo");
    for (std::string line; std::getline(cpuinfo, line);) {
        if (line.rfind("model name", 0) == 0) {
            facts.processor = line.substr(line.find(':') + 2);
            break;
        }
    }
    if (facts.processor.empty()) facts.processor = "a processor that does not tell its name";
    facts.cores = static_cast<int>(std::thread::hardware_concurrency());
#if defined(__clang__)
    facts.compiler = "clang " __clang_version__;
#else
    facts.compiler = "g++ " __VERSION__;
#endif
    std::array<char, 32> date{};
    const std::time_t now = std::time(nullptr);
    std::strftime(date.data(), date.size(), "%Y-%m-%d", std::gmtime(&now));
    facts.date = date.data();
    facts.commit = first_line_of("git -C '" MOTLEY_SOURCE "' rev-parse --short HEAD 2>/dev/null");
    if (facts.commit.empty()) facts.commit = "unknown";
    facts.load_before = host_load();
    return facts;
}

void write_report(const ReportOptions& options)
{
    require_gnuplot();
    Report report;
    const int rounds = options.quick ? 1 : options.rounds;
    report.machine = machine_facts();
    for (const std::string& wanted : options.scenes) {
        if (std::none_of(std::begin(page_scenes), std::end(page_scenes),
                         [&](const PageScene& s) { return wanted == s.name; }))
            throw std::runtime_error(fmt::format("the page has no scene '{}'", wanted));
    }
    for (const PageScene& scene : page_scenes) {
        if (!options.scenes.empty() &&
            std::find(options.scenes.begin(), options.scenes.end(), scene.name) == options.scenes.end())
            continue;
        SweepOptions sweep_options;
        sweep_options.agents = options.quick ? scene.quick_bodies : scene.bodies;
        sweep_options.seconds = options.quick ? scene.seconds / 3 : scene.seconds;
        sweep_options.rounds = rounds;
        sweep_options.with_peers = options.with_peers;
        report.sweeps.push_back(sweep(scene.name, {}, sweep_options));
        fmt::print("{}\n", table_of(report.sweeps.back()));
    }
    report.ways = measure_ways(rounds, true);
    report.costs = measure_costs(rounds, true);
    report.limits = measure_machine(default_isa());
    report.kernels = measure_kernels(default_isa());
    report.machine.load_after = host_load();
    write_text(options.output, page_of(report));
    std::string csv, json;
    for (const SweepResult& result : report.sweeps) {
        const std::string lines = csv_of(result);
        csv += csv.empty() ? lines : lines.substr(lines.find('\n') + 1);
        json += (json.empty() ? "[" : ",") + json_of(result);
    }
    write_text(options.output + ".csv", csv);
    write_text(options.output + ".json", json + "]\n");
    fmt::print("{}, {}.csv and {}.json are written\n", options.output, options.output, options.output);
}

}  // namespace motley::bench
