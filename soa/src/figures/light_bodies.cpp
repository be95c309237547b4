// See light_bodies.h.
#include "figures/light_bodies.h"

#include <algorithm>
#include <limits>

#include "figures/members.h"
#include "stores/array.h"

namespace motley {
namespace {

/// The moving bodies that locks hold, numbered in the order in which the joints name them.
class LockedBodies {
  public:
    explicit LockedBodies(std::span<const JointCandidate* const> joints)
    {
        for (const JointCandidate* joint : joints) {
            if (joint->equalities == 0) continue;
            for (const BodyRow body : {joint->placement.a, joint->placement.b})
                if (is_rigid(body)) rows_.push_back(body.row());
        }
        std::sort(rows_.begin(), rows_.end());
        rows_.erase(std::unique(rows_.begin(), rows_.end()), rows_.end());
        numbers_.assign(rows_.size(), none);
    }
    [[nodiscard]] std::size_t size() const { return rows_.size(); }
    [[nodiscard]] std::size_t number_of(BodyRow body)
    {
        std::size_t& number = numbers_[static_cast<std::size_t>(
            std::lower_bound(rows_.begin(), rows_.end(), body.row()) - rows_.begin())];
        if (number == none) number = next_++;
        return number;
    }

  private:
    static constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
    Array<std::uint32_t> rows_;  ///< sorted
    Array<std::size_t> numbers_;
    std::size_t next_ = 0;
};

float inverse_mass_of(BodyRow body, const BodyStore& bodies)
{
    return bodies.rigid_mass_of(body).inverse_mass;
}

}  // namespace

BodyId light_between_heavy(std::span<const JointCandidate* const> joints, const BodyStore& bodies)
{
    constexpr double most_mass_ratio = 1e6;
    LockedBodies locked(joints);
    Array<int> locks_on(locked.size(), 0);
    double of_heaviest = std::numeric_limits<double>::infinity();
    for (const JointCandidate* joint : joints) {
        if (joint->equalities == 0) continue;
        for (const BodyRow body : {joint->placement.a, joint->placement.b}) {
            if (!is_rigid(body)) return {};
            ++locks_on[locked.number_of(body)];
            of_heaviest = std::min(of_heaviest, double{inverse_mass_of(body, bodies)});
        }
    }
    for (const JointCandidate* joint : joints) {
        if (joint->equalities == 0) continue;
        for (const BodyRow body : {joint->placement.a, joint->placement.b}) {
            if (locks_on[locked.number_of(body)] > 1 &&
                double{inverse_mass_of(body, bodies)} > most_mass_ratio * of_heaviest)
                return bodies.id_of_slot(bodies.rows(BodyKind::rigid).slot[body.row()]);
        }
    }
    return {};
}

namespace {

/// What is behind a lock.
struct Behind {
    double heaviest = 0;  ///< kg
    bool is_held = false;
    void see(const Behind& more)
    {
        heaviest = std::max(heaviest, more.heaviest);
        is_held = is_held || more.is_held;
    }
};

/// The moving bodies of a figure, as a tree: of the locks that close loops nothing is kept.
struct LoadTree {
    static constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
    struct Node {
        double mass = 0;
        bool is_held = false;  ///< a lock connects it to a fixed body
        std::size_t parent = none;
        Array<std::size_t> neighbours;  ///< bodies that locks connect it to
        Array<std::size_t> children;    ///< those of them whose parent it is
        Behind below;                   ///< its children's side of the lock to its parent, with itself
        Behind above;                   ///< its parent's side of that lock
    };
    Array<Node> nodes;
    Array<std::size_t> order;  ///< parents before children

    LoadTree(std::span<const JointCandidate* const> joints, const BodyStore& bodies)
    {
        LockedBodies locked(joints);
        nodes.resize(locked.size());
        const auto node_of = [&](BodyRow body) {
            const std::size_t node = locked.number_of(body);
            nodes[node].mass = 1 / double{inverse_mass_of(body, bodies)};
            return node;
        };
        for (const JointCandidate* joint : joints) {
            if (joint->equalities == 0) continue;
            const BodyRow a = joint->placement.a, b = joint->placement.b;
            if (is_rigid(a) && is_rigid(b)) {
                const std::size_t node_a = node_of(a), node_b = node_of(b);
                nodes[node_a].neighbours.push_back(node_b);
                nodes[node_b].neighbours.push_back(node_a);
            } else {
                nodes[node_of(is_rigid(a) ? a : b)].is_held = true;
            }
        }
        Array<std::uint8_t> is_found(nodes.size(), 0);
        for (std::size_t root = 0; root < nodes.size(); ++root) {
            if (is_found[root] != 0) continue;
            is_found[root] = 1;
            order.push_back(root);
            for (std::size_t next = order.size() - 1; next < order.size(); ++next) {
                const std::size_t node = order[next];
                for (const std::size_t other : nodes[node].neighbours) {
                    if (is_found[other] != 0) continue;
                    is_found[other] = 1;
                    nodes[other].parent = node;
                    nodes[node].children.push_back(other);
                    order.push_back(other);
                }
            }
        }
    }

    /// Finds what is below and above each node.
    void look_behind()
    {
        for (std::size_t i = order.size(); i-- > 0;) {
            Node& node = nodes[order[i]];
            node.below.see({node.mass, node.is_held});
            if (node.parent != none) nodes[node.parent].below.see(node.below);
        }
        for (const std::size_t at : order) {
            const Node& node = nodes[at];
            // Of the first child all that is not below it comes after it, and of the last one before it.
            Behind before = node.above;
            before.see({node.mass, node.is_held});
            for (const std::size_t child : node.children) {
                nodes[child].above = before;
                before.see(nodes[child].below);
            }
            Behind after;
            for (std::size_t i = node.children.size(); i-- > 0;) {
                Node& child = nodes[node.children[i]];
                child.above.see(after);
                after.see(child.below);
            }
        }
    }

    [[nodiscard]] bool bears_heavy_load(const Node& node, double ratio) const
    {
        int loads = 0, supports = node.is_held ? 1 : 0;  // a load supports another one
        const auto count = [&](const Behind& side) {
            const bool is_load = side.heaviest > ratio * node.mass;
            loads += is_load ? 1 : 0;
            supports += is_load || side.is_held ? 1 : 0;
        };
        if (node.parent != none) count(node.above);
        for (const std::size_t child : node.children) count(nodes[child].below);
        return loads > 0 && supports > 1;
    }
};

}  // namespace

bool turns_heavy_rotor(std::span<const JointCandidate* const> joints, float ratio)
{
    return std::any_of(joints.begin(), joints.end(),
                       [&](const JointCandidate* joint) { return joint->rotor_load > ratio; });
}

bool bears_heavy_load(std::span<const JointCandidate* const> joints, const BodyStore& bodies, float ratio)
{
    // In most figures no body is that much heavier than any other.
    MassSpan span;
    for (const JointCandidate* joint : joints) {
        for (const BodyRow body : {joint->placement.a, joint->placement.b})
            if (is_rigid(body)) span.note(inverse_mass_of(body, bodies));
    }
    if (!span.is_wider_than(ratio)) return false;
    LoadTree tree(joints, bodies);
    tree.look_behind();
    return std::any_of(tree.nodes.begin(), tree.nodes.end(), [&](const LoadTree::Node& node) {
        return tree.bears_heavy_load(node, double{ratio});
    });
}

}  // namespace motley
