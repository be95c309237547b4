// What `motley sleep` measures: that in each of its scenes those sleep who should. No test checks speed.
#include "commands/sleep.h"

#include <gtest/gtest.h>

namespace motley::bench {
namespace {

TEST(SleepCommand, SleepersAreThoseWhoStandAndMay)
{
    const std::vector<SleepLine> lines = measure_sleep({.side = 12, .net = 5, .rounds = 1});
    ASSERT_EQ(lines.size(), 8U);
    for (const SleepLine& line : lines) {
        EXPECT_GT(line.seconds, 0) << line.name;
        const bool listed = line.name.starts_with("listed");
        const std::int64_t all = listed ? 25 : 144;
        if (line.name.find("nobody may sleep") != std::string::npos) {
            EXPECT_EQ(line.asleep, 0) << line.name;
            EXPECT_GT(line.contacts, 0) << line.name;
        } else if (line.name.find("all sleep") != std::string::npos) {
            EXPECT_EQ(line.asleep, all) << line.name;
            EXPECT_EQ(line.contacts, 0) << line.name;
        }
    }
    EXPECT_NE(table_of(lines).find("ms a step"), std::string::npos);
}

}  // namespace
}  // namespace motley::bench
