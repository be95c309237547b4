// The plan of a step for every method, in the text that the README and plan.h show. The tests of same bits and of
// physics check that a step does what its plan says.
#include "step/plan.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>

namespace motley {
namespace {

Plan plan_of(const SolverSettings& settings, const StepNeeds& needs = {})
{
    Plan plan;
    make_plan(settings.resolved(), needs, plan);
    return plan;
}

constexpr const char* soft_step =
    "note momenta of free groups\n"
    "prepare\n"
    "stiffen what bears heavy loads\n"
    "step figures in lockstep\n"
    "4 substeps of\n"
    "    add up impulses (all but the first substep)\n"
    "    integrate velocities\n"
    "    warm start\n"
    "    solve\n"
    "    integrate positions\n"
    "    relax\n"
    "add up impulses\n"
    "store impulses\n"
    "land free groups\n"
    "move bodies\n";

TEST(Plan, OfSoftStep)
{
    EXPECT_EQ(text_of(plan_of({})), soft_step);
}

TEST(Plan, OfSequentialImpulse)
{
    EXPECT_EQ(text_of(plan_of({.method = Method::sequential_impulse})),
              "note momenta of free groups\n"
              "prepare\n"
              "stiffen what bears heavy loads\n"
              "step figures in lockstep\n"
              "4 substeps of\n"
              "    add up impulses (all but the first substep)\n"
              "    integrate velocities\n"
              "    warm start\n"
              "    solve x 8\n"
              "    integrate positions\n"
              "    project x 2\n"
              "add up impulses\n"
              "store impulses\n"
              "land free groups\n"
              "move bodies\n");
}

TEST(Plan, OfDirect)
{
    EXPECT_EQ(text_of(plan_of({.method = Method::direct})),
              "solve directly\n"
              "move bodies\n");
}

TEST(Plan, OfExactJointsWithAllThatAStepMayNeed)
{
    const StepNeeds everything{
        .solves_trees = true, .bounces = true, .picks_islands = true, .measures = true};
    EXPECT_EQ(text_of(plan_of({.iterations = 3, .exact_joints = true}, everything)),
              "find islands\n"
              "note momenta of free groups\n"
              "prepare\n"
              "stiffen what bears heavy loads\n"
              "step figures in lockstep\n"
              "4 substeps of\n"
              "    add up impulses (all but the first substep)\n"
              "    integrate velocities\n"
              "    factor trees (first substep)\n"
              "    begin trees\n"
              "    warm start\n"
              "    lengthen steps beside trees\n"
              "    solve trees\n"
              "    solve x 3\n"
              "    measure residuals (last substep)\n"
              "    integrate positions\n"
              "    factor trees\n"
              "    relax\n"
              "restitution\n"
              "add up impulses\n"
              "store impulses\n"
              "land free groups\n"
              "move bodies\n");
}

TEST(Plan, WithoutRelaxationPassesOverBodiesAreFused)
{
    Plan plan = plan_of({.relaxations = 0});
    fuse_integrations(plan);
    EXPECT_EQ(text_of(plan),
              "note momenta of free groups\n"
              "prepare\n"
              "stiffen what bears heavy loads\n"
              "step figures in lockstep\n"
              "4 substeps of\n"
              "    add up impulses (all but the first substep)\n"
              "    integrate velocities (first substep)\n"
              "    warm start\n"
              "    solve\n"
              "    integrate positions (last substep)\n"
              "    integrate positions, then the next velocities (all but the last substep)\n"
              "add up impulses\n"
              "store impulses\n"
              "land free groups\n"
              "move bodies\n");
}

TEST(Plan, WithRelaxationNothingOfItIsFused)
{
    Plan plan = plan_of({});
    fuse_integrations(plan);
    EXPECT_EQ(text_of(plan), soft_step);
}

TEST(Plan, OfALargeCrowdVisitsEachPatchOnceAndReplaysItsWarmStarts)
{
    Plan plan = plan_of({.iterations = 2});
    replay_warm_starts(plan);
    visit_patches_once(plan);
    EXPECT_EQ(text_of(plan),
              "note momenta of free groups\n"
              "prepare\n"
              "stiffen what bears heavy loads\n"
              "step figures in lockstep\n"
              "list bodies beside patches\n"
              "4 substeps of\n"
              "    add up impulses (all but the first substep)\n"
              "    integrate velocities\n"
              "    warm start (first substep)\n"
              "    solve\n"
              "    solve, beside patches\n"
              "    visit each patch\n"
              "        solve\n"
              "        integrate positions\n"
              "        relax\n"
              "    integrate positions, beside patches\n"
              "    relax, beside patches\n"
              "add up impulses\n"
              "store impulses\n"
              "land free groups\n"
              "move bodies\n");
}

TEST(Plan, IsMadeAnewForEachStep)
{
    Plan plan = plan_of({.iterations = 2});
    replay_warm_starts(plan);
    visit_patches_once(plan);
    make_plan(SolverSettings{}.resolved(), {}, plan);
    EXPECT_EQ(text_of(plan), soft_step);
    EXPECT_TRUE(plan.visit.empty());
    EXPECT_FALSE(plan.replays_warm_starts);
}

TEST(Plan, OfTheReadmeIsThatOfTheDefault)
{
    std::ifstream file(MOTLEY_README);
    const std::string readme{std::istreambuf_iterator<char>(file), {}};
    EXPECT_NE(readme.find("```\n" + std::string(soft_step) + "```\n"), std::string::npos)
        << "The drawing of a step in README.md is to be\n"
        << soft_step;
}

}  // namespace
}  // namespace motley
