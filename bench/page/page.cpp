// The page's text and charts.
#include "page/page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "page/plot.h"

namespace motley::bench {
namespace {

constexpr const char* grey = "#c8c8c8";
const std::map<std::string, std::string>& colours()
{
    static const std::map<std::string, std::string> all{
        {"motley", "#2f6db5"}, {"Bullet", "#d1722b"}, {"ODE", "#4b9a4b"}};
    return all;
}
std::string colour_of(const std::string& engine)
{
    for (const auto& [name, colour] : colours()) {
        if (engine.rfind(name, 0) == 0) return colour;
    }
    return "#803080";
}

std::string escaped(const std::string& text)
{
    std::string result;
    for (const char c : text) {
        if (c == '<') {
            result += "&lt;";
        } else if (c == '&') {
            result += "&amp;";
        } else {
            result += c;
        }
    }
    return result;
}

std::vector<SweepPoint> of_engine(const SweepResult& sweep, const std::string& engine)
{
    std::vector<SweepPoint> own;
    for (const SweepPoint& p : sweep.points) {
        if (p.engine == engine) own.push_back(p);
    }
    mark_front(own);
    return own;
}

std::vector<std::string> engines_of(const SweepResult& sweep)
{
    std::vector<std::string> engines;
    for (const SweepPoint& p : sweep.points) {
        if (std::find(engines.begin(), engines.end(), p.engine) == engines.end()) engines.push_back(p.engine);
    }
    // motley comes first, whichever engine is fastest.
    std::stable_partition(engines.begin(), engines.end(), [](const std::string& e) { return e == "motley"; });
    return engines;
}

/// Points that are dominated are grey; each engine's front is a line in its colour; motley's front is labelled.
std::string front_chart(const SweepResult& sweep)
{
    Plot plot{"ms a step", sweep.error_name, true, true, {}};
    PlotSeries behind{"behind its engine's front", grey, PlotSeries::Style::dots, {}};
    std::vector<PlotSeries> fronts;
    for (const std::string& engine : engines_of(sweep)) {
        PlotSeries front{engine, colour_of(engine), PlotSeries::Style::line_and_dots, {}};
        for (const SweepPoint& p : of_engine(sweep, engine)) {
            if (!std::isfinite(p.error)) continue;
            PlotPoint point{p.seconds * 1e3, p.error, {}};
            if (p.on_front) {
                if (engine == "motley") point.label = p.label;
                front.points.push_back(point);
            } else {
                behind.points.push_back(point);
            }
        }
        fronts.push_back(std::move(front));
    }
    plot.series.push_back(std::move(behind));
    for (PlotSeries& front : fronts) plot.series.push_back(std::move(front));
    return svg_of(plot);
}

/// How fast each engine is at equal error.
std::string equal_error_table(const SweepResult& sweep)
{
    std::string head = "<table><tr><th>error at most</th>", rows;
    for (const auto& [engine, none] : fastest_within(sweep, 0))
        head += fmt::format("<th>{}, ms</th>", engine);
    for (double error = 1e-1; error > 5e-5; error /= 10) {
        rows += fmt::format("<tr><td>{:.0e}</td>", error);
        for (const auto& [engine, point] : fastest_within(sweep, error)) {
            rows += point == nullptr ? std::string("<td>none</td>")
                                     : fmt::format("<td title=\"{}\">{:.4f}</td>", escaped(point->label),
                                                   point->seconds * 1e3);
        }
        rows += "</tr>\n";
    }
    return head + "</tr>\n" + rows + "</table>\n";
}

std::string sweep_section(const SweepResult& sweep)
{
    std::string text = fmt::format(
        "<h3 id=\"{0}\">{0}</h3>\n<p>{1}. {2} bodies, {3} joints, {4} steps measured, median of {5} "
        "rounds in turn, host load {6:.2f}.</p>\n",
        sweep.scene, escaped(sweep.description), sweep.bodies, sweep.joints, sweep.steps, sweep.rounds,
        sweep.host_load);
    text += "<figure>" + front_chart(sweep) + "</figure>\n";
    text += equal_error_table(sweep);
    const auto lost = unanswered(sweep);
    if (engines_of(sweep).size() > 1) {
        if (lost.empty()) {
            text +=
                "<p>Every point of a peer has a point of motley that is at least as fast and as exact.</p>\n";
        } else {
            text += "<p>Points of a peer that no point of motley is both as fast and as exact as:</p><ul>\n";
            for (const SweepPoint* p : lost)
                text += fmt::format("<li>{}, {}: {:.4g} ms, {:.3g}</li>\n", p->engine, escaped(p->label),
                                    p->seconds * 1e3, p->error);
            text += "</ul>\n";
        }
    }
    if (const DefaultPrice price = price_of_default(sweep); price.settings > 0) {
        text += fmt::format(
            "<p>The default settings take {:.2f} times as long as the fastest setting that is as exact; with "
            "substeps turned and nothing else, the front that they form is at most {:.2f} times off.</p>\n",
            price.settings, price.front);
    }
    for (const std::string& note : sweep.notes) text += "<p>" + escaped(note) + ".</p>\n";
    text +=
        "<details><summary>The fronts as a table</summary><table><tr><th>engine</th><th>setting</th><th>ms a "
        "step</th><th>error</th><th>worst</th></tr>\n";
    for (const std::string& engine : engines_of(sweep)) {
        for (const SweepPoint& p : of_engine(sweep, engine)) {
            if (p.on_front)
                text += fmt::format(
                    "<tr><td>{}</td><td>{}</td><td>{:.4f}</td><td>{:.3g}</td><td>{:.3g}</td></tr>\n",
                    p.engine, escaped(p.label), p.seconds * 1e3, p.error, p.worst);
        }
    }
    return text + "</table></details>\n";
}

std::string costs_section(const std::vector<CostLine>& costs)
{
    std::string text = "<h2 id=\"costs\">What each generality costs</h2>\n";
    for (std::size_t i = 0; i < costs.size();) {
        const std::string& group = costs[i].group;
        Bars bars{"ms a step, solver alone", {}};
        std::string rows;
        const double first = costs[i].seconds;
        for (; i < costs.size() && costs[i].group == group; ++i) {
            const CostLine& line = costs[i];
            bars.bars.emplace_back(line.name, line.seconds * 1e3);
            rows += fmt::format("<tr><td>{}</td><td>{:.4f}</td><td>{:.2f}</td><td>{}</td></tr>\n",
                                escaped(line.name), line.seconds * 1e3, line.seconds / first,
                                line.error < 0 ? "" : fmt::format("{:.3f} %", 100 * line.error));
        }
        text += fmt::format(
            "<h3>{}</h3>\n<figure>{}</figure>\n<table><tr><th></th><th>ms a step</th><th>times the "
            "first</th><th>overlap p99</th></tr>\n{}</table>\n",
            escaped(group), svg_of(bars), rows);
    }
    return text;
}

std::string roofline_section(const Report& report)
{
    const MachineLimits& m = report.limits;
    const double peak = m.flops_per_second * 1e-9;
    Plot plot{"operations a byte streamed", "G operations/s", true, true, {}};
    const auto roof = [&](const char* name, double bandwidth, const char* colour) {
        PlotSeries line{name, colour, PlotSeries::Style::line, {}};
        for (const double x : {0.3, peak / bandwidth, 30.0})
            line.points.push_back({x, std::min(peak, x * bandwidth), {}});
        plot.series.push_back(std::move(line));
    };
    roof("second level cache", m.cache_bytes_per_second * 1e-9, "#888888");
    roof("memory", m.memory_bytes_per_second * 1e-9, "#444444");
    PlotSeries cached{"in cache", "#2f6db5", PlotSeries::Style::dots, {}},
        streaming{"streaming", "#d1722b", PlotSeries::Style::dots, {}};
    std::string rows;
    for (const KernelFigure& k : report.kernels) {
        (k.in_cache ? cached : streaming)
            .points.push_back({k.flops / k.bytes, k.flops / k.seconds * 1e-9, k.in_cache ? k.name : ""});
        rows += fmt::format(
            "<tr><td>{}</td><td>{}</td><td>{:.0f}</td><td>{:.0f}</td><td>{:.2f}</td><td>{:.1f}</"
            "td><td>{:.0f} "
            "%</td><td>{:.1f}</td><td>{:.0f} %</td></tr>\n",
            k.name, k.in_cache ? "in cache" : "streaming", k.bytes, k.flops, k.seconds * 1e9,
            k.flops / k.seconds * 1e-9, 100 * k.flops / k.seconds / m.flops_per_second,
            k.bytes / k.seconds * 1e-9,
            100 * k.bytes / k.seconds / (k.in_cache ? m.cache_bytes_per_second : m.memory_bytes_per_second));
    }
    plot.series.push_back(std::move(cached));
    plot.series.push_back(std::move(streaming));
    return fmt::format(
        "<h2 id=\"roofline\">Roofline</h2>\n<p>One thread, {}. Measured in this run: memory {:.1f} GB/s on "
        "one thread and "
        "{:.1f} on two, second level cache {:.0f} GB/s (triads), {:.0f} G multiplications and additions a "
        "second "
        "without fusing, which equal bits forbid. Operations are counted by running each kernel's maths on a "
        "number that "
        "counts. Bytes are rows, impulses and indices; what bodies add (64 bytes read and written for a "
        "planar pair, 128 "
        "to 320 for a rigid one) comes on top, so a streaming rigid kernel is nearer to the memory's roof "
        "than it "
        "looks, and one in cache is held by moving bodies into lanes and "
        "back.</p>\n<figure>{}</figure>\n<table><tr><th>kernel</th><th></th><th>bytes</th>"
        "<th>operations</th><th>ns</th><th>G/s</th><th>of peak</th><th>GB/s</th><th>of "
        "bandwidth</th></tr>\n{}</table>\n",
        report.kernels.empty() ? "" : isa_name(report.kernels[0].isa), m.memory_bytes_per_second * 1e-9,
        m.memory_bytes_per_second_two * 1e-9, m.cache_bytes_per_second * 1e-9, peak, svg_of(plot), rows);
}

/// Errors against known motions: the default settings with more and more substeps.
std::string accuracy_section(const std::vector<SweepResult>& sweeps)
{
    std::string text;
    for (const SweepResult& sweep : sweeps) {
        if (sweep.error_name.find("true position") == std::string::npos) continue;
        for (const SweepPoint& p : sweep.points) {
            if (!p.dials) continue;
            const SolverSettings& s = p.dials->settings;
            const bool plain = s.method == Method::direct
                                   ? s.drift_correction == DriftCorrection::projection
                                   : s.method == Method::soft_step && s.relaxations == 1 &&
                                         s.iterations == 1 && s.contact_hertz == 0;
            if (plain)
                text += fmt::format(
                    "<tr><td>{}</td><td>{}</td><td>{:.4f}</td><td>{:.3g}</td><td>{:.3g}</td></tr>\n",
                    sweep.scene, escaped(p.label), p.seconds * 1e3, p.error, p.worst);
        }
    }
    if (text.empty()) return {};
    return "<h2 id=\"accuracy\">Accuracy against known motions</h2>\n<p>Equations of motion in minimal "
           "coordinates, integrated in "
           "double. The integrator is of first order: twice the substeps, half the "
           "error.</p>\n<table><tr><th>scene</th>"
           "<th>setting</th><th>ms a step</th><th>error, rms (m)</th><th>worst (m)</th></tr>\n" +
           text + "</table>\n";
}

}  // namespace

std::vector<const SweepPoint*> unanswered(const SweepResult& result)
{
    std::vector<const SweepPoint*> lost;
    for (const SweepPoint& theirs : result.points) {
        if (theirs.engine == "motley" || !std::isfinite(theirs.error)) continue;
        const bool answered =
            std::any_of(result.points.begin(), result.points.end(), [&](const SweepPoint& ours) {
                return ours.engine == "motley" && ours.seconds <= theirs.seconds &&
                       ours.error <= theirs.error;
            });
        if (!answered) lost.push_back(&theirs);
    }
    return lost;
}

DefaultPrice price_of_default(const SweepResult& result)
{
    const auto fastest_as_exact = [&](const SweepPoint& as) {
        double best = as.seconds;
        for (const SweepPoint& p : result.points) {
            if (p.engine == "motley" && p.error <= as.error) best = std::min(best, p.seconds);
        }
        return best;
    };
    const std::string as_it_is = label_of({SolverSettings{}, SolverOptions{}});
    DefaultPrice price;
    std::vector<SweepPoint> turned;
    for (const SweepPoint& p : result.points) {
        if (p.engine != "motley" || !p.dials || !std::isfinite(p.error)) continue;
        SolverSettings settings;
        settings.substeps = p.dials->settings.substeps;
        if (p.label == as_it_is) price.settings = p.seconds / fastest_as_exact(p);
        if (p.label == label_of({settings, SolverOptions{}})) turned.push_back(p);
    }
    mark_front(turned);
    for (const SweepPoint& p : turned) {
        if (p.on_front) price.front = std::max(price.front, p.seconds / fastest_as_exact(p));
    }
    return price;
}

std::string page_of(const Report& report)
{
    const MachineFacts& machine = report.machine;
    std::string text =
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>motley: speed and accuracy, "
        "measured</title>\n<style>body{font:15px/1.5 sans-serif;max-width:900px;margin:2em auto;padding:0 "
        "1em;color:#222}table{border-collapse:collapse;margin:1em 0}td,th{padding:2px "
        "10px;text-align:right;border-bottom:1px solid "
        "#ddd}td:first-child,th:first-child,td:nth-child(2){text-align:left}"
        "figure{margin:1em 0}svg{max-width:100%;height:auto}</style></head><body>\n<h1>motley: speed and "
        "accuracy, "
        "measured</h1>\n";
    text += fmt::format(
        "<p>{}, {} cores; {}; {}; commit {}; host load {:.2f} before and {:.2f} after.</p>\n<p>Each chart "
        "has the time of a step "
        "against the error of the scene, both logarithmic. Points that a faster and more exact setting of "
        "the same engine "
        "beats are grey; the rest are joined. One thread unless said. Every engine ran in the same process, "
        "each point in "
        "turn with all others.</p>\n",
        escaped(machine.processor), machine.cores, escaped(machine.compiler), machine.date, machine.commit,
        machine.load_before, machine.load_after);
    text += "<h2 id=\"fronts\">Fronts</h2>\n";
    for (const SweepResult& sweep : report.sweeps) text += sweep_section(sweep);
    text += accuracy_section(report.sweeps);
    if (!report.ways.empty()) {
        Bars bars{"million agent-steps a second, solver alone: a crowd of 10,000", {}};
        for (const WayLine& way : report.ways)
            bars.bars.emplace_back(way.name, way.agent_steps_per_second * 1e-6);
        text += "<h2 id=\"ways\">Instruction sets and threads</h2>\n<figure>" + svg_of(bars) + "</figure>\n";
    }
    if (!report.costs.empty()) text += costs_section(report.costs);
    if (!report.kernels.empty()) text += roofline_section(report);
    return text + "</body></html>\n";
}

}  // namespace motley::bench
