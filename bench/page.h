// `motley report`: everything that is measured, on one page that opens from disk.
#pragma once

#include <string>
#include <vector>

#include "costs.h"
#include "roofline.h"
#include "sweep.h"

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

/// The page: HTML with its charts and nothing from elsewhere.
std::string page_of(const Report& report);

/// Peers' points that motley has no answer to: no point of it is at least as fast and as exact.
std::vector<const SweepPoint*> unanswered(const SweepResult& result);

/// How many times the fastest point that is as exact the default settings take; 1 is the best, 0: not in the sweep.
struct DefaultPrice {
    double settings = 0;  ///< as they are
    double front = 0;     ///< the worst point of the front that they form when `substeps` alone is turned
};
DefaultPrice price_of_default(const SweepResult& result);

struct ReportOptions {
    std::string output = "motley-report.html";
    std::vector<std::string> scenes;  ///< empty: all of the page's
    int rounds = 3;
    bool quick = false;  ///< small scenes, run once and for a third as long: a page in minutes, for a look
    bool with_peers = true;
};
/// Measures everything and writes the page, and beside it the sweeps as JSON and CSV. Throws std::runtime_error.
void write_report(const ReportOptions& options);

}  // namespace motley::bench
