// The exact laws of crowds, at the default settings. Independent evidence: momentum balance and kinematics, done by
// hand.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "commands/laws.h"
#include "measuring/runner.h"

namespace motley::bench {
namespace {

RunResult run(const char* scene, std::int64_t agents, double seconds = 0, const SolverSettings& settings = {},
              bool is_listed = false)
{
    RunOptions options;
    options.settings = settings;
    options.agents = agents;
    options.seconds = seconds;
    options.lists_contacts = is_listed;
    RunOutputs quiet;
    quiet.progress = false;
    return run_scene(*find_scene(scene), options, quiet);
}

/// The same laws with contacts that the library finds, and with a list.
class CrowdLaws : public ::testing::TestWithParam<bool> {
  protected:
    static double error_of(const char* scene, std::int64_t agents, const SolverSettings& settings = {})
    {
        const RunResult result = run(scene, agents, 0, settings, GetParam());
        EXPECT_EQ(result.lists_contacts, GetParam());
        return result.error->value;
    }
};
INSTANTIATE_TEST_SUITE_P(Contacts, CrowdLaws, ::testing::Bool(),
                         [](const auto& which) { return which.param ? "Listed" : "Found"; });

TEST_P(CrowdLaws, LeaningRowsHandOnWhatIsBehindThem)
{
    // Contact k from the back carries k F. Bound: a hundredth of the force on the wall, in every step.
    EXPECT_LT(error_of("lean-10", 100), 0.01);
    EXPECT_LT(error_of("lean-30", 90), 0.01);
    // A row of a hundred settles slowly at the default settings: tests/README.md, "Limits and debts".
    SolverSettings stiffest;
    stiffest.substeps = 16;
    stiffest.contact_hertz = 1e6F;
    EXPECT_LT(error_of("lean", 100, stiffest), 0.01);
}

TEST_P(CrowdLaws, AnInelasticPulseTakesAllAlong)
{
    // The n-th disc is hit at g n (n + 1)/(2 v). Bound: an error of a hundredth of that time, in which the first
    // disc, which moves at v/n, crosses (n + 1)/200 gaps: 0.045 for the eighth disc, the last that is hit within 3 s.
    EXPECT_LT(error_of("pulse", 20), 0.045);
}

TEST_P(CrowdLaws, AStripOfAPushedCrowdIsAnInelasticPulse)
{
    // Here a disc crosses more than a gap in a step. Bound as above: 42 discs are hit within 10 s, so 0.2 gaps at the
    // end. The error grows with the root of time, so its rms over the run is the root of a half of that.
    EXPECT_LT(error_of("strip", 100), 0.2 * std::sqrt(0.5));
}

TEST_P(CrowdLaws, AWaveKeepsItsMomentum)
{
    const RunResult result = run("wave", 1000, 1, {}, GetParam());
    ASSERT_FALSE(result.figures.empty());
    EXPECT_EQ(result.figures.front().first, "momentum along, off what was given (share)");
    // Bound: rounding of 1,000 bodies' speeds in 60 steps of 4 substeps.
    EXPECT_LT(std::abs(result.figures.front().second), 1e-5);
    EXPECT_LT(result.overlap_p99, 0.01);
}

TEST(ElasticPulse, IsHandedOn)
{
    // Each disc moves on by a gap and stops. The next disc learns of an impact up to a step late, and 1.5 m/s / 60 Hz
    // is a quarter of the gap. (Here a gap takes exactly four steps, so that nothing is late.)
    const RunResult result = run("bounce", 20);
    EXPECT_LT(result.error->value, 0.25);
    ASSERT_FALSE(result.figures.empty());
    EXPECT_EQ(result.figures.front().first, "kinetic energy kept (%)");
    EXPECT_NEAR(result.figures.front().second, 100, 0.01);
}

TEST(Runs, TellOfAllTheirStepsInNumbers)
{
    // The pulse has left the row long before the end, so that nothing touches in the last step.
    const RunResult result = run("bounce", 20, 3);
    ASSERT_EQ(result.last.contacts, 0);
    ASSERT_GT(result.constraints, 0);
    EXPECT_GE(result.colours, 1);
    EXPECT_GE(result.lane_occupancy, 1.0 / 16);
    EXPECT_LE(result.lane_occupancy, 1);
    EXPECT_GT(result.bytes_per_constraint, 30);
    const auto json = nlohmann::json::parse(json_of(result));
    EXPECT_EQ(json["lane_occupancy"], result.lane_occupancy);
    EXPECT_GT(json["bytes_per_constraint"], 30);
    ASSERT_FALSE(json["figures"].empty());
    for (const auto& figure : json["figures"]) EXPECT_TRUE(figure.is_number()) << figure;
}

TEST(Laws, HoldInTheQuickTableButForItsDebts)
{
    const std::vector<LawResult> results = run_laws({.quick = true, .progress = false});
    EXPECT_EQ(failures_in(results, false), 0) << table_of(results);
    const std::string table = table_of(results);
    EXPECT_NE(table.find("PASS"), std::string::npos);
    EXPECT_NE(table.find("doors close"), std::string::npos);
}

TEST(Laws, AMissedLawCountsUnlessItIsADebtOfTheDefaults)
{
    const std::vector<Mark> missed{{"a law", 2, 1}}, met{{"a law", 1, 1}};
    LawResult result;
    result.name = "scene";
    result.marks[static_cast<int>(LawWay::found)] = missed;
    result.marks[static_cast<int>(LawWay::found_fine)] = met;
    result.marks[static_cast<int>(LawWay::listed)] = missed;
    EXPECT_EQ(failures_in({result}, false), 1) << "what a host lists is printed beside, and does not count";
    EXPECT_NE(table_of({result}).find("2 FAIL "), std::string::npos) << table_of({result});
    result.debt = "another law";
    EXPECT_EQ(failures_in({result}, false), 1) << "a debt names its law";
    result.debt = "a law";
    EXPECT_EQ(failures_in({result}, false), 0);
    EXPECT_EQ(failures_in({result}, true), 1);
    EXPECT_NE(table_of({result}).find("2 FAIL*"), std::string::npos) << table_of({result});
    result.marks[static_cast<int>(LawWay::found_fine)] = missed;
    EXPECT_EQ(failures_in({result}, false), 1) << "a debt is one of the defaults alone";
    result.marks[static_cast<int>(LawWay::found_fine)] = {{"a law", std::nan(""), 1}};
    EXPECT_EQ(failures_in({result}, false), 1) << "what is not a number meets no law";
    LawResult listed_only;
    listed_only.marks[static_cast<int>(LawWay::listed)] = missed;
    EXPECT_EQ(failures_in({listed_only}, false), 1) << "the library cannot find these: the list counts";
}

/// What contacts of discs do not have makes a host's search list them, and a scene without one says so.
TEST(Runs, ListContactsWhereTheyAreAskedTo)
{
    const auto settled = [](const char* scene, const auto& change) {
        RunOptions options;
        change(options);
        settle_options(*find_scene(scene), options);
        return options.lists_contacts;
    };
    EXPECT_FALSE(settled("push", [](RunOptions&) {}));
    EXPECT_TRUE(settled("bounce", [](RunOptions&) {}));
    const auto listed = [](RunOptions& options) { options.lists_contacts = true; };
    EXPECT_TRUE(settled("push", listed));
    EXPECT_FALSE(settled("lean", [](RunOptions& options) { options.settings.tolerance = 0.1F; }));
    EXPECT_FALSE(settled("wave", [](RunOptions& options) { options.settings.measures = true; }));
    EXPECT_FALSE(settled("crowd", [](RunOptions& options) { options.direct_every = 10; }));
    const auto refusal = [&](const char* scene, const auto& change) {
        try {
            settled(scene, change);
        } catch (const InvalidInput& error) {
            return std::string(error.what());
        }
        return std::string("none");
    };
    EXPECT_NE(refusal("door-closes", listed).find("--listed: the scene door-closes"), std::string::npos);
    EXPECT_NE(refusal("lean", [](RunOptions& options) { options.door = 1; }).find("--door: the scene lean"),
              std::string::npos);
    EXPECT_NE(refusal("grid", [](RunOptions& options) { options.density = 1; }).find("--density"),
              std::string::npos);
    const auto orca = [](RunOptions& options) { options.steering = SteeringModel::orca; };
    EXPECT_NE(refusal("push", orca).find("--steering"), std::string::npos);
    EXPECT_FALSE(settled("evacuation", orca));
}

}  // namespace
}  // namespace motley::bench
