// What `motley scale` measures: that its figures have plausible sizes and agree with each other. No test checks
// speed.
#include "commands/scale.h"

#include <gtest/gtest.h>

namespace motley::bench {
namespace {

TEST(Scale, EverySizeHasItsFigures)
{
    const ScaleResult result = measure_scale({.people = {1000, 2000},
                                              .densities = {5},
                                              .rounds = 1,
                                              .solver = {.threads = 2, .alone_below = 0},
                                              .progress = false});
    ASSERT_EQ(result.sizes.size(), 4U);
    for (const Mark& mark : result.marks) EXPECT_TRUE(mark.passes()) << mark.name << ": " << mark.value;
    for (const ScaleResult::Size& size : result.sizes) {
        // At 5 people per m2 a person touches, or is within the margin of, about two others.
        const auto people = static_cast<double>(size.people);
        // A body, half a dozen numbers of the host, and a contact.
        EXPECT_GT(size.bytes / people, 300);
        EXPECT_GT(size.contacts, 0.3 * people);
        EXPECT_LT(size.contacts, 3 * people);
        // Times of which one is inside the other, whatever the clock says.
        EXPECT_GE(size.step_seconds, size.solver_seconds);
        EXPECT_LE(size.sweep_share, 1);
        EXPECT_GT(size.sweep_seconds, 0);
        // A smooth contact of discs moves 28 B of its row, with a wall 36, and 100 B of its bodies and impulse.
        EXPECT_GT(size.sweep_bytes_per_second * size.sweep_seconds, 128);
        EXPECT_LT(size.sweep_bytes_per_second * size.sweep_seconds, 136);
        EXPECT_GT(size.triad_bytes_per_second, 0);
    }
    EXPECT_EQ(result.sizes[1].people, 1000);
    EXPECT_EQ(result.sizes[1].threads, 2);
    EXPECT_EQ(result.sizes[1].state_hash, result.sizes[0].state_hash);
    EXPECT_NE(result.sizes[2].state_hash, result.sizes[0].state_hash);
    EXPECT_NE(table_of(result).find("of triad"), std::string::npos);
}

}  // namespace
}  // namespace motley::bench
