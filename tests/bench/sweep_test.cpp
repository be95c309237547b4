// Sweeps: which points there are, which of them form the front, and what is written.
#include "commands/sweep.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>

#include "engines/engine.h"

namespace motley::bench {
namespace {

TEST(Front, IsWhatNobodyBeatsInBoth)
{
    const auto point = [](double seconds, double error) {
        SweepPoint p;
        p.seconds = seconds;
        p.error = error;
        return p;
    };
    std::vector<SweepPoint> points{point(1, 5), point(2, 5),
                                   point(2, 3), point(3, 4),
                                   point(4, 1), point(0.5, std::numeric_limits<double>::infinity())};
    mark_front(points);
    const bool expected[] = {true, false, true, false, true, false};
    for (std::size_t i = 0; i < points.size(); ++i) EXPECT_EQ(points[i].on_front, expected[i]) << i;
}

TEST(Front, TellsTheFastestOfEachEngineWithinAnError)
{
    SweepResult result;
    const auto add = [&](const char* engine, double seconds, double error) {
        result.points.emplace_back();
        result.points.back().engine = engine;
        result.points.back().seconds = seconds;
        result.points.back().error = error;
    };
    add("other", 1, 0.1);
    add("motley", 2, 0.02);
    add("motley", 3, 0.01);
    add("other", 4, 0.05);
    const auto fastest = fastest_within(result, 0.02);
    ASSERT_EQ(fastest.size(), 2U);
    EXPECT_EQ(fastest[0].first, "motley");
    ASSERT_NE(fastest[0].second, nullptr);
    EXPECT_EQ(fastest[0].second->seconds, 2);
    EXPECT_EQ(fastest[1].second, nullptr);
}

TEST(Dials, EveryCombinationOnceUnderItsOwnName)
{
    DialGrid grid;
    grid.threads = {1, 2};
    grid.warm_starts = {0, 1};
    grid.tolerances = {0, 0.001F};
    const std::vector<Dials> all = expand(grid);
    // soft_step: 5 substeps x 2 iterations x (no relaxation, or one and contacts exact or not) x 2 hertz x 2 exact x 2
    // x 2 x 2; sequential_impulse: 5 x 4 x 2 x 2 x 2 x 2; direct: 2 x 2.
    EXPECT_EQ(all.size(), 960U + 320U + 4U);
    std::set<std::string> labels;
    for (const Dials& dials : all) labels.insert(label_of(dials));
    EXPECT_EQ(labels.size(), all.size());
}

TEST(Dials, OutOfRangeAreRefusedBeforeAnythingRuns)
{
    DialGrid grid;
    grid.substeps = {4, 0};
    EXPECT_THROW(expand(grid), InvalidInput);
}

SweepResult small_sweep(bool with_peers)
{
    DialGrid grid;
    grid.methods = {Method::soft_step, Method::sequential_impulse};
    grid.substeps = {1, 8};
    grid.hertz = {1e6F};
    grid.relaxations = {1};
    grid.iterations = {4};
    SweepOptions options;
    options.agents = 40;
    options.seconds = 0.5;
    options.rounds = 2;
    options.progress = false;
    options.with_peers = with_peers;
    return sweep("chains", grid, options);
}

TEST(Sweep, MoreSubstepsAreMoreExact)
{
    const SweepResult result = small_sweep(false);
    ASSERT_EQ(result.points.size(), 4U + 4U);
    const SweepPoint *coarse = nullptr, *fine = nullptr;
    for (const SweepPoint& p : result.points) {
        if (p.label == "soft 1 x 4+1, stiffest") coarse = &p;
        if (p.label == "soft 8 x 4+1, stiffest") fine = &p;
    }
    ASSERT_NE(coarse, nullptr);
    ASSERT_NE(fine, nullptr);
    EXPECT_GT(coarse->error, 3 * fine->error);
}

TEST(Sweep, ListsPointsByTheMedianOfTheirRounds)
{
    // Whatever the clock says: which point is fast is not tested here.
    const SweepResult result = small_sweep(false);
    for (std::size_t i = 0; i < result.points.size(); ++i) {
        const SweepPoint& p = result.points[i];
        ASSERT_EQ(p.step_seconds.size(), 2U);
        const auto [least, most] = std::minmax(p.step_seconds[0], p.step_seconds[1]);
        EXPECT_GE(p.seconds, least);
        EXPECT_LE(p.seconds, most);
        if (i > 0) {
            EXPECT_LE(result.points[i - 1].seconds, p.seconds);
        }
    }
}

TEST(Sweep, WritesWhatItMeasured)
{
    const SweepResult result = small_sweep(true);
    const auto json = nlohmann::json::parse(json_of(result));
    EXPECT_EQ(json["points"].size(), result.points.size());
    EXPECT_EQ(json["joints"], 40);
    std::set<std::string> engines;
    for (const auto& point : json["points"]) engines.insert(point["engine"]);
    // Every peer is either built in or listed as missing.
    EXPECT_EQ(engines.size(), 1 + peers().size());
    EXPECT_EQ(peers().size() + missing_peers().size(), 2U);
    for (const auto& point : json["points"]) {
        if (!point.contains("dials")) continue;
        EXPECT_TRUE(point["dials"]["exact_joints"].is_boolean());
    }
    const std::string csv = csv_of(result);
    std::istringstream lines(csv);
    std::string line, label;
    std::getline(lines, line);
    const auto commas = std::count(line.begin(), line.end(), ',');
    while (std::getline(lines, line)) {
        // Labels contain commas.
        const std::size_t first = line.find('"'), last = line.rfind('"');
        label = line.substr(first, last - first);
        EXPECT_EQ(std::count(line.begin(), line.end(), ',') - std::count(label.begin(), label.end(), ','),
                  commas)
            << line;
    }
    EXPECT_EQ(static_cast<std::size_t>(std::count(csv.begin(), csv.end(), '\n')), 1 + result.points.size());
}

TEST(Sweep, JudgesASceneByItsOwnError)
{
    // The pulse has no overlap: its error is that against the pulse's law.
    DialGrid grid;
    grid.methods = {Method::soft_step};
    grid.substeps = {4};
    grid.relaxations = {1};  // with 0, soft contacts push bodies apart that should stay together
    SweepOptions options;
    options.agents = 20;
    options.seconds = 1;
    options.rounds = 1;
    options.progress = false;
    const SweepResult result = sweep("pulse", grid, options);
    EXPECT_NE(result.error_name.find("exact law"), std::string::npos);
    for (const SweepPoint& p : result.points) {
        EXPECT_GT(p.error, 0) << p.label;
        EXPECT_LT(p.error, 0.1) << p.label;
    }
}

TEST(Sweep, OfNoSceneSaysSo)
{
    EXPECT_THROW(sweep("nowhere", {}, {}), std::runtime_error);
}

}  // namespace
}  // namespace motley::bench
