// Copies of a figure are recognised whatever the order in which their bodies came, because the order of their joints follows
// from what these connect. Independent evidence: every figure here is made a copy of another by construction.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <vector>

#include "lay_out.h"
#include "rig.h"

namespace motley {
namespace {

/// A joint of a plan; body -1 is the ground.
struct Planned {
    int a, b, type;
};
struct Plan {
    int bodies;
    std::vector<Planned> joints;
};

void add_copy(Scene& scene, const Plan& plan, std::mt19937& random)
{
    std::vector<std::size_t> order(static_cast<std::size_t>(plan.bodies));
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::shuffle(order.begin(), order.end(), random);
    std::vector<BodyId> bodies(order.size());
    for (const std::size_t body : order) bodies[body] = scene.add_body({});
    const auto body_of = [&](int planned) {
        return planned < 0 ? scene.ground() : bodies[static_cast<std::size_t>(planned)];
    };
    for (const auto& [a, b, type] : plan.joints) {
        if (type == 0)
            scene.add_joint(BallSocketDefinition{body_of(a), body_of(b), {1, 0, 0}, {-1, 0, 0}});
        else
            scene.add_joint(DistanceDefinition{.body_a = body_of(a), .body_b = body_of(b), .max_length = 5});
    }
}

/// The copies in each block of the only shape there is.
std::vector<int> blocks_of_copies(const Plan& plan, int copies, bool exactly, std::mt19937& random)
{
    Scene scene;
    for (int i = 0; i < copies; ++i) add_copy(scene, plan, random);
    Layout layout(kernel_table(Isa::scalar));
    testing::lay_out(layout, scene, {}, {.exact = {.all = exactly}});
    std::vector<int> counts;
    for (const FigureBlock& block : layout.figures.blocks()) {
        EXPECT_EQ(block.shape, layout.figures.blocks().front().shape);
        counts.push_back(block.count);
    }
    return counts;
}

Plan random_plan(std::mt19937& random)
{
    const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
    Plan plan{2 + below(18), {}};
    for (int body = 1; body < plan.bodies; ++body) {
        const int other = below(body);
        const bool turned = below(2) == 1;
        plan.joints.push_back({turned ? body : other, turned ? other : body, below(2)});
    }
    // Loops, and joints with the ground.
    for (int extra = below(3); extra > 0; --extra) {
        const int a = below(plan.bodies), b = below(plan.bodies + 1) - 1;
        if (a != b) plan.joints.push_back({a, b, below(2)});
    }
    std::shuffle(plan.joints.begin(), plan.joints.end(), random);
    return plan;
}

TEST(JointOrder, MakesCopiesOfFiguresWhoseBodiesCameInAnyOrder)
{
    std::mt19937 random(11);
    for (int i = 0; i < testing::repeats(200); ++i) {
        const Plan plan = random_plan(random);
        EXPECT_EQ(blocks_of_copies(plan, 24, false, random), (std::vector{16, 8})) << i;
    }
}

/// Most bodies of a long chain see nothing but alike bodies around them.
TEST(JointOrder, BeginsALongChainAtTheSameEnd)
{
    std::mt19937 random(12);
    for (int length = 2; length <= 60; ++length) {
        Plan plan{length, {}};
        for (int body = 1; body < length; ++body) plan.joints.push_back({body - 1, body, 0});
        EXPECT_EQ(blocks_of_copies(plan, 24, length % 2 == 0, random), (std::vector{16, 8})) << length;
    }
}

/// No body of a ring differs from the one across.
TEST(JointOrder, MayBeginARingAnywhere)
{
    std::mt19937 random(13);
    for (const int length : {2, 4, 8, 16}) {
        Plan plan{length, {}};
        for (int body = 0; body < length; ++body) plan.joints.push_back({body, (body + 1) % length, 0});
        EXPECT_EQ(blocks_of_copies(plan, 24, false, random), (std::vector{16, 8})) << length;
    }
}

}  // namespace
}  // namespace motley
