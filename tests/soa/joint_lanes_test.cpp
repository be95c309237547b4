// What a layout keeps when joints come and go one by one. (That the bits are those of a layout made anew:
// tests/parallel/joint_changes_test.cpp. That every joint has a lane and every colour is valid: recolour_test.cpp.)
#include <gtest/gtest.h>

#include <vector>

#include "lay_out.h"
#include "stores/joint_store.h"

namespace motley {
namespace {

/// 40 chains of three rigid bodies.
struct Chains {
    Scene scene;
    std::vector<BodyId> bodies;
    std::vector<ConstraintId> joints;
    FigureUse use;
    Layout layout{kernel_table(Isa::scalar)};

    explicit Chains(bool exactly = false) : use{.exact = {.all = exactly}}
    {
        for (int i = 0; i < 120; ++i) {
            bodies.push_back(scene.add_body({}));
            if (i % 3 > 0) joints.push_back(add(bodies.size() - 2));
        }
        lay_out();
    }
    ConstraintId add(std::size_t first)
    {
        return scene.add_joint(BallSocketDefinition{bodies[first], bodies[first + 1], {1, 0, 0}, {-1, 0, 0}});
    }
    void lay_out() { testing::lay_out(layout, scene, {}, use); }
    /// The copies in each block of figures.
    [[nodiscard]] std::vector<int> copies() const
    {
        std::vector<int> counts;
        for (const FigureBlock& block : layout.figures.blocks()) counts.push_back(block.count);
        return counts;
    }
    [[nodiscard]] std::size_t blocks_of_chain(std::size_t chain) const
    {
        const BodyRow row = core_of(scene).bodies.row_of(bodies[3 * chain]);
        return static_cast<std::size_t>(layout.figures.copy_of(row).block);
    }
};

TEST(JointLanes, OnlyTheFigureThatLosesAJointLeavesItsBlock)
{
    Chains chains;
    ASSERT_EQ(chains.copies(), (std::vector{16, 16, 8}));
    const std::size_t block = chains.blocks_of_chain(20);
    ASSERT_LT(block, 2U);
    chains.scene.remove_joint(chains.joints[40]);
    chains.lay_out();
    std::vector<int> expected{16, 16, 8};
    --expected[block];
    EXPECT_EQ(chains.copies(), expected);
    // It comes back into the block with the fewest copies.
    chains.joints[40] = chains.add(60);
    chains.lay_out();
    expected.back() = 9;
    EXPECT_EQ(chains.copies(), expected);
    EXPECT_EQ(chains.blocks_of_chain(20), 2U);
}

TEST(JointLanes, ABlockOfTooFewCopiesIsGivenUp)
{
    Chains chains;
    std::size_t in_last = 0;
    while (chains.blocks_of_chain(in_last) != 2) ++in_last;
    chains.scene.remove_joint(chains.joints[2 * in_last]);
    chains.lay_out();
    EXPECT_EQ(chains.copies(), (std::vector{16, 16}));
}

TEST(JointLanes, FiguresThatHaveWaitedLongEnoughGetABlockOfTheirOwn)
{
    Chains chains;
    // Eight lanes are free in the last block; then eight more chains are worth another one.
    for (int added = 0; added < 16; ++added) {
        EXPECT_EQ(chains.copies(), (std::vector{16, 16, std::min(8 + added, 16)}));
        for (int i = 0; i < 3; ++i) chains.bodies.push_back(chains.scene.add_body({}));
        for (int i = 0; i < 2; ++i) chains.add(chains.bodies.size() - 3 + static_cast<std::size_t>(i));
        chains.lay_out();
    }
    EXPECT_EQ(chains.copies(), (std::vector{16, 16, 16, 8}));
}

/// Where joints are solved exactly, a figure that comes finds a lane beside its copies, and one that goes leaves a free one.
TEST(JointLanes, FiguresWithATreeComeAndGoWithoutANewLayout)
{
    Chains chains(true);
    ASSERT_EQ(chains.copies(), (std::vector{16, 16, 8}));
    const std::size_t block = chains.blocks_of_chain(20);
    ASSERT_LT(block, 2U);
    for (int i = 0; i < 3; ++i) chains.scene.remove_body(chains.bodies[60 + static_cast<std::size_t>(i)]);
    chains.lay_out();
    std::vector<int> expected{16, 16, 8};
    --expected[block];
    EXPECT_EQ(chains.copies(), expected);
    for (int i = 0; i < 3; ++i) chains.bodies.push_back(chains.scene.add_body({}));
    for (std::size_t i = 0; i < 2; ++i) chains.add(120 + i);
    chains.lay_out();
    expected.back() = 9;
    EXPECT_EQ(chains.copies(), expected);
    for (const FigureBlock& of_chains : chains.layout.figures.blocks())
        EXPECT_TRUE(of_chains.shape->has_tree());
}

/// The pair that a chain leaves when it loses a joint is of a shape that has had no tree: all is laid out anew. From then on
/// it has a block of its own, which the next pair comes into.
TEST(JointLanes, AFigureOfANewShapeGetsATreeAtOnce)
{
    Chains chains(true);
    const auto copies_of_pairs = [&] {
        int copies = 0;
        for (const FigureBlock& block : chains.layout.figures.blocks())
            if (block.shape->bodies.size() == 2) copies += block.count;
        return copies;
    };
    for (int pairs = 1; pairs <= 3; ++pairs) {
        chains.scene.remove_joint(chains.joints[8 * static_cast<std::size_t>(pairs)]);
        chains.lay_out();
        EXPECT_EQ(copies_of_pairs(), pairs);
        int copies = 0;
        for (const FigureBlock& block : chains.layout.figures.blocks()) {
            EXPECT_TRUE(block.shape->has_tree());
            copies += block.count;
        }
        EXPECT_EQ(copies, 40);
    }
}

/// Several figures are replaced at once. The new ones get the slots and rows of the old ones in another order, and are copies
/// of the rest.
TEST(JointLanes, FiguresThatAreReplacedAtOnceAreCopiesOfTheRest)
{
    Chains chains(true);
    for (int round = 0; round < 10; ++round) {
        std::vector<std::size_t> replaced;
        for (std::size_t i = 0; i < 5; ++i)
            replaced.push_back((7 * static_cast<std::size_t>(round) + 11 * i) % 40);
        for (std::size_t i = 0; i < 3; ++i)
            for (const std::size_t chain : replaced)
                chains.scene.remove_body(chains.bodies[3 * chain + (i + chain) % 3]);
        for (const std::size_t chain : replaced) {
            for (std::size_t i = 0; i < 3; ++i) chains.bodies[3 * chain + i] = chains.scene.add_body({});
            for (std::size_t i = 0; i < 2; ++i) chains.add(3 * chain + i);
        }
        chains.lay_out();
        for (const FigureBlock& block : chains.layout.figures.blocks())
            EXPECT_EQ(block.shape, chains.layout.figures.blocks().front().shape) << round;
    }
}

TEST(JointLanes, AFigureThatSleepsLeavesItsBlockAndComesBackWhenItWakes)
{
    Chains chains;
    SceneCore& scene = core_of(chains.scene);
    const std::size_t block = chains.blocks_of_chain(20);
    ASSERT_LT(block, 2U);
    const auto change = [&](bool falls_asleep) {
        for (std::size_t i = 60; i < 63; ++i) {
            const std::uint32_t slot = chains.bodies[i].slot;
            if (falls_asleep)
                scene.bodies.fall_asleep(slot);
            else
                scene.bodies.wake(slot);
            scene.joints->change_all_on(scene.bodies.first_ends[slot]);
        }
        chains.lay_out();
    };
    change(true);
    std::vector<int> expected{16, 16, 8};
    --expected[block];
    EXPECT_EQ(chains.copies(), expected);
    change(false);
    expected.back() = 9;
    EXPECT_EQ(chains.copies(), expected);
    EXPECT_EQ(chains.blocks_of_chain(20), 2U);
}

TEST(JointLanes, BodiesWithoutJointsAndRemovedOnesKeepNothing)
{
    Chains chains;
    for (int i = 0; i < 3; ++i) chains.scene.remove_body(chains.bodies[60 + static_cast<std::size_t>(i)]);
    chains.lay_out();
    int copies = 0;
    for (const int count : chains.copies()) copies += count;
    EXPECT_EQ(copies, 39);
    EXPECT_EQ(chains.layout.groups.size(), 39);
    std::size_t joints = 0;
    for (const Placement& placement : chains.layout.joint_placements()) joints += placement.is_gap() ? 0 : 1;
    EXPECT_EQ(joints, 78U);
}

}  // namespace
}  // namespace motley
