// Figures found in random sets of joints, and trees built for random figures. Independent evidence: properties that
// every elimination order must have, counted over the result.
#include "figures/figures.h"

#include <gtest/gtest.h>

#include <set>

#include "mixed_scene.h"

namespace motley {
namespace {

using testing::Random;

/// A figure of up to ten bodies, some of them fixed, with up to fourteen joints that lock none to six rows.
FigureShape random_shape(Random& random)
{
    FigureShape shape;
    const int bodies = 2 + random.below(9);
    for (int i = 0; i < bodies; ++i)
        shape.bodies.push_back(random.below(4) == 0 ? BodyKind::fixed : BodyKind::rigid);
    shape.bodies.front() = BodyKind::rigid;
    const int joints = 1 + random.below(14);
    for (int i = 0; i < joints; ++i) {
        FigureShape::Joint joint{};
        joint.a = random.below(bodies);
        joint.b = random.below(bodies);
        joint.kind_a = shape.bodies[static_cast<std::size_t>(joint.a)];
        joint.kind_b = shape.bodies[static_cast<std::size_t>(joint.b)];
        const bool moves = joint.kind_a == BodyKind::rigid || joint.kind_b == BodyKind::rigid;
        if (joint.a == joint.b || !moves) continue;
        joint.equalities = random.below(7);
        joint.locks_point = joint.equalities >= 3;
        shape.joints.push_back(joint);
    }
    return shape;
}

TEST(FigureTree, EveryLockIsInTheTreeOrClosesALoopOnce)
{
    Random random(11);
    int planted = 0, looped = 0;
    for (int trial = 0; trial < 5000; ++trial) {
        FigureShape shape = random_shape(random);
        const FigureShape bare = shape;
        if (!build_tree(shape, RotorsBesideTree::allowed)) {
            EXPECT_TRUE(shape.nodes.empty());
            EXPECT_TRUE(shape.closures.empty());
            for (const auto& joint : shape.joints) EXPECT_FALSE(joint.in_tree);
            continue;
        }
        ++planted;
        std::vector<int> seen(shape.joints.size(), 0);
        std::set<int> hanging;
        for (std::size_t n = 0; n < shape.nodes.size(); ++n) {
            const FigureNode& node = shape.nodes[n];
            EXPECT_EQ(shape.bodies[static_cast<std::size_t>(node.body)], BodyKind::rigid);
            EXPECT_TRUE(hanging.insert(node.body).second) << "a body hangs once";
            int rows = 0;
            for (const FigureNode::Lock& lock : node.locks) {
                const FigureShape::Joint& joint = shape.joints[static_cast<std::size_t>(lock.joint)];
                ++seen[static_cast<std::size_t>(lock.joint)];
                EXPECT_EQ(lock.first_row, rows);
                EXPECT_EQ(lock.rows, joint.equalities);
                rows += lock.rows;
                EXPECT_EQ(lock.reversed ? joint.a : joint.b, node.body);
                EXPECT_EQ(lock.reversed ? joint.b : joint.a, node.parent);
            }
            EXPECT_EQ(rows, node.rows);
            EXPECT_LE(rows, 6);
            if (node.parent_node >= 0) {
                EXPECT_GT(static_cast<std::size_t>(node.parent_node), n) << "what hangs is eliminated first";
                EXPECT_EQ(shape.nodes[static_cast<std::size_t>(node.parent_node)].body, node.parent);
            } else if (node.parent >= 0) {
                EXPECT_EQ(shape.bodies[static_cast<std::size_t>(node.parent)], BodyKind::fixed);
            } else {
                EXPECT_EQ(node.rows, 0) << "a root that floats hangs on nothing";
            }
        }
        int closure_rows = 0;
        for (const FigureClosure& closure : shape.closures) {
            ++seen[static_cast<std::size_t>(closure.joint)];
            EXPECT_EQ(closure.first_row, closure_rows);
            closure_rows += closure.rows;
        }
        looped += closure_rows > 0 ? 1 : 0;
        EXPECT_EQ(closure_rows, shape.closure_rows);
        for (std::size_t i = 0; i < shape.joints.size(); ++i) {
            EXPECT_EQ(seen[i], shape.joints[i].equalities > 0 ? 1 : 0);
            EXPECT_EQ(shape.joints[i].in_tree, shape.joints[i].equalities > 0);
        }
        EXPECT_EQ(bare.joints.size(), shape.joints.size());
    }
    EXPECT_GT(planted, 3000);
    EXPECT_GT(looped, 500);
}

TEST(FigureTree, NumbersOfNodesDoNotOverlap)
{
    Random random(12);
    int with_actives = 0, with_rotors = 0;
    for (int trial = 0; trial < 500; ++trial) {
        FigureShape shape = random_shape(random);
        // In every second figure joints without locks have limits or rotors.
        for (FigureShape::Joint& joint : shape.joints) {
            if (joint.equalities > 0 || trial % 2 == 0) continue;
            joint.active_row = ActiveRow::angular;
            joint.has_rotor = random.below(2) == 0;
        }
        if (!build_tree(shape, RotorsBesideTree::allowed)) continue;
        std::vector<std::pair<std::int64_t, std::int64_t>> parts;
        const auto add = [&](std::int64_t begin, std::int64_t floats) {
            if (floats > 0) parts.emplace_back(begin, begin + floats * block_lanes);
        };
        for (const FigureNode& node : shape.nodes) {
            const int rows = node.most_rows;
            add(node.jacobian, FigureNode::row_floats / block_lanes * rows);
            add(node.response, 6 * rows);
            add(node.factor, rows * (rows + 1) / 2);
            for (const std::int64_t a_row_each : {node.target, node.give}) add(a_row_each, rows);
            add(node.in_use, 1);
            add(node.acts_by, static_cast<std::int64_t>(node.actives.size()));
            add(node.tension, node.rows);
            if (shape.has_actives) {
                add(node.taken, 6);
                for (const std::int64_t a_row_each : {node.given, node.speed, node.least, node.most})
                    add(a_row_each, rows);
            }
            if (shape.has_rotors)
                for (const std::int64_t a_row_each : {node.spring_give, node.rotor}) add(a_row_each, rows);
            add(node.change, 6);
            add(node.mass, 21);
            add(node.force, 6);
            add(node.kept, 6);
            add(node.pull, 3);
            if (node.point_tree >= 0) add(node.place, 3);
        }
        for (const PointTree& tree : shape.point_trees) add(tree.rigid, PointTree::floats);
        add(shape.exceeding, 1);
        with_actives += shape.has_actives ? 1 : 0;
        with_rotors += shape.has_rotors ? 1 : 0;
        add(shape.closure_jacobian, FigureNode::row_floats / block_lanes * shape.closure_rows);
        add(shape.closure_factor, shape.closure_rows * (shape.closure_rows + 1) / 2);
        add(shape.closure_target, shape.closure_rows);
        std::sort(parts.begin(), parts.end());
        for (std::size_t i = 0; i + 1 < parts.size(); ++i) ASSERT_LE(parts[i].second, parts[i + 1].first);
        ASSERT_LE(parts.back().second, shape.system_floats);
    }
    EXPECT_GT(with_actives, 50);
    EXPECT_GT(with_rotors, 20);
}

TEST(FigureTree, PointTreesAreTheTreesWhoseBodiesHangByPoints)
{
    Random random(13);
    int with_loose_node = 0, point_trees = 0;
    for (int trial = 0; trial < 2000; ++trial) {
        FigureShape shape = random_shape(random);
        if (!build_tree(shape, RotorsBesideTree::allowed)) continue;
        const auto root_of = [&](std::size_t node) {
            while (shape.nodes[node].parent_node >= 0)
                node = static_cast<std::size_t>(shape.nodes[node].parent_node);
            return node;
        };
        for (std::size_t i = 0; i < shape.nodes.size(); ++i) {
            bool hang_by_points = true;
            for (std::size_t other = 0; other < shape.nodes.size(); ++other) {
                const FigureNode& node = shape.nodes[other];
                if (root_of(other) == root_of(i) && node.parent >= 0 &&
                    std::none_of(node.locks.begin(), node.locks.end(),
                                 [](const auto& lock) { return lock.locks_point; }))
                    hang_by_points = false;
            }
            const int number = shape.nodes[i].point_tree;
            ASSERT_EQ(number >= 0, hang_by_points);
            with_loose_node += hang_by_points ? 0 : 1;
            if (number < 0) continue;
            const PointTree& tree = shape.point_trees[static_cast<std::size_t>(number)];
            EXPECT_EQ(static_cast<std::size_t>(tree.end - 1), root_of(i));
            EXPECT_GE(static_cast<int>(i), tree.begin);
            EXPECT_LT(static_cast<int>(i), tree.end);
        }
        for (const PointTree& tree : shape.point_trees) point_trees += tree.end - tree.begin > 1 ? 1 : 0;
    }
    EXPECT_GT(with_loose_node, 500);
    EXPECT_GT(point_trees, 100);
}

/// Joints between random bodies of a few components, coloured in their order.
std::vector<JointCandidate> random_heap(Random& random, std::uint32_t rows)
{
    const int ball = contact_type_count;  // the first joint type: a ball-socket
    std::vector<JointCandidate> joints;
    std::vector<std::uint32_t> colours(rows, 0);
    const auto add = [&](BodyRow a, BodyRow b) {
        std::uint32_t taken = 0;
        for (const BodyRow body : {a, b}) taken |= body.kind() == BodyKind::rigid ? colours[body.row()] : 0;
        std::uint8_t colour = 0;
        while ((taken >> colour & 1U) != 0) ++colour;
        for (const BodyRow body : {a, b})
            if (body.kind() == BodyKind::rigid) colours[body.row()] |= 1U << colour;
        joints.push_back(
            {{a, b, static_cast<std::int32_t>(joints.size()), static_cast<std::uint8_t>(ball), colour},
             3,
             true});
    };
    const BodyRow ground(BodyKind::fixed, 1);
    for (std::uint32_t first = 1; first + 3 < rows; first += 3) {
        add(ground, {BodyKind::rigid, first});
        add({BodyKind::rigid, first}, {BodyKind::rigid, first + 1});
        // Most components are alike; some have no third body, and some have a loop.
        const int kind = random.below(6);
        if (kind > 0) add({BodyKind::rigid, first + 1}, {BodyKind::rigid, first + 2});
        if (kind == 1) add({BodyKind::rigid, first + 2}, {BodyKind::rigid, first});
    }
    return joints;
}

TEST(Figures, EveryJointIsPlacedOnceAndEveryLaneIsItsOwnCopys)
{
    const KernelTable& kernels = kernel_table(Isa::scalar);
    for (int trial = 0; trial < 20; ++trial) {
        Random random(static_cast<std::uint64_t>(100 + trial));
        const std::uint32_t rows = 30 + static_cast<std::uint32_t>(random.below(400));
        const std::vector<JointCandidate> joints = random_heap(random, rows);
        BodyStore bodies;
        while (bodies.rows(BodyKind::rigid).size() < rows) bodies.add({});
        bodies.add({.motion = BodyMotion::static_body});  // the ground
        BodySets sets;
        sets.reset([&](BodyKind kind) { return bodies.rows(kind).size(); });
        for (const JointCandidate& joint : joints) sets.tie(joint.placement.a, joint.placement.b);
        sets.flatten();
        for (const bool exact : {false, true}) {
            Figures figures;
            Array<Placement> placed;
            figures.find(joints, sets, bodies, kernels, {.all = exact}, placed);
            std::vector<int> seen(joints.size(), 0);
            for (const Placement& placement : placed) {
                if (!placement.is_gap()) ++seen[static_cast<std::size_t>(placement.constraint)];
            }
            for (const int count : seen) EXPECT_EQ(count, 1);
            std::set<std::int32_t> taken;
            for (const FigureBlock& block : figures.blocks()) {
                EXPECT_LE(block.count, block_lanes);
                EXPECT_GE(block.count, exact ? 1 : 8);
                for (std::size_t body = 0; body < block.shape->bodies.size(); ++body) {
                    for (int lane = 0; lane < block_lanes; ++lane) {
                        const std::int32_t offset =
                            block.offsets[body * block_lanes + static_cast<std::size_t>(lane)];
                        if (lane >= block.count) {
                            EXPECT_EQ(offset, 0);
                        } else if (block.shape->bodies[body] == BodyKind::rigid) {
                            EXPECT_TRUE(taken.insert(offset).second) << "a body is in one lane";
                        }
                    }
                }
            }
            // Figures come first, in whole blocks.
            std::size_t lanes = 0;
            for (const FigureBlock& block : figures.blocks())
                lanes += block.shape->joints.size() * block_lanes;
            for (std::size_t i = 0; i < lanes; i += block_lanes) {
                EXPECT_FALSE(placed[i].is_gap());
                for (std::size_t k = 1; k < block_lanes; ++k)
                    EXPECT_EQ(placed[i + k].colour, placed[i].colour);
            }
        }
    }
}

}  // namespace
}  // namespace motley
