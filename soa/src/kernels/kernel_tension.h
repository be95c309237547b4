// Tension that grows within a substep, as when a slack chain comes taut. Included inside an anonymous namespace, after kernel_trees.h.
//
// Locks are stiffened by the tension of the last substep. Where a heavy body suddenly pulls at light ones, that is much too little, and
// the substep throws them. So the tree is first solved on trial; where that finds much more tension, it is factored again with it.
// (Not beside limits, motors and springs: see may_come_taut() in figures/figure_step.cpp.)
#pragma once

/// A pull may be this many times as stiff as it was taken for before the tree is factored again.
constexpr float most_growth = 1.25F;

/// Calls work(node, lock, lever arms, tension before, tension found by the trial) for each lock of a node that holds a point on a
/// point, with the signs of the node. `substep` is its length, s.
template <class Work>
void for_each_tried_lock(const FigureBlock& figure, const FigureNode& node, float substep, int lane,
                         const Work& work)
{
    const float* system = figure.system + lane;
    for (const FigureNode::Lock& lock : node.locks) {
        if (!lock.locks_point) continue;
        const PointArms arms = node.hangs_by_point()
                                   ? PointArms{load_row<Vec3<Lanes>>(system + node.arm_of_child()),
                                               load_row<Vec3<Lanes>>(system + node.arm_of_parent())}
                                   : arms_of(figure, node, lock, lane);
        const auto impulse = load_row<Vec3<Lanes>>(system + node.target + lock.first_row * block_lanes);
        work(lock, arms, tension_of(figure, node, lock, lane), Lanes(substep) * impulse);
    }
}

/// Finds the copies in which tension grows too much (FigureShape::exceeding), and gives their locks the tension that they have now.
inline void follow_tension(const FigureBlock& figure, float substep, float rate, int lane)
{
    const FigureShape& shape = *figure.shape;
    float* system = figure.system + lane;
    float* exceeding = system + shape.exceeding;
    store_lanes(Lanes(0), exceeding);
    Lanes uneven(0);
    for (const PointTree& tree : shape.point_trees)
        uneven = maximum(uneven, load_row<RigidTree>(rigid_tree(figure, tree, lane)).uneven);
    if (!any(uneven > Lanes(0))) return;
    sweep_tree(figure, rate, TreeSweep::tries, lane);
    Lanes growth(0);
    for (const FigureNode& node : shape.nodes) {
        const Mover child = body_of(figure, node, lane);
        const bool has_parent = node.parent_node >= 0;
        const Mover parent = has_parent ? body_of(figure, node_of(figure, node.parent_node), lane) : child;
        for_each_tried_lock(figure, node, substep, lane,
                            [&](const FigureNode::Lock&, const PointArms& arms, const Vec3<Lanes>& before,
                                const Vec3<Lanes>& now) {
                                const auto note = [&](const Mover& body, const Vec3<Lanes>& arm,
                                                      const Vec3<Lanes>& was, const Vec3<Lanes>& is) {
                                    const Lanes borne = Lanes(most_growth) * excess_of(body, arm, was);
                                    growth = maximum(growth, excess_of(body, arm, is) - borne);
                                };
                                note(child, arms.of_child, before, now);
                                if (has_parent) note(parent, arms.of_parent, -before, -now);
                            });
    }
    const auto grows = minimum(growth, uneven) > Lanes(0);
    if (!any(grows)) return;
    store_lanes(select(grows, Lanes(1), Lanes(0)), exceeding);
    for (const FigureNode& node : shape.nodes) {
        for_each_tried_lock(figure, node, substep, lane,
                            [&](const FigureNode::Lock& lock, const PointArms&, const Vec3<Lanes>& before,
                                const Vec3<Lanes>& now) {
                                const Vec3<Lanes> tension = select(grows, now, before);
                                store_row(lock.reversed ? -tension : tension,
                                          system + node.tension + lock.first_row * block_lanes);
                            });
    }
}
