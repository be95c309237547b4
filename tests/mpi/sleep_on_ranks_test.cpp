// People sleep on several ranks as they do in one process: the same people, in the same steps, with the same bits and loads,
// where islands reach over all regions, sleepers move from rank to rank, and hosts wake them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <optional>
#include <string>
#include <unordered_set>
#include <vector>

#include "maths/hash.h"
#include "ranks.h"

namespace motley::testing {
namespace {

constexpr SolverSettings sleeping{.gravity = {0, 0, -9.81F}, .sleep_speed = 0.05F, .sleep_after = 0.3F};

struct Snapshot {
    std::uint64_t people = 0;    ///< the hash of all
    std::uint64_t sleepers = 0;  ///< the sum of the hashes of the numbers of those who sleep
    std::int64_t asleep = 0;
};

/// Of the people of one scene.
Snapshot sleepers_of(const Scene& scene, std::span<const OwnPerson> people)
{
    Snapshot now;
    for (const OwnPerson& person : people) {
        if (!scene.is_asleep(person.body)) continue;
        now.sleepers += mix(0, person.number);
        ++now.asleep;
    }
    return now;
}

/// What the host does to a scene and its people before a step, when they have been steered.
struct Host {
    std::function<void(Scene&, std::span<const OwnPerson>, int step)> acts =
        [](Scene&, std::span<const OwnPerson>, int) {};
    std::function<bool(std::uint64_t number, int step)> removes = [](std::uint64_t, int) { return false; };

    [[nodiscard]] std::vector<std::uint64_t> removed(std::span<const OwnPerson> people, int step) const
    {
        std::vector<std::uint64_t> gone;
        for (const OwnPerson& person : people) {
            if (removes(person.number, step)) gone.push_back(person.number);
        }
        return gone;
    }
};

/// The crowd after every step in one process, computed by rank 0 for all.
std::vector<Snapshot> steps_of_one_process(const Walkers& walkers, int steps, const Host& host)
{
    std::vector<Snapshot> all(static_cast<std::size_t>(steps));
    if (rank() == 0) {
        WalkersOnOneScene one(walkers, sleeping, {});
        for (int step = 1; step <= steps; ++step) {
            for (const std::uint64_t number : host.removed(one.people, step)) one.remove(number);
            walkers.steer(one.scene, one.people);
            host.acts(one.scene, one.people, step);
            const StepReport report = one.solve(dt);
            EXPECT_NE(report.status, StepStatus::refused) << report.error;
            Snapshot& now = all[static_cast<std::size_t>(step - 1)];
            now = sleepers_of(one.scene, one.people);
            now.people = one.hash();
            EXPECT_EQ(report.bodies_asleep, now.asleep);
        }
    }
    MPI_Bcast(all.data(), static_cast<int>(sizeof(Snapshot) * all.size()), MPI_BYTE, 0, MPI_COMM_WORLD);
    return all;
}

struct Seen {
    std::vector<std::int64_t> asleep;  ///< after each step
    std::int64_t moved_asleep = 0;     ///< people who came to a rank and slept
    [[nodiscard]] std::int64_t most_asleep() const { return *std::max_element(asleep.begin(), asleep.end()); }
};

/// Steps the same crowd on all ranks, and compares every step.
Seen expect_the_sleep_of_one_process(const Walkers& walkers, int steps, const SolverOptions& options = {},
                                     const Host& host = {})
{
    const std::vector<Snapshot> expected = steps_of_one_process(walkers, steps, host);
    DistributedCrowd crowd(MPI_COMM_WORLD, sleeping, options);
    add_all(crowd, walkers);
    Seen seen;
    std::unordered_set<std::uint64_t> own;
    for (int step = 1; step <= steps; ++step) {
        crowd.remove_people(host.removed(crowd.people(), step));
        walkers.steer(crowd.scene(), crowd.people());
        host.acts(crowd.scene(), crowd.people(), step);
        const StepReport report = crowd.step(dt);
        EXPECT_NE(report.status, StepStatus::refused) << report.error;
        const Snapshot here = sleepers_of(crowd.scene(), crowd.people());
        const Snapshot& then = expected[static_cast<std::size_t>(step - 1)];
        EXPECT_EQ(report.bodies_asleep, here.asleep);
        seen.asleep.push_back(sum(here.asleep));
        const auto sleepers = static_cast<std::uint64_t>(sum(static_cast<std::int64_t>(here.sleepers)));
        const std::uint64_t hash = crowd.hash();
        EXPECT_EQ(seen.asleep.back(), then.asleep) << "step " << step;
        EXPECT_EQ(sleepers, then.sleepers) << "step " << step;
        EXPECT_EQ(hash, then.people) << "step " << step;
        if (seen.asleep.back() != then.asleep || sleepers != then.sleepers || hash != then.people) break;
        std::unordered_set<std::uint64_t> now;
        for (const OwnPerson& person : crowd.people()) {
            now.insert(person.number);
            if (step > 1 && crowd.scene().is_asleep(person.body) && !own.contains(person.number))
                ++seen.moved_asleep;
        }
        own = std::move(now);
    }
    seen.moved_asleep = sum(seen.moved_asleep);
    return seen;
}

/// Some walk through a crowd that stands, and press it into heaps.
TEST(SleepOnRanks, IsThatOfOneProcessWhereSomeWalk)
{
    const Walkers walkers(
        {.people = 3000, .spacing = 0.47, .friction = 0.3F, .speed = 2, .walks_one_in = 40});
    const Seen seen = expect_the_sleep_of_one_process(walkers, 300);
    EXPECT_GT(seen.most_asleep(), 2000);
    EXPECT_LT(seen.asleep.back(), 2925);  // never all who stand: walkers wake them
}

/// All who walk run into one corner, so that regions are cut anew, and sleepers get to other ranks.
TEST(SleepOnRanks, GoesOnWhenSleepersMoveToOtherRanks)
{
    const Walkers walkers({.people = 3000, .spacing = 0.6, .to_corner = true, .speed = 4, .walks_one_in = 3});
    const Seen seen = expect_the_sleep_of_one_process(walkers, 240, {.threads = 2, .alone_below = 0});
    EXPECT_GT(seen.most_asleep(), 900);
    if (ranks() > 1) {
        EXPECT_GT(seen.moved_asleep, 30);
    }
}

/// An island over all ranks, which each call of a host on one of them wakes: a wake-up, a speed, a push, a person who is
/// put elsewhere, one who is removed, and a wall.
TEST(SleepOnRanks, EndsOnAllRanksWhenAHostWakesOnePerson)
{
    constexpr int people = 1200, first = 180, pause = 120, calls = 6;
    const Walkers walkers({.people = people, .spacing = 0.395, .walks_one_in = 0});
    // Each call comes when all sleep again.
    const auto step_of = [&](int call) { return first + (call - 1) * pause; };
    const auto call_of = [&](int step) {
        return step >= first && (step - first) % pause == 0 ? 1 + (step - first) / pause : 0;
    };
    const Host host{
        .acts =
            [&](Scene& scene, std::span<const OwnPerson> all, int step) {
                const int call = call_of(step);
                if (call == 6) {
                    const std::vector<Vec2<double>> wall{{3, 3}, {3.5, 3}};
                    scene.add_wall({.points = wall});
                }
                for (const OwnPerson& person : all) {
                    if (person.number != static_cast<std::uint64_t>(97 * call + 207)) continue;
                    const BodyState state = scene.state(person.body);
                    if (call == 1) scene.wake(person.body);
                    if (call == 2) scene.set_velocity(person.body, {0.3F, 0, 0}, {});
                    if (call == 3) scene.set_force(person.body, {50, 20, 0}, {});
                    if (call == 4)
                        scene.set_pose(person.body, state.position + Vec3<double>{0.01, 0, 0},
                                       state.orientation, state.yaw);
                }
            },
        .removes = [&](std::uint64_t number, int step) { return call_of(step) == 5 && number == 612; }};
    const Seen seen = expect_the_sleep_of_one_process(walkers, step_of(calls + 1), {}, host);
    for (int call = 1; call <= calls; ++call) {
        const auto before = static_cast<std::size_t>(step_of(call) - 2);
        ASSERT_LT(before + 1, seen.asleep.size());
        EXPECT_EQ(seen.asleep[before], call <= 5 ? people : people - 1) << call;
        EXPECT_LT(seen.asleep[before + 1], people / 5) << call;
    }
}

/// In a crowd of which most sleep, and a few walk, some are thrown at others, who sleep on other ranks too.
TEST(SleepOnRanks, EndsOnAllRanksForWhoIsHit)
{
    const Walkers walkers({.people = 3900, .spacing = 0.445, .speed = 0.5, .walks_one_in = 30});
    const Host host{.acts = [](Scene& scene, std::span<const OwnPerson> all, int step) {
        // After steps in which others fell asleep.
        if (step % 8 != 3) return;
        for (const OwnPerson& person : all) {
            if (person.number % 20 != static_cast<std::uint64_t>(step / 8 % 20)) continue;
            const float x = person.number % 2 == 0 ? 1 : -1, y = person.number % 3 == 0 ? 1 : -1;
            scene.set_velocity(person.body, {x, y, 0}, {});
        }
    }};
    const Seen seen = expect_the_sleep_of_one_process(walkers, 300, {}, host);
    EXPECT_GT(seen.most_asleep(), 2000);
}

/// A door that begins to move wakes those beside it, and with them their islands.
TEST(SleepOnRanks, EndsOnAllRanksForADoorThatMoves)
{
    const Walkers walkers({.people = 2000, .spacing = 0.42, .walks_one_in = 0});
    // This host serves one scene after another: where steps begin anew, the scene is another one, and gets its own door.
    std::optional<Door> door;
    int last_step = 0;
    const Host host{.acts = [&](Scene& scene, std::span<const OwnPerson>, int step) {
        if (step <= last_step || !door) door.emplace(scene, walkers);
        last_step = step;
        if (step > 250 && step < 350) door->move(scene, step);
        if (step == 350) door->stop(scene);
    }};
    const Seen seen = expect_the_sleep_of_one_process(walkers, 500, {}, host);
    ASSERT_EQ(seen.asleep.size(), 500U);
    EXPECT_GT(seen.asleep[249], 1800);
    EXPECT_LT(*std::min_element(seen.asleep.begin() + 250, seen.asleep.begin() + 350), seen.asleep[249] / 2);
}

/// Sleepers who press into a corner bear what they bore, on whatever rank they and their neighbours come to be: when all sleep,
/// others appear beside the hall, so that regions are cut anew.
TEST(SleepOnRanks, KeepsTheLoadsOfSleepers)
{
    Walkers walkers({.people = 1200, .spacing = 0.41, .friction = 0.4F, .to_corner = true});
    for (BodyDefinition& body : walkers.bodies) body.angular_damping = 3;  // or some would spin on
    Walkers others({.people = 1500, .spacing = 0.6});
    for (std::size_t i = 0; i < others.numbers.size(); ++i) {
        others.numbers[i] += walkers.numbers.size();
        others.bodies[i].position.x += walkers.width + 5;
    }
    constexpr int appear_at = 700, steps = 730;
    std::vector<BodyLoad> expected(walkers.numbers.size());
    if (rank() == 0) {
        WalkersOnOneScene one(walkers, sleeping, {});
        for (int step = 1; step <= steps; ++step) {
            if (step == appear_at) {
                std::vector<BodyId> ids(others.bodies.size());
                one.scene.add_bodies(others.bodies, ids);
                one.scene.set_discs(ids, {others.discs.data(), others.discs.size()});
            }
            one.step(dt);
        }
        expected = one.read_loads();
    }
    send_to_all(expected);
    DistributedCrowd crowd(MPI_COMM_WORLD, sleeping);
    add_all(crowd, walkers);
    const auto stand = [&] {
        std::vector<OwnPerson> first;
        for (const OwnPerson& person : crowd.people()) {
            if (person.number < walkers.numbers.size()) first.push_back(person);
        }
        walkers.steer(crowd.scene(), first);
    };
    std::int64_t crossed = 0;
    for (int step = 1; step <= steps; ++step) {
        if (step == appear_at) {
            if (rank() == 0) crowd.add_people(others.numbers, others.bodies, others.discs);
            crossed = sum(crowd.figures().crossings);
        }
        stand();
        ASSERT_EQ(crowd.step(dt).status, StepStatus::done);
    }
    const std::vector<BodyLoad> loads = crowd.read_loads();
    std::int64_t bearing_asleep = 0;
    for (std::size_t i = 0; i < loads.size(); ++i) {
        const OwnPerson& person = crowd.people()[i];
        if (person.number >= expected.size()) continue;
        const BodyLoad& load = expected[person.number];
        expect_same(loads[i], load);
        if (crowd.scene().is_asleep(person.body) && load.normal_force > 0) ++bearing_asleep;
    }
    EXPECT_GT(sum(bearing_asleep), 1000);
    if (ranks() > 1) {
        EXPECT_GT(sum(crowd.figures().crossings), crossed + 1500);
    }
}

/// A force on a sleeper wakes the island, and drives the sleeper beyond the range of floats, to be contained.
TEST(SleepOnRanks, EndsOnAllRanksWhenSomebodyIsContained)
{
    Walkers walkers({.people = 1200, .spacing = 0.395, .walks_one_in = 0});
    constexpr std::uint64_t lightest = 612;
    walkers.bodies[lightest].mass = 1e-3F;
    walkers.bodies[lightest].inertia.zz = 1e-5F;
    constexpr int pushed_at = 180;
    const Host host{.acts = [](Scene& scene, std::span<const OwnPerson> all, int step) {
        for (const OwnPerson& person : all) {
            if (person.number == lightest && step == pushed_at)
                scene.set_force(person.body, {3e38F, 0, 0}, {});
        }
    }};
    const Seen seen = expect_the_sleep_of_one_process(walkers, 300, {}, host);
    ASSERT_EQ(seen.asleep.size(), 300U);
    EXPECT_EQ(seen.asleep[pushed_at - 2], 1200);
    EXPECT_LT(seen.asleep[pushed_at], 600);
}

/// Hosts do at random what they may do to people and walls; MOTLEY_FUZZ_ROUNDS in the environment does more of it.
TEST(SleepOnRanks, IsThatOfOneProcessWhateverHostsDo)
{
    const char* const asked = std::getenv("MOTLEY_FUZZ_ROUNDS");
    const auto rounds = static_cast<std::uint64_t>(asked == nullptr ? 4 : std::max(1, std::atoi(asked)));
    for (std::uint64_t round = 1; round <= rounds; ++round) {
        SCOPED_TRACE(round);
        // A number of 0 to `below` - 1 that any rank finds for itself.
        const auto random = [round](std::uint64_t what, std::uint64_t of, std::uint64_t below) {
            return mix(mix(round, what), of) / 64 % below;
        };
        const Walkers walkers({.people = static_cast<int>(600 + random(1, 0, 1400)),
                               .spacing = 0.39 + 0.005 * static_cast<double>(random(2, 0, 20)),
                               .friction = random(3, 0, 2) == 0 ? 0.3F : 0.0F,
                               .to_corner = random(4, 0, 3) == 0,
                               .speed = 1 + static_cast<float>(random(5, 0, 3)),
                               .walks_one_in = static_cast<int>(random(6, 0, 5) * 20)});
        const auto happens = [&](std::uint64_t number, int step, std::uint64_t kind, std::uint64_t one_in) {
            return random(100 * static_cast<std::uint64_t>(step) + kind, number, one_in) == 0;
        };
        // Busy times and quiet ones take turns.
        const auto is_busy = [](int step) { return step / 40 % 2 == 1; };
        const Host host{
            .acts =
                [&](Scene& scene, std::span<const OwnPerson> all, int step) {
                    if (!is_busy(step)) return;
                    if (happens(0, step, 10, 30)) {
                        const double x = walkers.width / 8 *
                                         static_cast<double>(random(11, static_cast<std::uint64_t>(step), 8));
                        const std::vector<Vec2<double>> wall{{x, 0.3 * walkers.height},
                                                             {x, 0.4 * walkers.height}};
                        scene.add_wall({.points = wall});
                    }
                    for (const OwnPerson& person : all) {
                        const BodyState state = scene.state(person.body);
                        if (happens(person.number, step, 20, 4000)) scene.wake(person.body);
                        if (happens(person.number, step, 21, 2000))
                            scene.set_velocity(person.body, {2, 1, 0}, {0, 0, 1});
                        if (happens(person.number, step, 22, 2000))
                            scene.set_force(person.body, {300, -200, 0}, {});
                        if (happens(person.number, step, 23, 4000))
                            scene.set_pose(person.body, state.position + Vec3<double>{0.03, 0.3, 0},
                                           state.orientation, state.yaw);
                        if (happens(person.number, step, 24, 8000))
                            scene.set_disc(person.body, {.radius = 0.23F, .friction = 0.2F});
                    }
                },
            .removes = [&](std::uint64_t number,
                           int step) { return is_busy(step) && happens(number, step, 25, 8000); }};
        expect_the_sleep_of_one_process(
            walkers, 320, {.threads = 1 + static_cast<int>(random(7, 0, 2)), .alone_below = 0}, host);
        if (::testing::Test::HasFailure()) return;
    }
}

/// A run goes on from a checkpoint in which most sleep, on fewer ranks too, and with the same sleepers.
TEST(SleepOnRanks, IsInCheckpoints)
{
    const Walkers walkers(
        {.people = 2500, .spacing = 0.45, .friction = 0.3F, .speed = 2, .walks_one_in = 60});
    constexpr int saved_at = 150, steps = 300;
    const std::string path =
        ::testing::TempDir() + "motley_sleepers_of_" + std::to_string(ranks()) + "_ranks";
    // Some who sleep are given a speed, and some a wake-up, before the checkpoint is written.
    const auto rouse = [&](DistributedCrowd& crowd) {
        for (const OwnPerson& person : crowd.people()) {
            if (person.number % 50 == 1) crowd.scene().set_velocity(person.body, {0.5F, 0, 0}, {});
            if (person.number % 50 == 2) crowd.scene().wake(person.body);
        }
    };
    const auto go_on = [&](DistributedCrowd& crowd, int from) {
        std::int64_t asleep = 0;
        for (int step = from; step <= steps; ++step) {
            walkers.steer(crowd.scene(), crowd.people());
            const StepReport report = crowd.step(dt);
            EXPECT_EQ(report.status, StepStatus::done);
            asleep = report.bodies_asleep;
            if (step == saved_at && from <= saved_at) {
                rouse(crowd);
                crowd.save(path);
            }
        }
        return asleep;
    };
    std::uint64_t hash = 0;
    std::int64_t asleep = 0;
    {
        DistributedCrowd crowd(MPI_COMM_WORLD, sleeping);
        add_all(crowd, walkers);
        asleep = sum(go_on(crowd, 1));
        hash = crowd.hash();
    }
    EXPECT_GT(asleep, 500);
    for (const int fewer : {ranks(), 1, 2, 5}) {
        if (fewer > ranks()) continue;
        MPI_Comm some = MPI_COMM_NULL;
        MPI_Comm_split(MPI_COMM_WORLD, rank() < fewer ? 0 : MPI_UNDEFINED, rank(), &some);
        std::int64_t asleep_now = 0;
        if (some != MPI_COMM_NULL) {
            {
                DistributedCrowd crowd(some, sleeping);
                walkers.add_walls(crowd.scene());
                crowd.load(path);
                asleep_now = go_on(crowd, saved_at + 1);
                EXPECT_EQ(crowd.hash(), hash) << "on " << fewer << " ranks";
            }
            MPI_Comm_free(&some);
        }
        EXPECT_EQ(sum(asleep_now), asleep) << "on " << fewer << " ranks";
    }
    MPI_Barrier(MPI_COMM_WORLD);
    if (rank() == 0) std::remove(path.c_str());
}

}  // namespace
}  // namespace motley::testing
