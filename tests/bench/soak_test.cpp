// A small soak: a town of sixty people for fifty simulated seconds, on one and on two threads.
#include "commands/soak.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace motley::bench {
namespace {

TEST(Soak, ATownOfSixtyLosesNobodyInThreeThousandSteps)
{
    const SoakResult result = soak({.steps = 3000, .people = 60, .progress = false});
    EXPECT_EQ(result.failure, "");
    EXPECT_EQ(result.steps, 3000);
    // Each kind of event that the soak exercises has happened.
    EXPECT_GT(result.joined, 60);
    EXPECT_GT(result.left, 50);
    EXPECT_GT(result.fallen, 10);
    EXPECT_GT(result.risen, 10);
    EXPECT_GT(result.broken, 3);
    EXPECT_EQ(result.restored, 3);
}

TEST(Soak, RefusesATownWithoutPeopleOrTime)
{
    EXPECT_THROW(soak({.people = 3, .progress = false}), std::invalid_argument);
    EXPECT_THROW(soak({.seconds = 0, .progress = false}), std::invalid_argument);
}

}  // namespace
}  // namespace motley::bench
