// The order in which the bodies and locks of a figure are eliminated.
#include <utility>

#include "figure.h"

namespace motley {
namespace {

constexpr int most_rows = 6;           ///< that a body can hang by
constexpr int most_closure_rows = 24;  ///< their system is dense, and each row costs a sweep of the tree

}  // namespace

bool FigureShape::plant_tree()
{
    const auto moves = [&](int body) { return bodies[static_cast<std::size_t>(body)] == BodyKind::rigid; };
    std::vector<std::vector<int>> locks_on(bodies.size());
    std::vector<std::uint8_t> hangs(joints.size(), 0);  // is part of the tree
    for (std::size_t i = 0; i < joints.size(); ++i) {
        if (joints[i].equalities == 0) continue;
        locks_on[static_cast<std::size_t>(joints[i].a)].push_back(static_cast<int>(i));
        locks_on[static_cast<std::size_t>(joints[i].b)].push_back(static_cast<int>(i));
    }
    const auto other_end = [&](int joint, int body) {
        const Joint& j = joints[static_cast<std::size_t>(joint)];
        return j.a == body ? j.b : j.a;
    };

    // What is reached hangs on what it was reached from: from fixed bodies first, then from some body of what floats.
    std::vector<FigureNode> reached;
    std::vector<int> node_of(bodies.size(), -1);
    const auto hang = [&](int body, int parent) {
        FigureNode node{};
        node.body = body;
        node.parent = parent;
        node.parent_node = parent < 0 ? -1 : node_of[static_cast<std::size_t>(parent)];
        for (const int joint : locks_on[static_cast<std::size_t>(body)]) {
            const Joint& j = joints[static_cast<std::size_t>(joint)];
            if (other_end(joint, body) != parent || node.rows + j.equalities > most_rows) continue;
            hangs[static_cast<std::size_t>(joint)] = 1;
            node.locks.push_back({joint, node.rows, j.equalities, j.locks_point, j.a == body});
            node.rows += j.equalities;
        }
        node_of[static_cast<std::size_t>(body)] = static_cast<int>(reached.size());
        reached.push_back(std::move(node));
    };
    std::size_t spread = 0;
    const auto grow = [&] {
        for (; spread < reached.size(); ++spread) {
            const int body = reached[spread].body;
            for (const int joint : locks_on[static_cast<std::size_t>(body)]) {
                const int next = other_end(joint, body);
                if (moves(next) && node_of[static_cast<std::size_t>(next)] < 0) hang(next, body);
            }
        }
    };
    for (int body = 0; body < static_cast<int>(bodies.size()); ++body) {
        if (moves(body)) continue;
        for (const int joint : locks_on[static_cast<std::size_t>(body)]) {
            const int next = other_end(joint, body);
            if (node_of[static_cast<std::size_t>(next)] < 0) hang(next, body);
            grow();
        }
    }
    for (int body = 0; body < static_cast<int>(bodies.size()); ++body) {
        if (!moves(body) || node_of[static_cast<std::size_t>(body)] >= 0 ||
            locks_on[static_cast<std::size_t>(body)].empty())
            continue;
        hang(body, -1);
        grow();
    }
    std::vector<FigureClosure> loops;
    int loop_rows = 0;
    for (std::size_t i = 0; i < joints.size(); ++i) {
        if (joints[i].equalities == 0 || hangs[i] != 0) continue;
        loops.push_back({static_cast<int>(i), loop_rows, joints[i].equalities});
        loop_rows += joints[i].equalities;
    }
    if (loop_rows > most_closure_rows || reached.empty()) return false;

    const int count = static_cast<int>(reached.size());
    std::int64_t end = 0;
    const auto take = [&](int floats) {
        return std::exchange(end, end + std::int64_t{floats} * block_lanes);
    };
    for (FigureNode& node : reached) {
        node.jacobian = take(FigureNode::row_floats / block_lanes * node.rows);
        node.response = take(6 * node.rows);
        node.factor = take(node.rows * (node.rows + 1) / 2);
        node.target = take(node.rows);
        node.change = take(6);
        node.mass = take(21);
        node.force = take(6);
        node.kept = take(6);
        node.pull = take(3);
        if (node.parent_node >= 0) node.parent_node = count - 1 - node.parent_node;
    }
    for (Joint& joint : joints) joint.in_tree = joint.equalities > 0;
    closures = std::move(loops);
    closure_rows = loop_rows;
    closure_jacobian = take(FigureNode::row_floats / block_lanes * loop_rows);
    closure_factor = take(loop_rows * (loop_rows + 1) / 2);
    closure_target = take(loop_rows);
    system_floats = end;
    nodes.assign(std::make_move_iterator(reached.rbegin()), std::make_move_iterator(reached.rend()));
    return true;
}

}  // namespace motley
