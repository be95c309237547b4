// Promise 5: a warm step allocates nothing. Counted by replacing operator new in this whole executable.
#include <gtest/gtest.h>

#include <atomic>
#include <cstddef>
#include <new>

#include "allocator.h"
#include "disc_crowd.h"
#include "fallen_figures.h"
#include "lattice_crowd.h"
#include "mixed_scene.h"
#include "shape_crowd.h"
#include "system.h"

namespace motley::testing {

std::atomic<long> allocations{0}, bytes_allocated{0}, allocations_until_failure{never}, failures_left{0};

}  // namespace motley::testing

namespace {

void* counted(std::size_t size, std::size_t alignment)
{
    using motley::testing::allocations_until_failure;
    using motley::testing::failures_left;
    ++motley::testing::allocations;
    motley::testing::bytes_allocated += static_cast<long>(size);
    if (allocations_until_failure != motley::testing::never && --allocations_until_failure < 0) {
        if (failures_left.fetch_sub(1) > 0) throw std::bad_alloc();
    }
    void* memory = motley::testing::allocate_aligned(alignment, size);
    if (memory == nullptr) throw std::bad_alloc();
    return memory;
}

}  // namespace

// Not inlined: the compiler would see that memory of one function is freed by another, and warn.
[[gnu::noinline]] void* operator new(std::size_t size)
{
    return counted(size, alignof(std::max_align_t));
}
[[gnu::noinline]] void* operator new(std::size_t size, std::align_val_t alignment)
{
    return counted(size, static_cast<std::size_t>(alignment));
}
[[gnu::noinline]] void operator delete(void* memory) noexcept
{
    motley::testing::free_aligned(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept
{
    motley::testing::free_aligned(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::align_val_t) noexcept
{
    motley::testing::free_aligned(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t, std::align_val_t) noexcept
{
    motley::testing::free_aligned(memory);
}

namespace motley {
namespace {

using testing::allocations;

/// The number of allocations in 20 steps after 200 steps of warming up.
long allocations_of_warm_steps(int threads, float tolerance = 0, bool exact_contacts = false)
{
    testing::MixedScene mixed;
    SolverSettings settings;
    settings.gravity = {0, -9.81F, 0};
    settings.tolerance = tolerance;
    settings.measures = tolerance > 0;
    settings.exact_contacts = exact_contacts;
    Solver solver(settings, {.threads = threads, .alone_below = 0});
    for (int step = 0; step < 200; ++step) solver.step(mixed.scene, 1.0F / 60, mixed.contacts());
    const std::vector<Contact> contacts = mixed.contacts();
    solver.step(mixed.scene, 1.0F / 60, contacts);
    const long before = allocations;
    for (int step = 0; step < 20; ++step) solver.step(mixed.scene, 1.0F / 60, contacts);
    return allocations - before;
}

/// The same for a crowd that is large enough for patches.
long allocations_of_patches(int threads)
{
    testing::LatticeCrowd crowd;
    const std::vector<Contact> contacts = crowd.contacts();
    Solver solver(SolverSettings{}, {.threads = threads});
    for (int step = 0; step < 3; ++step) solver.step(crowd.scene, 1.0F / 60, contacts);
    const long before = allocations;
    for (int step = 0; step < 3; ++step) solver.step(crowd.scene, 1.0F / 60, contacts);
    return allocations - before;
}

/// The same for discs that jostle, so that some leave their skins, and all are searched for again several times.
long allocations_of_discs(int threads)
{
    testing::DiscCrowd crowd({.people = 3000, .friction = 0.2F, .speed = 1});
    crowd.pull_together(100);
    Solver solver(SolverSettings{}, {.threads = threads, .alone_below = 0});
    for (int step = 0; step < 400; ++step) solver.step(crowd.scene, 1.0F / 60);
    const long before = allocations;
    for (int step = 0; step < 60; ++step) solver.step(crowd.scene, 1.0F / 60);
    return allocations - before;
}

/// The same for capsules of all kinds in a crowd, some of which are always on the move.
long allocations_of_capsules(int threads)
{
    testing::ShapeCrowd crowd;
    Solver solver({.gravity = {0, 0, -9.81F}}, {.threads = threads, .alone_below = 0});
    const auto stir = [&](int step) {
        const BodyId body = crowd.people[static_cast<std::size_t>(step) % crowd.people.size()];
        crowd.scene.set_velocity(body, {step % 2 == 0 ? 1.0F : -1.0F, 0.5F, 0}, {});
        solver.step(crowd.scene, 1.0F / 60);
    };
    for (int step = 0; step < 3000; ++step) stir(step);
    const long before = allocations;
    for (int step = 0; step < 60; ++step) stir(step);
    return allocations - before;
}

/// The same for a crowd that sleeps, has woken, and sleeps again.
long allocations_of_sleepers(int threads)
{
    testing::DiscCrowd crowd({.people = 3000, .speed = 0, .spacing = 0.45});
    SolverSettings settings;
    settings.sleep_speed = 0.01F;
    Solver solver(settings, {.threads = threads, .alone_below = 0});
    const auto step = [&](int steps) {
        for (int i = 0; i < steps; ++i) solver.step(crowd.scene, 1.0F / 60);
    };
    step(60);
    EXPECT_TRUE(crowd.scene.is_asleep(crowd.people[17]));
    crowd.scene.wake(crowd.people[17]);
    step(60);
    EXPECT_TRUE(crowd.scene.is_asleep(crowd.people[17]));
    const long before = allocations;
    step(20);
    return allocations - before;
}

/// The same for what a host asks after each of such steps: events, indices and their queries.
long allocations_of_questions()
{
    testing::DiscCrowd crowd({.people = 3000, .speed = 1});
    crowd.pull_together(100);
    Solver solver;
    ContactEvents events;
    CrowdIndex people;
    WallIndex walls;
    std::vector<BodyId> found;
    found.reserve(crowd.people.size());
    std::vector<NearPerson> near;
    const Polygon area{{{1, 1}, {20, 2}, {8, 15}}, {{{5, 3}, {6, 3}, {6, 4}}}};
    const auto ask = [&] {
        const long before = allocations;
        events.update(crowd.scene);
        people.build(crowd.scene);
        walls.build(crowd.scene);
        people.inside(area, found);
        people.centres_within({5, 5}, 3, found);
        people.discs_within({5, 5}, 3, found);
        people.nearest({5, 5}, 20, near);
        (void)walls.first_hit({5, 5}, {100, 5});
        (void)walls.is_free({5, 5}, {100, 5});
        return allocations - before;
    };
    long warm = 0;
    for (int step = 0; step < 460; ++step) {
        solver.step(crowd.scene, 1.0F / 60);
        const long asked = ask();
        if (step >= 400) warm += asked;
    }
    return warm;
}

/// The same for steps in which every contact has a new key.
long allocations_of_new_contacts()
{
    testing::MixedScene mixed;
    Solver solver({.gravity = {0, -9.81F, 0}});
    for (int step = 0; step < 200; ++step) solver.step(mixed.scene, 1.0F / 60, mixed.contacts());
    std::vector<Contact> contacts = mixed.contacts();
    const auto step_anew = [&] {
        for (Contact& contact : contacts) contact.key += std::uint64_t{1} << 48;
        solver.step(mixed.scene, 1.0F / 60, contacts);
    };
    // Colouring all contacts anew may need other blocks than before, but only once.
    step_anew();
    const long before = allocations;
    for (int step = 0; step < 20; ++step) step_anew();
    return allocations - before;
}

/// The same for forty chains of three in lockstep, one of which touches the ground, or another one, in every fourth step.
long allocations_of_figures(bool exact, int threads)
{
    Scene scene;
    std::vector<BodyId> links;
    for (int chain = 0; chain < 40; ++chain) {
        BodyId before = scene.ground();
        Vec3<float> hook{static_cast<float>(chain), 0, 0};
        for (int i = 0; i < 3; ++i) {
            BodyDefinition link;
            link.position = {static_cast<double>(chain), -0.25 - 0.5 * i, 0};
            links.push_back(scene.add_body(link));
            scene.add_joint(BallSocketDefinition{before, links.back(), hook, {0, 0.25F, 0}});
            before = links.back();
            hook = {0, -0.25F, 0};
        }
    }
    SolverSettings settings;
    settings.gravity = {0, -9.81F, 1};
    settings.exact_joints = exact;
    Solver solver(settings, {.threads = threads, .alone_below = 0});
    Contact contact;
    contact.body_b = links[7];
    contact.normal = {0, 0, 1};
    const auto step = [&](int number) {
        contact.body_a = number % 4 == 0 ? scene.ground() : links[20];
        const bool touches = number % 2 == 0;
        solver.step(scene, 1.0F / 60, std::span<const Contact>(&contact, touches ? 1 : 0));
    };
    for (int number = 0; number < 40; ++number) step(number);
    const long before = allocations;
    for (int number = 0; number < 40; ++number) step(number);
    return allocations - before;
}

/// The same for people of whom some have become rigid bodies, and for changes into rows that were used before.
long allocations_after_changes(int threads)
{
    testing::DiscCrowd crowd({.people = 600, .friction = 0.2F});
    Scene& scene = crowd.scene;
    for (std::size_t i = 0; i < crowd.people.size(); i += 3) scene.clear_disc(crowd.people[i]);
    Solver solver(SolverSettings{}, {.threads = threads, .alone_below = 0});
    const auto change = [&](BodyModel model) {
        for (std::size_t i = 0; i < crowd.people.size(); i += 3)
            scene.change_body(crowd.people[i], {model, {1, 0, 0, 1, 0, 1}});
    };
    const auto change_there_and_back = [&](int steps) {
        for (const BodyModel model : {BodyModel::rigid, BodyModel::particle, BodyModel::planar}) {
            change(model);
            for (int step = 0; step < steps; ++step) solver.step(scene, 1.0F / 60);
        }
    };
    change_there_and_back(60);
    long before = allocations;
    change_there_and_back(0);
    const long of_changes = allocations - before;
    scene.add_joint(DistanceDefinition{.body_a = crowd.people[0], .body_b = crowd.people[3]});
    change(BodyModel::rigid);
    solver.step(scene, 1.0F / 60);  // lays out the joints anew
    before = allocations;
    for (int step = 0; step < 60; ++step) solver.step(scene, 1.0F / 60);
    return of_changes + allocations - before;
}

/// The same for people who fall on a floor, lie down and then come to rest.
long allocations_of_fallen_figures(bool exact, int threads)
{
    testing::FallenFigures fallen({.copies = 40, .all_touches = true, .turntable = true});
    SolverSettings settings = testing::with_gravity({0, -9.81F, 0});
    settings.exact_joints = exact;
    Solver solver(settings, {.threads = threads, .alone_below = 0});
    long warm = 0;
    for (int step = 0; step < 260; ++step) {
        fallen.turn();
        const std::vector<Contact> contacts = fallen.contacts();
        const long before = allocations;
        solver.step(fallen.scene, testing::frame_time, contacts);
        if (step >= 200) warm += allocations - before;
    }
    return warm;
}

TEST(Allocation, TheCounterCounts)
{
    const long before = allocations;
    ::operator delete(::operator new(16));  // a new-expression might be optimised away
    EXPECT_GT(allocations, before);
}
TEST(Allocation, AWarmStepOnOneThreadAllocatesNothing)
{
    EXPECT_EQ(allocations_of_warm_steps(1), 0);
}
TEST(Allocation, AWarmStepOnTwoThreadsAllocatesNothing)
{
    EXPECT_EQ(allocations_of_warm_steps(2), 0);
}
TEST(Allocation, AWarmStepWithExactContactsAllocatesNothing)
{
    EXPECT_EQ(allocations_of_warm_steps(2, 0, true), 0);
}
TEST(Allocation, ContactsThatComeAndGoAllocateNothing)
{
    EXPECT_EQ(allocations_of_new_contacts(), 0);
}
TEST(Allocation, WarmFiguresAllocateNothing)
{
    EXPECT_EQ(allocations_of_figures(false, 1), 0);
    EXPECT_EQ(allocations_of_figures(true, 2), 0);
    EXPECT_EQ(allocations_of_fallen_figures(false, 2), 0);
    EXPECT_EQ(allocations_of_fallen_figures(true, 1), 0);
}
TEST(Allocation, AWarmStepThatMeasuresAndStopsIslandsAllocatesNothing)
{
    EXPECT_EQ(allocations_of_warm_steps(2, 1e-3F), 0);
}

TEST(Allocation, WarmDiscsAllocateNothing)
{
    for (const int threads : {1, 2}) EXPECT_EQ(allocations_of_discs(threads), 0) << threads << " threads";
}

TEST(Allocation, WarmCapsulesAllocateNothing)
{
    for (const int threads : {1, 2}) EXPECT_EQ(allocations_of_capsules(threads), 0) << threads << " threads";
}

TEST(Allocation, ChangesOfModelsAndTheStepsAfterThemAllocateNothingOnceWarm)
{
    for (const int threads : {1, 2})
        EXPECT_EQ(allocations_after_changes(threads), 0) << threads << " threads";
}

TEST(Allocation, SleepersAllocateNothing)
{
    for (const int threads : {1, 2}) EXPECT_EQ(allocations_of_sleepers(threads), 0) << threads << " threads";
}

TEST(Allocation, WarmQuestionsOfAHostAllocateNothing)
{
    EXPECT_EQ(allocations_of_questions(), 0);
}

TEST(Allocation, AWarmStepInPatchesAllocatesNothing)
{
    for (const int threads : {1, 2}) EXPECT_EQ(allocations_of_patches(threads), 0) << threads << " threads";
}

}  // namespace
}  // namespace motley
