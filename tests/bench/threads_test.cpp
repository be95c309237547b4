// What `motley threads` measures: that its figures agree with each other and bits are the same. No test checks speed.
#include "commands/threads.h"

#include <gtest/gtest.h>

#include <cmath>

#include "commands/cores.h"

namespace motley::bench {
namespace {

TEST(Threads, EverySceneHasItsFigures)
{
    ThreadsOptions options;
    options.scenes = {"crowd", "chains"};
    options.agents = 200;
    options.turns = 5;
    options.solver.alone_below = 0;
    options.progress = false;
    const std::vector<ThreadsResult> results = measure_threads(options);
    ASSERT_EQ(results.size(), 2U);
    for (const ThreadsResult& result : results) {
        EXPECT_TRUE(result.same_bits) << result.scene;
        EXPECT_GT(result.one_thread_seconds, 0);
        EXPECT_GT(result.seconds, 0);
        EXPECT_EQ(result.all.turns, 5);
        EXPECT_LE(result.near.turns + result.far.turns, 5);
        EXPECT_GT(result.all.lower_quartile, 0);
        EXPECT_LE(result.all.lower_quartile, result.all.median);
        EXPECT_LE(result.all.median, result.all.upper_quartile);
    }
    EXPECT_NE(table_of(results, 2).find("chains"), std::string::npos);
}

TEST(Threads, RefusesOneThreadAndScenesThatAreNotThere)
{
    EXPECT_THROW(measure_threads({.solver = {.threads = 1}}), InvalidInput);
    EXPECT_THROW(measure_threads({.scenes = {"nowhere"}}), std::runtime_error);
}

/// An executor that never brings its second thread, which executors are allowed to do.
class Lonely final : public Executor {
  public:
    [[nodiscard]] int concurrency() const override { return 2; }
    void run(int workers, Job job) override
    {
        for (int worker = 0; worker < workers; ++worker) job(worker);
    }
};

TEST(Threads, NobodyWaitsForAThreadThatDoesNotCome)
{
    Lonely executor;
    const CoresAtHand at_hand = look_at_cores(executor);
    EXPECT_DOUBLE_EQ(at_hand.cores, 1);
    EXPECT_TRUE(std::isinf(at_hand.hand_over_seconds));
}

}  // namespace
}  // namespace motley::bench
