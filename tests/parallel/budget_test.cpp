// The budget: how many units of work fit into a time. Costs are made up, never measured, except for two budgets so
// small and so large that any clock gives the same result.
#include "budget.h"

#include <gtest/gtest.h>

#include "mixed_scene.h"

namespace motley {
namespace {

TEST(Budget, PicksWhatFits)
{
    Budget budget;
    EXPECT_EQ(budget.units_within(1, 100), 1);
    budget.learn(0.002, 0.004, 4);  // 2 ms of fixed cost, 1 ms a unit
    EXPECT_EQ(budget.units_within(0.0101, 100), 8);
    EXPECT_EQ(budget.units_within(0.0101, 5), 5);
    EXPECT_EQ(budget.units_within(0.001, 100), 1);
}

TEST(Budget, FollowsQuicklyUpwardsAndSlowlyDownwards)
{
    Budget budget;
    budget.learn(0.001, 0.001, 1);
    for (int i = 0; i < 3; ++i) budget.learn(0.001, 0.002, 1);
    EXPECT_LE(budget.units_within(0.0111, 100), 5);  // twice the cost: soon half the units
    for (int i = 0; i < 3; ++i) budget.learn(0.001, 0.001, 1);
    EXPECT_LT(budget.units_within(0.0111, 100), 8);
    for (int i = 0; i < 60; ++i) budget.learn(0.001, 0.001, 1);
    EXPECT_EQ(budget.units_within(0.0111, 100), 10);
}

TEST(Budget, StepsTakeTheLeastOrTheMostAndTellTheErrorPaid)
{
    for (const Method method : {Method::soft_step, Method::sequential_impulse}) {
        SolverSettings settings;
        settings.method = method;
        settings.gravity = {0, -9.81F, 0};
        settings.substeps = method == Method::soft_step ? 8 : 1;
        settings.iterations = method == Method::soft_step ? 1 : 8;
        const auto last_report = [&](float budget_ms) {
            testing::MixedScene mixed;
            settings.budget_ms = budget_ms;
            Solver solver(settings, {});
            StepReport report;
            for (int step = 0; step < 30; ++step)
                report = solver.step(mixed.scene, 1.0F / 60, mixed.contacts());
            return report;
        };
        const StepReport hurried = last_report(1e-6F), at_leisure = last_report(1e6F);
        EXPECT_EQ(hurried.substeps * hurried.iterations, 1);
        EXPECT_EQ(at_leisure.substeps * at_leisure.iterations, 8);
        EXPECT_GT(hurried.measures.residual_rms, 0);
        EXPECT_GT(at_leisure.measures.residual_rms, 0);
    }
}

}  // namespace
}  // namespace motley
