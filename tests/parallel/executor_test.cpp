// A host's own threads: whatever an executor lends, a step finishes, with the same bits.
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "mixed_scene.h"
#include "stage_runner.h"

namespace motley {
namespace {

/// Starts a thread for every worker, in no order, and may forget some of them.
class ThreadExecutor final : public Executor {
  public:
    ThreadExecutor(int concurrency, int lent) : concurrency_(concurrency), lent_(lent) {}
    [[nodiscard]] int concurrency() const override { return concurrency_; }
    void run(int workers, const std::function<void(int)>& job) override
    {
        std::vector<std::thread> threads;
        for (int worker = workers - 1; worker >= 1; --worker) {
            if (worker <= lent_) threads.emplace_back([&job, worker] { job(worker); });
        }
        job(0);
        for (std::thread& thread : threads) thread.join();
        ++runs;
    }
    int runs = 0;

  private:
    int concurrency_, lent_;
};

std::uint64_t hash_after_steps(const SolverOptions& options)
{
    testing::MixedScene mixed;
    SolverSettings settings;
    settings.gravity = {0, -9.81F, 0};
    Solver solver(settings, options);
    for (int step = 0; step < 60; ++step) {
        EXPECT_EQ(solver.step(mixed.scene, 1.0F / 60, mixed.contacts()).status, StepStatus::done);
    }
    return mixed.scene.state_hash();
}

TEST(Executor, AHostsOwnThreadsGiveTheSameBits)
{
    const std::uint64_t alone = hash_after_steps({.threads = 1});
    for (const int concurrency : {2, 3, 7}) {
        ThreadExecutor host(concurrency, concurrency);
        EXPECT_EQ(hash_after_steps({.alone_below = 0, .executor = &host}), alone) << concurrency;
        EXPECT_EQ(host.runs, 60);
    }
}

TEST(Executor, AStepFinishesWithFewerThreadsThanWerePromisedEvenNone)
{
    const std::uint64_t alone = hash_after_steps({.threads = 1});
    for (const int lent : {0, 1, 3}) {
        ThreadExecutor host(5, lent);
        EXPECT_EQ(hash_after_steps({.alone_below = 0, .executor = &host}), alone) << lent;
    }
}

TEST(Executor, StagesRunEachChunkOnceAndOneAfterTheOtherHoweverSlowAThreadIs)
{
    for (const int lent : {0, 1, 4}) {
        ThreadExecutor host(5, lent);
        StageRunner runner(&host);
        std::vector<int> stages_run(200, 0);  // of each chunk; stages touch the same ones, without atomics
        runner.with_workers(false, [&] {
            for (int stage = 0; stage < 500; ++stage) {
                const int count = stage % 200 + 1;
                runner.run(count, [&](std::int64_t i, int worker) {
                    for (int idle = 0; idle < worker; ++idle) std::this_thread::yield();
                    ++stages_run[static_cast<std::size_t>(i)];
                });
            }
        });
        for (int i = 0; i < 200; ++i) {
            int expected = 0;
            for (int stage = 0; stage < 500; ++stage) expected += i < stage % 200 + 1 ? 1 : 0;
            EXPECT_EQ(stages_run[static_cast<std::size_t>(i)], expected)
                << "chunk " << i << ", lent " << lent;
        }
    }
}

TEST(Executor, ThreadedLoopsCoverEveryElementOnce)
{
    ThreadExecutor host(3, 3);
    for (const std::int64_t count : {0, 1, 7, 64, 1000}) {
        std::vector<std::atomic<int>> visits(static_cast<std::size_t>(count));
        parallel_for(host, count, 7, [&](std::int64_t begin, std::int64_t end) {
            for (std::int64_t i = begin; i < end; ++i) ++visits[static_cast<std::size_t>(i)];
        });
        for (const auto& visit : visits) EXPECT_EQ(visit, 1);
    }
}

}  // namespace
}  // namespace motley
