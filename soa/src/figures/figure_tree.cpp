// The order in which the bodies and locks of a figure are eliminated.
#include <algorithm>
#include <utility>

#include "figures/figure.h"
#include "stores/array.h"

namespace motley {
namespace {

constexpr int most_rows = 6;           ///< of the locks between a child body and its parent
constexpr int most_closure_rows = 24;  ///< their system is dense, and each row costs a sweep of the tree

std::size_t at(int index)
{
    return static_cast<std::size_t>(index);
}

/// Builds the tree of a shape: first the parent of each body, then the locks that close loops, then where the arrays
/// of each node begin.
class TreeBuilder {
  public:
    TreeBuilder(FigureShape& shape, RotorsBesideTree rotors)
        : shape_(shape),
          rotors_(rotors),
          locks_on_(shape.bodies.size()),
          actives_on_(shape.bodies.size()),
          node_of_(shape.bodies.size(), none),
          is_in_node_(shape.joints.size(), 0)
    {
    }
    bool build()
    {
        list_locks();
        hang_all_bodies();
        find_closures();
        find_point_trees();
        if (closure_rows_ > most_closure_rows || nodes_.empty()) return false;
        if (rotors_ == RotorsBesideTree::refused && has_rotor_beside()) return false;
        lay_out();
        hand_over();
        list_joints_at_points();
        return true;
    }

  private:
    static constexpr int none = -1;
    FigureShape& shape_;
    RotorsBesideTree rotors_;
    Array<Array<int>> locks_on_;      ///< joints, by body
    Array<Array<int>> actives_on_;    ///< likewise, limits and motors
    Array<int> node_of_;              ///< by body
    Array<std::uint8_t> is_in_node_;  ///< by joint
    Array<FigureNode> nodes_;         ///< parents before children
    std::size_t spread_ = 0;          ///< nodes whose neighbours all have a node
    Array<FigureClosure> closures_;
    int closure_rows_ = 0;

    [[nodiscard]] bool moves(int body) const { return shape_.bodies[at(body)] == BodyKind::rigid; }
    [[nodiscard]] bool hangs(int body) const { return node_of_[at(body)] != none; }
    [[nodiscard]] int other_end(int joint, int body) const
    {
        const FigureShape::Joint& j = shape_.joints[at(joint)];
        return j.a == body ? j.b : j.a;
    }

    void list_locks()
    {
        for (std::size_t i = 0; i < shape_.joints.size(); ++i) {
            const FigureShape::Joint& joint = shape_.joints[i];
            if (joint.equalities == 0 && joint.active_row == ActiveRow::none) continue;
            Array<Array<int>>& on = joint.equalities > 0 ? locks_on_ : actives_on_;
            on[at(joint.a)].push_back(static_cast<int>(i));
            on[at(joint.b)].push_back(static_cast<int>(i));
        }
    }
    /// A search along the locks: a body becomes a child of the body from which it was reached. It starts from fixed
    /// bodies, then from one body of each set without a fixed body.
    void hang_all_bodies()
    {
        const int bodies = static_cast<int>(shape_.bodies.size());
        for (int body = 0; body < bodies; ++body) {
            if (moves(body)) continue;
            for (const int joint : locks_on_[at(body)]) {
                const int next = other_end(joint, body);
                if (!hangs(next)) hang(next, body);
                spread();
            }
        }
        for (int body = 0; body < bodies; ++body) {
            if (!moves(body) || hangs(body) || locks_on_[at(body)].empty()) continue;
            hang(body, none);
            spread();
        }
    }
    void spread()
    {
        for (; spread_ < nodes_.size(); ++spread_) {
            const int body = nodes_[spread_].body;
            for (const int joint : locks_on_[at(body)]) {
                const int next = other_end(joint, body);
                if (moves(next) && !hangs(next)) hang(next, body);
            }
        }
    }
    /// Makes a node of all locks between the two bodies, and of their limits and motors, up to six rows. Rotors come first.
    void hang(int body, int parent)
    {
        FigureNode node{};
        node.body = body;
        node.parent = parent;
        node.parent_node = parent == none ? none : node_of_[at(parent)];
        for (const int joint : locks_on_[at(body)]) {
            const FigureShape::Joint& j = shape_.joints[at(joint)];
            if (other_end(joint, body) != parent || node.rows + j.equalities > most_rows) continue;
            is_in_node_[at(joint)] = 1;
            node.locks.push_back({joint, node.rows, j.equalities, j.locks_point, j.a == body});
            node.rows += j.equalities;
        }
        node.most_rows = node.rows;
        for (const bool has_rotor : {true, false}) {
            for (const int joint : actives_on_[at(body)]) {
                const FigureShape::Joint& j = shape_.joints[at(joint)];
                if (j.has_rotor != has_rotor || other_end(joint, body) != parent || node.rows == 0 ||
                    node.most_rows == most_rows ||
                    (node.hangs_by_point() && j.active_row == ActiveRow::linear))
                    continue;
                is_in_node_[at(joint)] = 1;
                node.actives.push_back({joint, j.a == body, has_rotor});
                shape_.has_actives = true;
                shape_.has_rotors = shape_.has_rotors || has_rotor;
                ++node.most_rows;
            }
        }
        node_of_[at(body)] = static_cast<int>(nodes_.size());
        nodes_.push_back(std::move(node));
    }
    [[nodiscard]] bool has_rotor_beside() const
    {
        for (std::size_t i = 0; i < shape_.joints.size(); ++i)
            if (shape_.joints[i].has_rotor && is_in_node_[i] == 0) return true;
        return false;
    }
    void find_closures()
    {
        for (std::size_t i = 0; i < shape_.joints.size(); ++i) {
            const int equalities = shape_.joints[i].equalities;
            if (equalities == 0 || is_in_node_[i] != 0) continue;
            closures_.push_back({static_cast<int>(i), closure_rows_, equalities});
            closure_rows_ += equalities;
        }
    }
    /// The other nodes of a tree follow its root.
    void find_point_trees()
    {
        const int count = static_cast<int>(nodes_.size());
        const auto is_root = [&](int node) { return nodes_[at(node)].parent_node == none; };
        for (int root = 0, end = 1; root < count; root = end++) {
            while (end < count && !is_root(end)) ++end;
            const bool are_held_at_points = std::all_of(
                nodes_.begin() + root, nodes_.begin() + end,
                [](const FigureNode& node) { return node.parent == none || node.point_lock() != nullptr; });
            if (!are_held_at_points) continue;
            for (int node = root; node < end; ++node)
                nodes_[at(node)].point_tree = static_cast<int>(shape_.point_trees.size());
            // hand_over() turns the order round.
            shape_.point_trees.push_back({count - end, count - root, 0});
        }
    }
    /// Decides where the arrays of nodes and closures begin in FigureBlock::system.
    void lay_out()
    {
        std::int64_t end = 0;
        const auto take = [&](int floats) {
            return std::exchange(end, end + std::int64_t{floats} * block_lanes);
        };
        constexpr int row_floats = FigureNode::row_floats / block_lanes;
        for (FigureNode& node : nodes_) {
            node.jacobian = take(row_floats * node.most_rows);
            node.response = take(6 * node.most_rows);
            node.factor = take(node.most_rows * (node.most_rows + 1) / 2);
            node.target = take(node.most_rows);
            node.give = node.spring_give = take(node.most_rows);
            if (shape_.has_rotors) {
                node.spring_give = take(node.most_rows);
                node.rotor = take(node.most_rows);
            }
            node.tension = take(node.rows);
            if (shape_.has_actives) {
                node.taken = take(6);
                node.given = take(node.most_rows);
                node.speed = take(node.most_rows);
                node.least = take(node.most_rows);
                node.most = take(node.most_rows);
            }
            node.in_use = take(1);
            node.acts_by = take(static_cast<int>(node.actives.size()));
            node.change = node.pivots = take(6);
            node.mass = node.mass_factor = take(21);
            node.force = node.strain = take(6);
            node.kept = take(6);
            node.pull = take(3);
            if (node.point_tree != none) node.place = take(3);
        }
        for (PointTree& tree : shape_.point_trees) tree.rigid = take(PointTree::floats);
        shape_.exceeding = take(1);
        shape_.closure_jacobian = take(row_floats * closure_rows_);
        shape_.closure_factor = take(closure_rows_ * (closure_rows_ + 1) / 2);
        shape_.closure_target = shape_.closure_alone = take(closure_rows_);
        shape_.system_floats = end;
    }
    /// Moves the result into the shape, children before parents.
    void hand_over()
    {
        const int count = static_cast<int>(nodes_.size());
        for (FigureNode& node : nodes_) {
            if (node.parent_node != none) node.parent_node = count - 1 - node.parent_node;
        }
        for (FigureShape::Joint& joint : shape_.joints) joint.in_tree = joint.equalities > 0;
        shape_.nodes.assign(std::make_move_iterator(nodes_.rbegin()), std::make_move_iterator(nodes_.rend()));
        shape_.closures = std::move(closures_);
        shape_.closure_rows = closure_rows_;
    }
    void list_joints_at_points()
    {
        for (const FigureNode& node : shape_.nodes) {
            if (!node.hangs_by_point()) continue;
            for (std::size_t i = 0; i < shape_.joints.size(); ++i) {
                const FigureShape::Joint& joint = shape_.joints[i];
                if (joint.in_tree) continue;
                const int index = static_cast<int>(i);
                if (joint.a == node.parent && joint.b == node.body)
                    shape_.joints_at_points.push_back({index, node.arm_of_parent(), node.arm_of_child()});
                if (joint.a == node.body && joint.b == node.parent)
                    shape_.joints_at_points.push_back({index, node.arm_of_child(), node.arm_of_parent()});
            }
        }
    }
};

}  // namespace

bool build_tree(FigureShape& shape, RotorsBesideTree rotors)
{
    return TreeBuilder(shape, rotors).build();
}

std::int64_t spare_loops_of(const FigureShape& shape)
{
    Array<std::pair<int, int>> pairs;
    for (const FigureShape::Joint& joint : shape.joints)
        if (joint.equalities > 0) pairs.push_back(std::minmax(joint.a, joint.b));
    std::sort(pairs.begin(), pairs.end());
    const auto end = std::unique(pairs.begin(), pairs.end());
    // A node takes all locks between one pair of bodies, and there are no more nodes than moving bodies. Every other pair has
    // a row of a closure or more.
    return (end - pairs.begin()) - std::count(shape.bodies.begin(), shape.bodies.end(), BodyKind::rigid) -
           most_closure_rows;
}

}  // namespace motley
