// The page of `motley report`: what it says about a sweep, and that its charts have every point.
#include "page/page.h"

#include <gtest/gtest.h>

#include <limits>

#include "page/plot.h"

namespace motley::bench {
namespace {

SweepPoint point(const char* engine, const char* label, double seconds, double error)
{
    SweepPoint p;
    p.engine = engine;
    p.label = label;
    p.seconds = seconds;
    p.error = p.worst = error;
    return p;
}

SweepResult small_result()
{
    SweepResult result;
    result.scene = "made-up";
    result.description = "five points & <one> that came apart";
    result.error_name = "error (m)";
    const auto defaults = [](int substeps) {
        Dials dials;
        dials.settings.substeps = substeps;
        return dials;
    };
    result.points = {point("motley", "soft 1 x 1+1", 1e-3, 0.1),
                     point("Peer 1", "fast", 2e-3, 0.5),
                     point("motley", "soft 4 x 1+1", 4e-3, 0.02),
                     point("Peer 1", "fine", 8e-3, 0.001),
                     point("motley", "impulse 1 x 8, Baumgarte", 2e-3, 0.02),
                     point("Peer 1", "lost", 1e-3, std::numeric_limits<double>::infinity())};
    result.points[0].dials = defaults(1);
    result.points[2].dials = defaults(4);
    result.points[4].dials = defaults(1);
    result.points[4].dials->settings.method = Method::sequential_impulse;
    return result;
}

std::size_t count_of(const std::string& text, const std::string& part)
{
    std::size_t count = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
    return count;
}

TEST(Page, NamesThePeersPointsThatMotleyHasNoAnswerTo)
{
    const SweepResult result = small_result();
    const auto lost = unanswered(result);
    ASSERT_EQ(lost.size(), 1U);
    EXPECT_EQ(lost[0]->label, "fine");
}

TEST(Page, PricesTheDefaultAgainstTheFastestThatIsAsExact)
{
    // Four substeps take twice as long as the sequential impulses that are as exact; no point beats one substep.
    EXPECT_DOUBLE_EQ(price_of_default(small_result()).settings, 2);
    EXPECT_DOUBLE_EQ(price_of_default(small_result()).front, 2);
    SweepResult result = small_result();
    result.points[2].seconds = result.points[0].seconds;  // then four substeps are the whole front
    EXPECT_DOUBLE_EQ(price_of_default(result).front, 1);
    EXPECT_EQ(price_of_default({}).settings, 0);
}

TEST(Page, DrawsEveryPointAndNeedsNothingFromElsewhere)
{
    try {
        require_gnuplot();
    } catch (const std::runtime_error& error) {
        GTEST_SKIP() << error.what();
    }
    Report report;
    report.machine = machine_facts();
    report.sweeps = {small_result()};
    report.ways = {{"scalar, 1 thread", 1e6}, {"avx2, 1 thread", 3e6}};
    report.costs = {{"a group", "first", 1e-3, -1}, {"a group", "second", 2e-3, 0.01}};
    const std::string page = page_of(report);
    EXPECT_EQ(count_of(page, "<svg"), 3U);
    // Five points that have an error, and one symbol for each of three series in the key; all other symbols are
    // gnuplot's definitions.
    EXPECT_EQ(count_of(page, "' transform='translate("), 5U + 3U);
    EXPECT_EQ(count_of(page, "src=") + count_of(page, "<link") + count_of(page, "@import"), 0U);
    EXPECT_NE(page.find("five points &amp; &lt;one> that came apart"), std::string::npos);
    EXPECT_NE(page.find("The default settings take 2.00 times"), std::string::npos);
}

}  // namespace
}  // namespace motley::bench
