// A crowd on several ranks has the bits of the same crowd in one process. The program is run by mpirun with 1, 2, 3, 4 and
// 7 ranks; each test runs on all of them.
#include "motley/mpi/distributed_crowd.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <optional>
#include <thread>

#include "maths/hash.h"
#include "ranks.h"

namespace motley::testing {
namespace {

/// The hash after every `every` steps in one process, computed by rank 0 for all.
template <class Change>
std::vector<std::uint64_t> hashes_of_one_process(const Walkers& walkers, const SolverSettings& settings,
                                                 int steps, int every, const Change& change)
{
    std::vector<std::uint64_t> hashes(static_cast<std::size_t>(steps / every), 0);
    if (rank() == 0) {
        WalkersOnOneScene one(walkers, settings, {});
        for (int step = 1; step <= steps; ++step) {
            change(one, step);
            const StepReport report = one.step(dt);
            EXPECT_EQ(report.status, StepStatus::done) << report.error;
            if (step % every == 0) hashes[static_cast<std::size_t>(step / every - 1)] = one.hash();
        }
    }
    MPI_Bcast(hashes.data(), static_cast<int>(hashes.size()), MPI_UINT64_T, 0, MPI_COMM_WORLD);
    return hashes;
}

/// Steps the crowd, after change(step) each time, and compares it after every `every` steps.
template <class Change>
void expect_hashes(DistributedCrowd& crowd, const Walkers& walkers, std::span<const std::uint64_t> expected,
                   int every, const Change& change)
{
    const int steps = static_cast<int>(expected.size()) * every;
    for (int step = 1; step <= steps; ++step) {
        change(step);
        walkers.steer(crowd.scene(), crowd.people());
        const StepReport report = crowd.step(dt);
        ASSERT_EQ(report.status, StepStatus::done) << report.error;
        if (step % every == 0) {
            ASSERT_EQ(crowd.hash(), expected[static_cast<std::size_t>(step / every - 1)]) << "step " << step;
        }
    }
}

struct Case {
    WalkersOptions walkers{};
    SolverSettings settings{};
    SolverOptions options{};
    int steps = 240;
};

void expect_the_bits_of_one_process(const Case& c)
{
    const Walkers walkers(c.walkers);
    constexpr int every = 10;
    const std::vector<std::uint64_t> expected =
        hashes_of_one_process(walkers, c.settings, c.steps, every, [](WalkersOnOneScene&, int) {});
    DistributedCrowd crowd(MPI_COMM_WORLD, c.settings, c.options);
    add_all(crowd, walkers);
    expect_hashes(crowd, walkers, expected, every, [](int) {});
    const DistributedFigures figures = crowd.figures();
    EXPECT_EQ(sum(figures.people), c.walkers.people);
    if (ranks() > 1 && c.walkers.people > 1000) {
        EXPECT_GT(sum(figures.crossings), c.walkers.people / 2);
        EXPECT_GT(sum(figures.pushed), 0);
    }
}

TEST(DistributedCrowd, HasTheBitsOfOneProcess)
{
    expect_the_bits_of_one_process({});
}

TEST(DistributedCrowd, HasThemWithFrictionAndTwoThreads)
{
    expect_the_bits_of_one_process({{.people = 4000, .spacing = 0.45, .friction = 0.4F},
                                    {.gravity = {}},
                                    {.threads = 2, .alone_below = 0}});
}

TEST(DistributedCrowd, HasThemUnderEveryInstructionSet)
{
    for (const Isa isa : available_isas())
        expect_the_bits_of_one_process({.walkers = {.people = 1500}, .options = {.isa = isa}, .steps = 60});
}

TEST(DistributedCrowd, HasThemUnderEveryMethod)
{
    for (const SolverSettings& settings :
         {SolverSettings{.substeps = 1}, SolverSettings{.substeps = 2, .iterations = 3, .relaxations = 2},
          SolverSettings{.method = Method::sequential_impulse}})
        expect_the_bits_of_one_process({.walkers = {.people = 2000}, .settings = settings, .steps = 60});
}

TEST(DistributedCrowd, HasThemWithFewerPeopleThanARegionHolds)
{
    for (const int people : {0, 1, 5, 600})
        expect_the_bits_of_one_process({.walkers = {.people = people, .speed = 3}, .steps = 60});
}

/// A rank that is late makes the others wait, and nothing else.
TEST(DistributedCrowd, HasThemWhenRanksAreLateInTurn)
{
    const Walkers walkers({.people = 2500});
    constexpr int steps = 60;
    const std::vector<std::uint64_t> expected =
        hashes_of_one_process(walkers, {}, steps, steps, [](WalkersOnOneScene&, int) {});
    DistributedCrowd crowd(MPI_COMM_WORLD);
    add_all(crowd, walkers);
    for (int step = 0; step < steps; ++step) {
        walkers.steer(crowd.scene(), crowd.people());
        if (step % ranks() == rank()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
        ASSERT_EQ(crowd.step(dt).status, StepStatus::done);
    }
    EXPECT_EQ(crowd.hash(), expected[0]);
}

/// All press into one corner: the worst rank stays within a fifth of the mean.
TEST(DistributedCrowd, KeepsItsBalanceInAStampede)
{
    const WalkersOptions options{.people = 24000, .to_corner = true, .speed = 3};
    expect_the_bits_of_one_process({.walkers = options, .steps = 60});
    const Walkers walkers(options);
    DistributedCrowd crowd(MPI_COMM_WORLD);
    add_all(crowd, walkers);
    double worst = 0;
    for (int step = 1; step <= 240; ++step) {
        walkers.steer(crowd.scene(), crowd.people());
        ASSERT_EQ(crowd.step(dt).status, StepStatus::done);
        std::int64_t most = crowd.figures().people;
        MPI_Allreduce(MPI_IN_PLACE, &most, 1, MPI_INT64_T, MPI_MAX, MPI_COMM_WORLD);
        worst = std::max(worst, static_cast<double>(most) * ranks() / options.people);
    }
    // A region is whole bands of some hundred people, who cannot be shared out more evenly.
    if (ranks() <= 4) {
        EXPECT_LT(worst, 1.2);
    }
    RecordProperty("worst_over_mean", std::to_string(worst));
    if (rank() == 0) std::printf("worst rank over mean: %.3f\n", worst);
}

/// People leave and enter, are thrown about and stopped, on whatever rank they are.
TEST(DistributedCrowd, HasThemWhenPeopleComeAndGo)
{
    const Walkers walkers({.people = 2500, .spacing = 0.55, .friction = 0.2F});
    constexpr int steps = 120, every = 10;
    const auto leaves = [](std::uint64_t number, int step) {
        return step % 7 == 0 && number % 97 == static_cast<std::uint64_t>(step % 97);
    };
    const auto is_thrown = [](std::uint64_t number, int step) {
        return step % 11 == 0 && number % 53 == static_cast<std::uint64_t>(step % 53);
    };
    const auto change = [&](auto& scene, std::span<const OwnPerson> people, int step, const auto& remove) {
        std::vector<std::uint64_t> gone;
        for (const OwnPerson& person : people) {
            if (is_thrown(person.number, step)) {
                const BodyState state = scene.state(person.body);
                scene.set_pose(person.body, state.position + Vec3<double>{0.05, 0.03, 0}, state.orientation,
                               state.yaw);
                scene.set_velocity(person.body, {1, -1, 0}, {0, 0, 2});
            }
            if (leaves(person.number, step)) gone.push_back(person.number);
        }
        remove(gone);
    };
    const std::vector<std::uint64_t> expected =
        hashes_of_one_process(walkers, {}, steps, every, [&](WalkersOnOneScene& one, int step) {
            change(one.scene, one.people, step, [&](const std::vector<std::uint64_t>& gone) {
                for (const std::uint64_t number : gone) one.remove(number);
            });
        });
    DistributedCrowd crowd(MPI_COMM_WORLD);
    add_all(crowd, walkers);
    expect_hashes(crowd, walkers, expected, every, [&](int step) {
        change(crowd.scene(), crowd.people(), step,
               [&](const std::vector<std::uint64_t>& gone) { crowd.remove_people(gone); });
    });
    EXPECT_LT(sum(crowd.figures().people), 2400);
}

TEST(DistributedCrowd, HasThemBesideADoorThatMoves)
{
    const Walkers walkers({.people = 2500, .spacing = 0.5, .friction = 0.3F});
    constexpr int steps = 240, every = 10;
    std::optional<Door> of_one;
    const std::vector<std::uint64_t> expected =
        hashes_of_one_process(walkers, {}, steps, every, [&](WalkersOnOneScene& one, int step) {
            if (step == 1) of_one.emplace(one.scene, walkers);
            of_one->move(one.scene, step);
        });
    DistributedCrowd crowd(MPI_COMM_WORLD);
    add_all(crowd, walkers);
    const Door door(crowd.scene(), walkers);
    expect_hashes(crowd, walkers, expected, every, [&](int step) { door.move(crowd.scene(), step); });
}

/// Pressures at a border are those of one process, bit for bit, and forces of all contacts add up to what people gained.
TEST(DistributedCrowd, ReadsTheLoadsOfOneProcess)
{
    const Walkers walkers({.people = 3000, .spacing = 0.42, .friction = 0.3F});
    constexpr int steps = 40;
    std::vector<BodyLoad> expected(walkers.numbers.size());
    if (rank() == 0) {
        WalkersOnOneScene one(walkers, {}, {});
        for (int step = 0; step < steps; ++step) one.step(dt);
        expected = one.read_loads();
    }
    send_to_all(expected);
    DistributedCrowd crowd(MPI_COMM_WORLD);
    add_all(crowd, walkers);
    for (int step = 0; step < steps; ++step) {
        walkers.steer(crowd.scene(), crowd.people());
        ASSERT_EQ(crowd.step(dt).status, StepStatus::done);
    }
    const std::vector<BodyLoad> loads = crowd.read_loads();
    ASSERT_EQ(loads.size(), crowd.people().size());
    float most = 0;
    for (std::size_t i = 0; i < loads.size(); ++i) {
        const BodyLoad& load = expected[crowd.people()[i].number];
        expect_same(loads[i], load);
        most = std::max(most, load.pressure);
    }
    MPI_Allreduce(MPI_IN_PLACE, &most, 1, MPI_FLOAT, MPI_MAX, MPI_COMM_WORLD);
    EXPECT_GT(most, 100);
}

/// Each rank measures the contacts that it solves: together they are those of one process, and measuring changes no bit.
TEST(DistributedCrowd, MeasuresAddUpToThoseOfOneProcess)
{
    const Walkers walkers({.people = 3000, .spacing = 0.42, .friction = 0.3F});
    const SolverSettings settings{.measures = true};
    constexpr int steps = 30;
    struct {
        std::uint64_t hash;
        double squares, largest, deepest;
    } expected{};
    if (rank() == 0) {
        WalkersOnOneScene one(walkers, settings, {});
        StepMeasures last;
        for (int step = 0; step < steps; ++step) last = one.step(dt).measures;
        expected = {one.hash(), last.residual_norm * last.residual_norm, last.residual_max,
                    last.penetration_max};
    }
    MPI_Bcast(&expected, sizeof expected, MPI_BYTE, 0, MPI_COMM_WORLD);
    DistributedCrowd crowd(MPI_COMM_WORLD, settings);
    add_all(crowd, walkers);
    StepMeasures own;
    for (int step = 0; step < steps; ++step) {
        walkers.steer(crowd.scene(), crowd.people());
        own = crowd.step(dt).measures;
    }
    double squares = own.residual_norm * own.residual_norm;
    std::array<double, 2> most{own.residual_max, own.penetration_max};
    MPI_Allreduce(MPI_IN_PLACE, &squares, 1, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
    MPI_Allreduce(MPI_IN_PLACE, most.data(), 2, MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD);
    EXPECT_EQ(crowd.hash(), expected.hash);
    EXPECT_GT(squares, 0);
    EXPECT_NEAR(squares, expected.squares, 1e-9 * expected.squares);
    EXPECT_EQ(most[0], expected.largest);
    EXPECT_EQ(most[1], expected.deepest);
}

std::string checkpoint_file()
{
    return ::testing::TempDir() + "motley_checkpoint_of_" + std::to_string(ranks()) + "_ranks";
}

/// A run that ends is taken up again from its checkpoint, on as many ranks as there were and on fewer; with the bits of one
/// process that searches for contacts in the same step.
TEST(DistributedCrowd, GoesOnFromACheckpointOnAnyNumberOfRanks)
{
    const Walkers walkers({.people = 3000, .spacing = 0.45, .friction = 0.3F});
    constexpr int saved_at = 47, steps = 100;
    const std::vector<std::uint64_t> expected =
        hashes_of_one_process(walkers, {}, steps, steps, [&](WalkersOnOneScene& one, int step) {
            if (step == saved_at + 1) one.scene.set_disc(one.people[0].body, walkers.discs[0]);
        });
    const std::string path = checkpoint_file();
    {
        DistributedCrowd crowd(MPI_COMM_WORLD);
        add_all(crowd, walkers);
        for (int step = 1; step <= steps; ++step) {
            walkers.steer(crowd.scene(), crowd.people());
            ASSERT_EQ(crowd.step(dt).status, StepStatus::done);
            if (step == saved_at) crowd.save(path);
        }
        EXPECT_EQ(crowd.hash(), expected[0]);
    }
    for (const int fewer : {ranks(), 1, 2, 5}) {
        if (fewer > ranks()) continue;
        MPI_Comm some = MPI_COMM_NULL;
        MPI_Comm_split(MPI_COMM_WORLD, rank() < fewer ? 0 : MPI_UNDEFINED, rank(), &some);
        if (some == MPI_COMM_NULL) continue;
        {
            DistributedCrowd crowd(some);
            walkers.add_walls(crowd.scene());
            crowd.load(path);
            EXPECT_EQ(crowd.figures().steps, saved_at);
            for (int step = saved_at + 1; step <= steps; ++step) {
                walkers.steer(crowd.scene(), crowd.people());
                ASSERT_EQ(crowd.step(dt).status, StepStatus::done);
            }
            EXPECT_EQ(crowd.hash(), expected[0]) << "on " << fewer << " ranks";
        }
        MPI_Comm_free(&some);
    }
    MPI_Barrier(MPI_COMM_WORLD);
    if (rank() == 0) std::remove(path.c_str());
}

/// The checkpoint with 8 bytes of its first person, from byte `at` of the record on, changed, and a checksum that agrees.
std::string forge(std::string bytes, std::size_t at, double value)
{
    constexpr std::size_t head = 104, record = 144, check_at = 56;
    const auto hash = [&] {
        std::array<std::uint64_t, record / 8> words;
        std::memcpy(words.data(), &bytes[head], record);
        return hash_bytes(0, words.data(), words.size());
    };
    const std::uint64_t before = hash();
    std::memcpy(&bytes[head + at], &value, 8);
    std::uint64_t check = 0;
    std::memcpy(&check, &bytes[check_at], 8);
    check += hash() - before;
    std::memcpy(&bytes[check_at], &check, 8);
    return bytes;
}

TEST(DistributedCrowd, RefusesCheckpointsThatAreNotWhole)
{
    const Walkers walkers({.people = 300});
    const std::string path = checkpoint_file();
    DistributedCrowd crowd(MPI_COMM_WORLD);
    add_all(crowd, walkers);
    for (int step = 0; step < 5; ++step) crowd.step(dt);
    crowd.save(path);
    EXPECT_THROW(crowd.load(path), InvalidInput);  // it has people
    EXPECT_THROW(crowd.save("/nowhere/at/all"), std::runtime_error);
    DistributedCrowd other(MPI_COMM_WORLD);
    EXPECT_THROW(other.load("/nowhere/at/all"), std::runtime_error);
    EXPECT_THROW(other.load(path), std::runtime_error);  // it has no walls
    walkers.add_walls(other.scene());
    std::string whole;
    {
        std::ifstream file(path, std::ios::binary);
        whole.assign(std::istreambuf_iterator<char>(file), {});
    }
    const auto refuses = [&](const std::string& bytes) {
        MPI_Barrier(MPI_COMM_WORLD);
        if (rank() == 0) std::ofstream(path, std::ios::binary) << bytes;
        MPI_Barrier(MPI_COMM_WORLD);
        EXPECT_THROW(other.load(path), std::runtime_error);
        EXPECT_TRUE(other.people().empty());
    };
    for (const std::size_t length : {std::size_t{0}, std::size_t{8}, std::size_t{103}, whole.size() - 1})
        refuses(whole.substr(0, length));
    refuses(whole + "x");
    // A byte of the magic, of the version, of the size of a person, of the number of people, of the pause, of a person, of an impulse's
    // place, of an impulse.
    for (const std::size_t at :
         {std::size_t{0}, std::size_t{8}, std::size_t{16}, std::size_t{24}, std::size_t{96}, std::size_t{224},
          std::size_t{104 + 136}, whole.size() - 20}) {
        std::string damaged = whole;
        damaged[at] = static_cast<char>(damaged[at] ^ 0x40);
        refuses(damaged);
    }
    // A place that is no number, and one that is too far away; velocities, forces, a mass, a radius that are none.
    const double none = std::numeric_limits<double>::quiet_NaN();
    refuses(forge(whole, 8, none));
    refuses(forge(whole, 16, 1e13));
    for (const std::size_t at : {std::size_t{40}, std::size_t{52}, std::size_t{72}, std::size_t{80}})
        refuses(forge(whole, at, none));
    MPI_Barrier(MPI_COMM_WORLD);
    if (rank() == 0) std::ofstream(path, std::ios::binary) << whole;
    MPI_Barrier(MPI_COMM_WORLD);
    other.load(path);
    EXPECT_EQ(other.hash(), crowd.hash());
    MPI_Barrier(MPI_COMM_WORLD);
    // That forging itself is not what is refused: a place a millimetre off is one that a crowd could have.
    if (rank() == 0) std::ofstream(path, std::ios::binary) << forge(whole, 8, 0.251);
    MPI_Barrier(MPI_COMM_WORLD);
    DistributedCrowd forged(MPI_COMM_WORLD);
    walkers.add_walls(forged.scene());
    forged.load(path);
    EXPECT_NE(forged.hash(), crowd.hash());
    MPI_Barrier(MPI_COMM_WORLD);
    if (rank() == 0) std::remove(path.c_str());
}

TEST(DistributedCrowd, RefusesOnAllRanksWhatOneOfThemCannotDo)
{
    const Walkers walkers({.people = 600});
    DistributedCrowd crowd(MPI_COMM_WORLD);
    add_all(crowd, walkers);
    const std::uint64_t before = crowd.hash();
    StepReport report = crowd.step(rank() == 0 ? 2.0F : dt);
    EXPECT_EQ(report.status, StepStatus::refused);
    if (ranks() > 1) {
        report = crowd.step(rank() == 0 ? 0.01F : dt);
        EXPECT_NE(report.error.find("not the same on all ranks"), std::string::npos) << report.error;
    }
    ConstraintId joint{};
    BodyId post{};
    if (rank() == ranks() - 1) {
        post = crowd.scene().add_body({.position = {1, 2, 3}});
        joint = crowd.scene().add_joint(BallSocketDefinition{crowd.scene().ground(), post, {1, 2, 3}, {}});
    }
    report = crowd.step(dt);
    EXPECT_EQ(report.status, StepStatus::refused);
    EXPECT_NE(report.error.find("joints"), std::string::npos) << report.error;
    if (rank() == ranks() - 1) crowd.scene().remove_body(post);
    EXPECT_EQ(crowd.hash(), before);
    EXPECT_EQ(crowd.step(dt).status, StepStatus::done);

    // Ranks must make the same number of sweeps.
    const BodyId wishing = crowd.find(0);
    if (wishing != BodyId{}) crowd.scene().set_island_iterations(wishing, 20);
    report = crowd.step(dt);
    EXPECT_EQ(report.status, StepStatus::refused);
    EXPECT_NE(report.error.find("wishes of islands"), std::string::npos) << report.error;
    if (wishing != BodyId{}) crowd.scene().set_island_iterations(wishing, 0);

    // A giant reaches further than the strips are made for.
    const std::uint64_t giant = 1000;
    const BodyDefinition body{.model = BodyModel::planar,
                              .position = {-40, -40, 0},
                              .mass = 1000,
                              .inertia = {1, 0, 0, 1, 0, 1e5F}};
    if (rank() == 0) crowd.add_people({&giant, 1}, {&body, 1}, std::vector<DiscDefinition>{{.radius = 20}});
    report = crowd.step(dt);
    EXPECT_EQ(report.status, StepStatus::refused);
    EXPECT_NE(report.error.find("reach further"), std::string::npos) << report.error;
    if (crowd.find(giant) != BodyId{}) crowd.remove_people({&giant, 1});
    EXPECT_EQ(crowd.step(dt).status, StepStatus::done);
}

TEST(DistributedCrowd, RefusesBadPeopleAndSettingsByName)
{
    for (const SolverSettings& settings :
         {SolverSettings{.method = Method::direct}, SolverSettings{.tolerance = 0.1F},
          SolverSettings{.exact_contacts = true}, SolverSettings{.budget_ms = 1}})
        EXPECT_THROW(DistributedCrowd(MPI_COMM_WORLD, settings), InvalidInput);
    DistributedCrowd crowd(MPI_COMM_WORLD);
    const std::vector<std::uint64_t> twice{3, 3}, one{3};
    const BodyDefinition planar{.model = BodyModel::planar};
    const std::vector<BodyDefinition> bodies{planar, planar};
    const std::vector<DiscDefinition> discs(2);
    EXPECT_THROW(crowd.add_people(twice, bodies, discs), InvalidInput);
    EXPECT_THROW(crowd.add_people(one, bodies, discs), InvalidInput);
    EXPECT_THROW(crowd.add_people(one, std::vector<BodyDefinition>{{}}, {discs.data(), 1}), InvalidInput);
    EXPECT_THROW(crowd.add_people(one, {bodies.data(), 1}, std::vector<DiscDefinition>{{.radius = -1}}),
                 InvalidInput);
    EXPECT_EQ(crowd.scene().body_count(), 0U);
    EXPECT_THROW(crowd.remove_people(one), InvalidInput);
    EXPECT_EQ(crowd.find(3), BodyId{});
    EXPECT_EQ(crowd.step(dt).status, StepStatus::done);
}

}  // namespace
}  // namespace motley::testing
