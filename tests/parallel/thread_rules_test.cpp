// The rules on threads that Scene, Solver and Executor state. Independent evidence: the same calls one after the other,
// and the thread sanitizer, under which .ci/run runs these tests.
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cfenv>
#include <memory>
#include <thread>
#include <vector>

#include "disc_crowd.h"
#include "mixed_scene.h"

namespace motley {
namespace {

constexpr float dt = 1.0F / 60;
constexpr int steps = 30;

SolverSettings falling()
{
    SolverSettings settings;
    settings.gravity = {0, -9.81F, 0};
    return settings;
}

/// Starts a thread for every worker but the caller, each time anew: it may run for several steps at once.
class ThreadExecutor final : public Executor {
  public:
    [[nodiscard]] int concurrency() const override { return 3; }
    void run(int workers, Job job) override
    {
        std::vector<std::thread> threads;
        for (int worker = 1; worker < workers; ++worker) threads.emplace_back([job, worker] { job(worker); });
        job(0);
        for (std::thread& thread : threads) thread.join();
    }
};

/// Runs work(0) ... work(count - 1) each on a thread of its own.
template <class Work>
void at_once(int count, const Work& work)
{
    std::vector<std::thread> threads;
    for (int i = 0; i < count; ++i) threads.emplace_back([&work, i] { work(i); });
    for (std::thread& thread : threads) thread.join();
}

/// A number that changes with nearly everything that const calls say of a scene.
std::uint64_t read_everything(const testing::MixedScene& mixed, std::span<const Contact> contacts)
{
    const Scene& scene = mixed.scene;
    std::vector<BodyId> bodies;
    scene.read_bodies(bodies);
    std::vector<Vec3<double>> positions(bodies.size());
    std::vector<Vec3<float>> speeds(bodies.size());
    std::vector<Quat<double>> orientations(bodies.size());
    std::vector<double> yaws(bodies.size());
    std::vector<JointReport> reports(mixed.joints.size());
    std::vector<BodyLoad> loads(bodies.size());
    scene.read_positions(bodies, positions);
    scene.read_velocities(bodies, speeds);
    scene.read_orientations(bodies, orientations);
    scene.read_yaws(bodies, yaws);
    scene.read_joint_reports(mixed.joints, reports);
    scene.read_loads(bodies, contacts, loads);
    double sum = scene.errors().kinetic_energy + static_cast<double>(scene.last_step());
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        sum += positions[i].x + static_cast<double>(speeds[i].y) + orientations[i].z + yaws[i] +
               static_cast<double>(loads[i].normal_force) + scene.state(bodies[i]).position.y +
               static_cast<double>(scene.user_data(bodies[i]));
    }
    for (const JointReport& report : reports) sum += static_cast<double>(report.force.x);
    for (const ContactImpulse& impulse : scene.contact_impulses()) sum += static_cast<double>(impulse.normal);
    const Scene copy = scene;
    const Scene read_back = load_scene(save_scene(scene));
    EXPECT_EQ(copy.state_hash(), read_back.state_hash());
    return copy.state_hash() ^ static_cast<std::uint64_t>(1e6 * sum);
}

TEST(ThreadRules, ConstCallsOfASceneMayRunBesideEachOther)
{
    testing::MixedScene mixed;
    Solver solver(falling());
    std::vector<Contact> contacts;
    for (int step = 0; step < steps; ++step) {
        contacts = mixed.contacts();
        solver.step(mixed.scene, dt, contacts);
    }
    const std::uint64_t expected = read_everything(mixed, contacts);
    std::array<std::uint64_t, 4> read{};
    at_once(4, [&](int i) {
        for (int round = 0; round < 10; ++round)
            read[static_cast<std::size_t>(i)] = read_everything(mixed, contacts);
    });
    for (const std::uint64_t each : read) EXPECT_EQ(each, expected);
}

std::uint64_t hash_after_steps(Executor* executor)
{
    testing::MixedScene mixed;
    Solver solver(falling(), {.alone_below = 0, .executor = executor});
    for (int step = 0; step < steps; ++step)
        EXPECT_EQ(solver.step(mixed.scene, dt, mixed.contacts()).status, StepStatus::done);
    return mixed.scene.state_hash();
}

TEST(ThreadRules, OneExecutorMayServeTwoSolversInTurnAndAtOnce)
{
    const std::uint64_t expected = hash_after_steps(nullptr);
    Solver owner(SolverSettings{}, {.threads = 3});
    ThreadExecutor host;
    for (Executor* executor : {&owner.executor(), static_cast<Executor*>(&host)}) {
        EXPECT_EQ(hash_after_steps(executor), expected);
        std::array<std::uint64_t, 2> hashes{};
        at_once(2, [&](int i) { hashes[static_cast<std::size_t>(i)] = hash_after_steps(executor); });
        EXPECT_EQ(hashes[0], expected);
        EXPECT_EQ(hashes[1], expected);
    }
}

TEST(ThreadRules, AThreadThatAnExecutorHasLentMayStepAnotherSceneOnIt)
{
    const std::uint64_t expected = hash_after_steps(nullptr);
    Solver owner(SolverSettings{}, {.threads = 3});
    ThreadExecutor host;
    for (Executor* executor : {&owner.executor(), static_cast<Executor*>(&host)}) {
        std::array<std::uint64_t, 4> hashes{};
        parallel_for(*executor, 4, 1, [&](std::int64_t i, std::int64_t) {
            hashes[static_cast<std::size_t>(i)] = hash_after_steps(executor);
        });
        for (const std::uint64_t hash : hashes) EXPECT_EQ(hash, expected);
    }
}

TEST(ThreadRules, OneListOfContactsMayServeTwoStepsAtOnce)
{
    testing::MixedScene mixed;
    const std::vector<Contact> contacts = mixed.contacts();
    std::array<Scene, 2> scenes{mixed.scene, mixed.scene};
    at_once(2, [&](int i) {
        Solver solver(falling(), {.threads = 2, .alone_below = 0});
        EXPECT_EQ(solver.step(scenes[static_cast<std::size_t>(i)], dt, contacts).status, StepStatus::done);
    });
    Solver(falling()).step(mixed.scene, dt, contacts);
    for (const Scene& scene : scenes) EXPECT_EQ(scene.state_hash(), mixed.scene.state_hash());
}

TEST(ThreadRules, SettingsOfASolverMayBeReadDuringItsStep)
{
    testing::MixedScene mixed;
    Solver solver(falling(), {.threads = 2, .alone_below = 0});
    const int threads = solver.threads();  // 1 where the library has no threads of its own
    std::atomic<bool> done{false};
    std::thread reader([&] {
        while (!done) {
            EXPECT_EQ(solver.settings().substeps, 4);
            EXPECT_EQ(solver.threads(), threads);
            EXPECT_EQ(solver.executor().concurrency(), threads);
            std::this_thread::yield();
        }
    });
    for (int step = 0; step < steps; ++step) solver.step(mixed.scene, dt, mixed.contacts());
    done = true;
    reader.join();
}

/// Lends one thread that rounds downwards, and one more that comes when the step is done.
class RoundingExecutor final : public Executor {
  public:
    std::atomic<int> roundings_kept{0};
    int latecomers = 0;
    [[nodiscard]] int concurrency() const override { return 3; }
    void run(int, Job job) override
    {
        std::thread lent([&, job] {
            std::fesetround(FE_DOWNWARD);
            job(1);
            roundings_kept += std::fegetround() == FE_DOWNWARD ? 1 : 0;
        });
        job(0);
        std::thread late([job] { job(2); });
        late.join();
        lent.join();
        ++latecomers;
    }
};

TEST(ThreadRules, ALentThreadFindsItsFloatsAgainAndALateOneLeavesAtOnce)
{
    const std::uint64_t expected = hash_after_steps(nullptr);
    RoundingExecutor host;
    EXPECT_EQ(hash_after_steps(&host), expected);
    EXPECT_EQ(host.roundings_kept, steps);
    EXPECT_EQ(host.latecomers, steps);
}

/// What was built answers for its own moment, and reads nothing of the scene.
TEST(ThreadRules, IndicesAnswerOnSeveralThreadsWhileTheSceneIsStepped)
{
    testing::DiscCrowd crowd({.people = 1000, .speed = 2});
    CrowdIndex people;
    WallIndex walls;
    people.build(crowd.scene);
    walls.build(crowd.scene);
    std::vector<BodyId> expected;
    people.discs_within({5, 5}, 3, expected);
    Solver solver;
    at_once(4, [&](int thread) {
        if (thread == 0) {
            for (int i = 0; i < 5; ++i) solver.step(crowd.scene, dt);
            return;
        }
        std::vector<BodyId> found;
        for (int i = 0; i < 50; ++i) {
            people.discs_within({5, 5}, 3, found);
            ASSERT_EQ(found, expected);
            ASSERT_FALSE(walls.is_free({5, 5}, {100, 5}));
        }
    });
}

}  // namespace
}  // namespace motley
