// `motley report`: all measurements on one page that opens from disk.
#pragma once

#include <string>
#include <vector>

#include "commands/costs.h"
#include "commands/sweep.h"
#include "measuring/roofline.h"

namespace motley::bench {

/// Where and when the figures were taken.
struct MachineFacts {
    std::string processor, compiler, date, commit;
    int cores = 0;
    double load_before = 0, load_after = 0;
};
MachineFacts machine_facts();

struct Report {
    MachineFacts machine;
    std::vector<SweepResult> sweeps;
    std::vector<WayLine> ways;
    std::vector<CostLine> costs;
    MachineLimits limits;
    std::vector<KernelFigure> kernels;
};

/// The page: self-contained HTML with its charts.
std::string page_of(const Report& report);

/// The peers' points for which motley has no point that is at least as fast and at least as exact.
std::vector<const SweepPoint*> unanswered(const SweepResult& result);

/// How many times as long the default settings take as the fastest point that is as exact; 1 is best, 0 means not in
/// the sweep.
struct DefaultPrice {
    double settings = 0;  ///< as they are
    double front = 0;     ///< the worst such ratio on the front of the defaults with `substeps` varied
};
DefaultPrice price_of_default(const SweepResult& result);

struct ReportOptions {
    std::string output = "motley-report.html";
    std::vector<std::string> scenes;  ///< empty: all of the page's
    int rounds = 3;
    bool quick = false;  ///< small scenes, run once for a third of the time: a page in minutes
    bool with_peers = true;
};
/// Measures everything and writes the page, and next to it the sweeps as JSON and CSV. Throws std::runtime_error.
void write_report(const ReportOptions& options);

}  // namespace motley::bench
