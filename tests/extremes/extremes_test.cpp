// Each extreme scene, under each way to solve, is within its bound and has the same bits on every instruction set.
// bench/commands/extremes.cpp has the bounds and the reasons for them.
#include "commands/extremes.h"

#include <gtest/gtest.h>

#include <cctype>
#include <string_view>

namespace motley::bench {
namespace {

class Extremes : public ::testing::TestWithParam<int> {
  protected:
    [[nodiscard]] const ExtremeCase& extreme() const
    {
        return extreme_cases()[static_cast<std::size_t>(GetParam())];
    }
};

TEST_P(Extremes, KeepWithinTheirBoundsUnderEveryMethod)
{
    for (int way = 0; way < extreme_way_count; ++way) {
        const auto which = static_cast<ExtremeWay>(way);
        const double figure = extreme().figure({which, {}}),
                     bound = extreme().bound[static_cast<std::size_t>(way)];
        if (bound == no_claim) continue;
        EXPECT_LE(figure, bound) << name_of(which) << ", " << extreme().unit << ": " << extreme().must;
    }
}

TEST_P(Extremes, HaveTheSameFiguresOnEveryInstructionSet)
{
    for (const std::string_view longest : {"an hour without weight", "10,000 bounces with restitution 1"}) {
        if (extreme().name == longest) GTEST_SKIP() << "the same step hundreds of thousands of times";
    }
    for (const ExtremeWay way : {ExtremeWay::soft_step, ExtremeWay::exact, ExtremeWay::projection}) {
        const double scalar = extreme().figure({way, {.isa = Isa::scalar}});
        for (const Isa isa : available_isas())
            EXPECT_EQ(extreme().figure({way, {.isa = isa}}), scalar)
                << name_of(way) << " on " << isa_name(isa);
    }
}

std::string name_of_case(const ::testing::TestParamInfo<int>& info)
{
    std::string name;
    for (const char c : std::string(extreme_cases()[static_cast<std::size_t>(info.param)].name))
        name += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
    return name;
}

INSTANTIATE_TEST_SUITE_P(Cases, Extremes, ::testing::Range(0, static_cast<int>(extreme_cases().size())),
                         name_of_case);

}  // namespace
}  // namespace motley::bench
