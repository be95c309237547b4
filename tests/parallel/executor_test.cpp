// A host's own threads: whatever an executor does, a step finishes, and with the same bits.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <future>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>

#include "mixed_scene.h"
#include "stage_runner.h"
#include "thread_executor.h"

namespace motley {
namespace {

using testing::ThreadExecutor;

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
        std::vector<int> stages_run(200, 0);  // of each chunk; written without atomics by every stage
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

TEST(Executor, AJobIsTwoWordsThatAPoolMayCopy)
{
    static_assert(std::is_trivially_copyable_v<Job> && sizeof(Job) == 2 * sizeof(void*));
    std::atomic<int> sum{0};
    const auto work = [&](int worker) { sum += worker; };
    const Job job = work;
    const Job copy = job;
    std::thread other([copy] { copy(3); });
    job(4);
    other.join();
    EXPECT_EQ(sum, 7);
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

TEST(Executor, IsLeftAloneByWhatOneThreadDoes)
{
    ThreadExecutor host(2, 1);
    SolverSettings settings;
    settings.method = Method::direct;
    testing::MixedScene mixed(3);
    Solver solver(settings, {.alone_below = 0, .executor = &host});
    EXPECT_EQ(solver.step(mixed.scene, 1.0F / 60, mixed.contacts()).status, StepStatus::done);
    EXPECT_EQ(host.runs, 0);
}

/// Makes the mistakes that a host's thread pool may make.
class FaultyExecutor final : public Executor {
  public:
    enum class Fault {
        none,
        throws_before,
        throws_after,
        throws_an_int,
        calls_nobody,
        calls_twice,
        calls_strangers
    };
    Fault fault = Fault::none;
    int said = 2;
    [[nodiscard]] int concurrency() const override { return said; }
    void run(int, Job job) override
    {
        if (fault == Fault::throws_before) throw std::runtime_error("the pool is closed");
        if (fault == Fault::throws_an_int) throw 7;
        if (fault == Fault::calls_nobody) return;
        if (fault == Fault::calls_strangers) {
            job(-1);
            job(2);
        }
        job(0);
        if (fault == Fault::calls_twice) job(0);
        if (fault == Fault::throws_after) throw std::runtime_error("the pool is closing");
    }
};

TEST(Executor, OfAConcurrencyThatIsNoneIsRefused)
{
    for (const int said : {0, -1, 1025, 1000000}) {
        FaultyExecutor host;
        host.said = said;
        try {
            Solver solver(SolverSettings{}, {.executor = &host});
            FAIL() << said;
        } catch (const InvalidInput& refusal) {
            EXPECT_EQ(std::string(refusal.what()), "SolverOptions.executor.concurrency() is " +
                                                       std::to_string(said) + "; expected 1 to 1024");
        }
    }
}

TEST(Executor, ThatFailsGivesAReportThatIsTrueOfTheScene)
{
    using Fault = FaultyExecutor::Fault;
    struct Case {
        Fault fault;
        StepStatus status;
        const char* error;
    };
    const Case cases[] = {
        {Fault::throws_before, StepStatus::refused, "the pool is closed"},
        {Fault::throws_an_int, StepStatus::refused, "unknown throw"},
        {Fault::calls_nobody, StepStatus::refused, "Executor.run returned without calling job(0)"},
        {Fault::calls_twice, StepStatus::done, ""},
        {Fault::calls_strangers, StepStatus::done, ""},
        {Fault::throws_after, StepStatus::done, "the pool is closing"}};
    for (const Case& faulty : cases) {
        testing::MixedScene mixed, good;
        FaultyExecutor host;
        Solver solver({.gravity = {0, -9.81F, 0}}, {.alone_below = 0, .executor = &host}),
            other({.gravity = {0, -9.81F, 0}});
        const std::uint64_t before = mixed.scene.state_hash();
        host.fault = faulty.fault;
        const StepReport report = solver.step(mixed.scene, 1.0F / 60, mixed.contacts());
        EXPECT_EQ(report.status, faulty.status) << faulty.error;
        EXPECT_EQ(report.error, faulty.error);
        if (report.status == StepStatus::refused) {
            EXPECT_EQ(mixed.scene.state_hash(), before) << faulty.error;
            host.fault = Fault::none;
            EXPECT_EQ(solver.step(mixed.scene, 1.0F / 60, mixed.contacts()).status, StepStatus::done);
        }
        other.step(good.scene, 1.0F / 60, good.contacts());
        EXPECT_EQ(mixed.scene.state_hash(), good.scene.state_hash()) << "as often as it is said to be done";
    }
}

TEST(Executor, AChunkThatThrowsEndsItsStageAndTheNextOneRuns)
{
    for (const int lent : {0, 1, 3}) {
        ThreadExecutor host(4, lent);
        StageRunner runner(&host);
        for (const int bad : {0, 57, 99}) {
            const auto step = [&](bool throws) {
                std::atomic<int> ran{0};
                runner.with_workers(false, [&] {
                    for (int stage = 0; stage < 3; ++stage) {
                        runner.run(100, [&](std::int64_t i) {
                            if (throws && stage == 1 && i == bad) throw std::length_error("chunk");
                            ++ran;
                        });
                    }
                });
                return ran.load();
            };
            EXPECT_THROW(step(true), std::length_error) << lent;
            EXPECT_EQ(step(false), 300) << lent;
        }
    }
}

TEST(Executor, AChunkThatThrowsOnAnyWorkerEndsItsStageAndTheNextOneRuns)
{
    constexpr int workers = 4;
    ThreadExecutor host(workers, workers - 1);
    StageRunner runner(&host);
    for (int bad = 0; bad < workers; ++bad) {
        std::atomic<bool> thrown{false};
        std::atomic<int> ran{0};
        runner.with_workers(false, [&] {
            EXPECT_THROW(runner.run(400,
                                    [&](std::int64_t, int worker) {
                                        // The others wait for the bad one, so that it does run a chunk.
                                        while (worker != bad && !thrown) std::this_thread::yield();
                                        if (worker != bad) return;
                                        thrown = true;
                                        throw std::length_error("chunk");
                                    }),
                         std::length_error)
                << bad;
            runner.run(400, [&](std::int64_t) { ++ran; });
        });
        EXPECT_TRUE(thrown);
        EXPECT_EQ(ran, 400) << bad;
    }
}

/// A pool of which one thread fails, before or after its job. Its run throws that once all threads have returned.
class FailingPool final : public Executor {
  public:
    FailingPool(int bad, bool before) : bad_(bad), before_(before) {}
    [[nodiscard]] int concurrency() const override { return 4; }
    void run(int workers, Job job) override
    {
        std::exception_ptr failure;  // of one thread only
        const auto call = [&](int worker) {
            if (worker != bad_) return job(worker);
            try {
                if (before_) throw std::runtime_error("thread " + std::to_string(worker));
                job(worker);
                throw std::runtime_error("thread " + std::to_string(worker));
            } catch (...) {
                failure = std::current_exception();
            }
        };
        std::vector<std::thread> threads;
        for (int worker = 1; worker < workers; ++worker) threads.emplace_back(call, worker);
        call(0);
        for (std::thread& thread : threads) thread.join();
        if (failure) std::rethrow_exception(failure);
    }

  private:
    int bad_;
    bool before_;
};

TEST(Executor, WhoseThreadFailsBeforeOrAfterItsJobStillDoesTheStep)
{
    testing::MixedScene alone;
    Solver one({.gravity = {0, -9.81F, 0}}, {.threads = 1});
    for (int step = 0; step < 5; ++step) one.step(alone.scene, 1.0F / 60, alone.contacts());
    // Thread 0 is the caller. If it fails before its job the step is refused: see throws_before above.
    for (const auto& [bad, before] :
         {std::pair{1, true}, {2, true}, {3, true}, {0, false}, {1, false}, {3, false}}) {
        testing::MixedScene mixed;
        FailingPool pool(bad, before);
        Solver solver({.gravity = {0, -9.81F, 0}}, {.alone_below = 0, .executor = &pool});
        for (int step = 0; step < 5; ++step) {
            const StepReport report = solver.step(mixed.scene, 1.0F / 60, mixed.contacts());
            EXPECT_EQ(report.status, StepStatus::done);
            EXPECT_EQ(report.error, "thread " + std::to_string(bad));
        }
        EXPECT_EQ(mixed.scene.state_hash(), alone.scene.state_hash()) << bad << before;
    }
}

/// A pool that fails when its first thread runs already and the caller's job has not begun, and joins its threads while
/// the exception leaves.
class UnwindingPool final : public Executor {
  public:
    [[nodiscard]] int concurrency() const override { return 3; }
    void run(int, Job job) override
    {
        struct Joined {
            std::thread thread;
            ~Joined() { thread.join(); }
        };
        std::promise<void> begun;
        const Joined worker{std::thread([&] {
            begun.set_value();
            job(1);
        })};
        begun.get_future().wait();
        throw std::runtime_error("no more threads");
    }
};

TEST(Executor, ThatFailsBeforeTheCallersJobAndJoinsWhileUnwindingIsRefusedInsteadOfWaitedForForever)
{
    struct Refused {
        testing::MixedScene mixed;
        UnwindingPool pool;
        Solver solver{{.gravity = {0, -9.81F, 0}}, {.alone_below = 0, .executor = &pool}};
        std::promise<StepReport> report;
    };
    // A step that waits forever keeps its thread and what that uses, so that this test can end and tell.
    const auto step = std::make_shared<Refused>();
    const std::uint64_t before = step->mixed.scene.state_hash();
    std::future<StepReport> report = step->report.get_future();
    std::thread([step] {
        step->report.set_value(step->solver.step(step->mixed.scene, 1.0F / 60, step->mixed.contacts()));
    }).detach();
    ASSERT_EQ(report.wait_for(std::chrono::seconds(20)), std::future_status::ready);
    const StepReport told = report.get();
    EXPECT_EQ(told.status, StepStatus::refused);
    EXPECT_EQ(told.error, "no more threads");
    EXPECT_EQ(step->mixed.scene.state_hash(), before);
}

/// A pool whose caller is late: its other threads have begun long before.
class LateCaller final : public Executor {
  public:
    [[nodiscard]] int concurrency() const override { return 2; }
    void run(int, Job job) override
    {
        std::thread other([job] { job(1); });
        std::this_thread::sleep_for(std::chrono::milliseconds(300));
        job(0);
        other.join();
    }
};

TEST(Executor, WhoseCallerIsLateStillDoesTheStepWithTheSameBits)
{
    testing::MixedScene alone, mixed;
    Solver one({.gravity = {0, -9.81F, 0}}, {.threads = 1});
    LateCaller late;
    Solver solver({.gravity = {0, -9.81F, 0}}, {.alone_below = 0, .executor = &late});
    one.step(alone.scene, 1.0F / 60, alone.contacts());
    EXPECT_EQ(solver.step(mixed.scene, 1.0F / 60, mixed.contacts()).status, StepStatus::done);
    EXPECT_EQ(mixed.scene.state_hash(), alone.scene.state_hash());
}

TEST(Executor, ALoopThatThrowsIsThrownToItsCaller)
{
    for (const int lent : {0, 3}) {
        ThreadExecutor host(4, lent);
        for (const std::int64_t bad : {0, 50, 99}) {
            EXPECT_THROW(parallel_for(host, 100, 1,
                                      [&](std::int64_t begin, std::int64_t) {
                                          if (begin == bad) throw std::length_error("chunk");
                                      }),
                         std::length_error);
        }
    }
}

/// An executor that starts another step while it runs one.
class NestingExecutor final : public Executor {
  public:
    std::function<StepReport()> step;
    StepReport nested;
    [[nodiscard]] int concurrency() const override { return 2; }
    void run(int, Job job) override
    {
        nested = step();
        job(0);
    }
};

TEST(Executor, AStepOfASceneOrByASolverThatIsInOneIsRefused)
{
    testing::MixedScene mixed, good;
    Scene elsewhere;
    NestingExecutor host;
    Solver solver(SolverSettings{}, {.alone_below = 0, .executor = &host}), other;
    host.step = [&] { return other.step(mixed.scene, 1.0F / 60); };
    EXPECT_EQ(solver.step(mixed.scene, 1.0F / 60, mixed.contacts()).status, StepStatus::done);
    EXPECT_EQ(host.nested.status, StepStatus::refused);
    EXPECT_EQ(host.nested.error, "step.scene is in another step; expected one step at a time");
    host.step = [&] { return solver.step(elsewhere, 1.0F / 60); };
    EXPECT_EQ(solver.step(mixed.scene, 1.0F / 60, mixed.contacts()).status, StepStatus::done);
    EXPECT_EQ(host.nested.status, StepStatus::refused);
    EXPECT_EQ(host.nested.error, "step is called while the solver is in a step; expected one step at a time");
    for (int step = 0; step < 2; ++step) other.step(good.scene, 1.0F / 60, good.contacts());
    EXPECT_EQ(mixed.scene.state_hash(), good.scene.state_hash());
}

TEST(Threads, MayWriteAndReadDifferentBodiesOfASceneBesideEachOther)
{
    Scene scene, alone;
    const std::vector<BodyDefinition> definitions(400);
    std::vector<BodyId> bodies(400), same(400);
    scene.add_bodies(definitions, bodies);
    alone.add_bodies(definitions, same);
    std::vector<Vec3<float>> forces(400), speeds(400);
    for (std::size_t i = 0; i < forces.size(); ++i) forces[i] = speeds[i] = {static_cast<float>(i), 1, 0};
    ThreadExecutor host(4, 3);
    for (int round = 0; round < 20; ++round) {
        parallel_for(host, 400, 10, [&](std::int64_t begin, std::int64_t end) {
            const auto first = static_cast<std::size_t>(begin), count = static_cast<std::size_t>(end - begin);
            const std::span<const BodyId> own = std::span(bodies).subspan(first, count);
            std::vector<Vec3<double>> positions(count);
            scene.set_velocities(own, std::span(speeds).subspan(first, count));
            scene.read_positions(own, positions);
            scene.set_forces(own, std::span(forces).subspan(first, count));
            static_cast<void>(scene.state(own[0]));
        });
    }
    alone.set_velocities(same, speeds);
    alone.set_forces(same, forces);
    Solver solver;
    solver.step(scene, 1.0F / 60);
    solver.step(alone, 1.0F / 60);
    EXPECT_EQ(scene.state_hash(), alone.state_hash());
}

}  // namespace
}  // namespace motley
