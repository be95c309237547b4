// Scenes of people: what a run of them tells. Independent evidence: counting, and runs that must agree with each other.
#include <gtest/gtest.h>

#include <cmath>
#include <string_view>

#include "measuring/runner.h"
#include "worlds/scenes/corridor.h"
#include "worlds/scenes/door_count.h"

namespace motley::bench {
namespace {

RunResult run(const char* scene, const RunOptions& options)
{
    RunOutputs quiet;
    quiet.progress = false;
    return run_scene(*find_scene(scene), options, quiet);
}

double figure(const RunResult& result, std::string_view name)
{
    for (const Figure& figure : result.figures) {
        if (figure.first.starts_with(name)) return figure.second;
    }
    ADD_FAILURE() << "no figure " << name;
    return 0;
}

void expect_all_marks(const RunResult& result)
{
    EXPECT_FALSE(result.marks.empty());
    for (const Mark& mark : result.marks) EXPECT_TRUE(mark.passes()) << mark.name << ": " << mark.value;
}

TEST(DoorCount, TellsFlowAndClogs)
{
    DoorCount count;
    for (const double time : {2.0, 2.5, 4.0, 4.5, 8.0}) count.pass(time);
    EXPECT_EQ(count.passed(), 5);
    EXPECT_NEAR(count.flow(), 4 / 6.0, 1e-12);
    EXPECT_EQ(count.clogs(), 2);
    EXPECT_NEAR(count.clogged(), 1.5 + 3.5, 1e-12);
    count.stop(20);
    EXPECT_EQ(count.clogs(), 3);
    EXPECT_NEAR(count.longest(), 12, 1e-12);
}

TEST(Evacuation, EverybodyLeavesOnceAndByTheDoor)
{
    for (const bool is_listed : {false, true}) {
        const RunResult result =
            run("evacuation", {.agents = 100, .seconds = 60, .lists_contacts = is_listed, .door = 1.8});
        EXPECT_EQ(figure(result, "people through the door"), 100);
        EXPECT_LT(result.steps, 60 * 60) << "it ends when everybody has left";
        expect_all_marks(result);
    }
}

TEST(Evacuation, FrictionClogsANarrowDoor)
{
    RunOptions options{.agents = 200, .seconds = 40, .door = 0.9};
    const double smooth = figure(run("evacuation", options), "people through the door");
    options.friction = 0.2F;
    EXPECT_LT(figure(run("evacuation", options), "people through the door"), smooth);
}

TEST(Counterflow, PeopleStayInTheCorridorThroughoutTheirWalksAround)
{
    for (const bool is_listed : {false, true}) {
        RunOptions options{.agents = 100, .seconds = 45, .lists_contacts = is_listed};
        const RunResult result = run("counterflow", options);
        EXPECT_EQ(result.bodies, 100);
        expect_all_marks(result);
        // 45 s at 1.34 m/s are more than the 50 m of the corridor, so that many have been put back.
        EXPECT_GT(figure(result, "speed along each one's way"), 1.0);
    }
}

TEST(Corridor, WeidmannsCurveIsThePublishedOne)
{
    EXPECT_NEAR(Corridor::weidmann(5.4), 0, 1e-12);
    EXPECT_NEAR(Corridor::weidmann(1), 1.34 * (1 - std::exp(-1.913 * (1 - 1 / 5.4))), 1e-12);
}

TEST(DoorCloses, NobodyGetsThroughAtAnySpeed)
{
    expect_all_marks(run("door-closes", {.agents = 300, .seconds = 25}));
}

TEST(CrowdScenes, HaveTheSameBitsOnTwoThreadsUnderEverySteering)
{
    for (const SteeringModel model :
         {SteeringModel::plain, SteeringModel::social_force, SteeringModel::orca}) {
        for (const char* scene : {"crowd", "counterflow", "evacuation"}) {
            RunOptions options{.agents = 600, .seconds = 1, .steering = model};
            const std::uint64_t one = run(scene, options).state_hash;
            options.solver = {.threads = 2, .alone_below = 0};
            EXPECT_EQ(run(scene, options).state_hash, one) << scene;
        }
    }
}

TEST(LevelOfDetail, ChangesKeepMomentaAndHaveTheSameBitsOnTwoThreads)
{
    RunOptions options{.agents = 400, .seconds = 12};
    const RunResult one = run("level-of-detail", options);
    expect_all_marks(one);
    // Twenty of each in every second but the first. Two fall, unless one whose turn it is lies already, which one does, and rise
    // eight seconds later.
    EXPECT_EQ(figure(one, "people promoted"), 220);
    EXPECT_EQ(figure(one, "people demoted"), 220);
    EXPECT_EQ(figure(one, "people who fell"), 21);
    EXPECT_EQ(figure(one, "people who rose"), 5);
    EXPECT_GT(figure(one, "price of a figure"), figure(one, "price of a particle"));
    options.solver = {.threads = 2, .alone_below = 0};
    EXPECT_EQ(run("level-of-detail", options).state_hash, one.state_hash);
}

/// A dense crowd in which people fall on each other and rise: joints hold, and the floor bears those who lie.
TEST(MixedCrowd, KeepsItsMarksAndHasTheSameBitsOnTwoThreads)
{
    RunOptions options{.agents = 3000, .seconds = 6};
    const RunResult one = run("mixed", options);
    expect_all_marks(one);
    EXPECT_EQ(one.marks.size(), 4U);
    EXPECT_GT(figure(one, "people who fell"), 200);
    EXPECT_GT(figure(one, "people who lie"), 150);
    options.solver = {.threads = 2, .alone_below = 0};
    EXPECT_EQ(run("mixed", options).state_hash, one.state_hash);
}

/// Torsos walk through doors and past each other as discs do: nobody through a wall, and the same bits on two threads.
TEST(Torsos, KeepTheMarksOfTheScenesThatHaveThem)
{
    for (const char* scene : {"counterflow", "evacuation", "bottleneck"}) {
        RunOptions options{.seconds = 6, .torsos = true};
        const RunResult one = run(scene, options);
        expect_all_marks(one);
        options.solver = {.threads = 2, .alone_below = 0};
        EXPECT_EQ(run(scene, options).state_hash, one.state_hash) << scene;
    }
    EXPECT_THROW(run("push", {.seconds = 1, .torsos = true}), InvalidInput);
    EXPECT_THROW(run("counterflow", {.seconds = 1, .lists_contacts = true, .torsos = true}), InvalidInput);
}

/// A slab is the same whoever finds its contacts: the same forces, to what float distances resolve.
TEST(CrowdScenes, TouchesAreTheSameFoundAndListed)
{
    std::vector<double> walls;
    for (const bool is_listed : {false, true}) {
        RunOptions options{.agents = 180, .seconds = 4, .lists_contacts = is_listed};
        const auto scene = find_scene("push")->make(options);
        Solver solver{SolverSettings{}};
        for (int step = 0; step < 240; ++step) {
            scene->steer(step / 60.0, solver.executor());
            ASSERT_EQ(solver.step(scene->scene, 1.0F / 60, scene->find_contacts(solver.executor())).status,
                      StepStatus::done);
        }
        double wall = 0, people = 0;
        for (const Touch& touch : scene->crowd()->touches(scene->scene)) {
            (touch.a < 0 ? wall : people) += touch.force;
            EXPECT_EQ(touch.a < 0, touch.wall == 0);
            EXPECT_NEAR(std::hypot(touch.normal.x, touch.normal.y), 1, 1e-5);
        }
        EXPECT_NEAR(wall, 50 * 180, 0.01 * 50 * 180);
        walls.push_back(people);
    }
    EXPECT_NEAR(walls[0], walls[1], 1e-3 * walls[1]);
}

}  // namespace
}  // namespace motley::bench
