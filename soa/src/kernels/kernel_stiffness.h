// Locks under tension, as springs against the rotation of the light bodies between them. Included inside an anonymous namespace, after
// kernel_rigid_trees.h.
//
// Between light bodies under heavy load a taut joint is a stiff spring against rotation. A substep that takes the joint's force f as
// constant swings the bodies wider each time, however exactly it holds the joint. So the angular velocity w' at the end of the
// substep is taken into account: (M + h2 K) w' = M w + ..., with K = (f . r)(1 - n n^T) and n = r / |r|, where M is the inertia, h
// the substep, w the angular velocity before, and r the lever arm at which f pulls; `tension` is h2 f. (M. Tournier and others,
// Stable Constrained Dynamics, 2015; S. Andrews and others, Geometric Stiffness, 2017.) Only the part of K that an explicit substep
// cannot follow is used.
//
// The force turns with the load that pulls, so what counts is how a body turns against the load: w less the rotation of the whole
// tree, which is that of its heavy bodies. With w alone a load that is whirled or swings would be braked. (Where bodies of the tree
// are not held together at points, its rotation is not known, and w is taken.)
#pragma once

/// By how much a pull is stiffer than an explicit substep can follow, kg m2; 0 where it is not.
inline Lanes excess_of(const Mover& body, const Vec3<Lanes>& lever, const Vec3<Lanes>& tension)
{
    const Sym3<Lanes>& i = body.inverse_inertia;
    const Lanes bearable = Lanes(0.5F) * inverse_or_zero(i.xx + i.yy + i.zz);
    return maximum(dot(tension, lever) - bearable, Lanes(0));
}

/// A lock that holds a point on a point, under tension.
struct TautLock {
    PointArms arms;
    Lanes excess_of_child, excess_of_parent;  ///< see excess_of(); 0 for a fixed parent
};
/// FigureNode::tension of the point that a lock holds, with the sign of the node.
inline Vec3<Lanes> tension_of(const FigureBlock& figure, const FigureNode& node, const FigureNode::Lock& lock,
                              int lane)
{
    const auto tension =
        load_row<Vec3<Lanes>>(figure.system + node.tension + lock.first_row * block_lanes + lane);
    return lock.reversed ? -tension : tension;
}
[[gnu::noinline]] inline TautLock taut_lock(const FigureBlock& figure, const FigureNode& child,
                                            const FigureNode::Lock& lock, int lane)
{
    const PointArms arms = arms_of(figure, child, lock, lane);
    const Vec3<Lanes> tension = tension_of(figure, child, lock, lane);
    return {arms, excess_of(body_of(figure, child, lane), arms.of_child, tension),
            child.parent_node < 0 ? Lanes(0)
                                  : excess_of(body_of(figure, node_of(figure, child.parent_node), lane),
                                              arms.of_parent, -tension)};
}
/// Calls work(child node, TautLock) for each lock of the figure's trees that holds a point on a point.
template <class Work>
void for_each_taut_lock(const FigureBlock& figure, int lane, const Work& work)
{
    for (const FigureNode& child : figure.shape->nodes) {
        for (const FigureNode::Lock& lock : child.locks) {
            if (lock.locks_point) work(child, taut_lock(figure, child, lock, lane));
        }
    }
}

/// Finds the bodies that tension may swing: those with a lock to another body, neither of which can bear its tension. (A point that a
/// heavy or a fixed body holds moves no further than that body.) Returns whether there are any.
inline bool find_strained(const FigureBlock& figure, int lane)
{
    float* system = figure.system + lane;
    Lanes most(0);
    for (const FigureNode& node : figure.shape->nodes) store_lanes(most, system + node.strain);
    for_each_taut_lock(figure, lane, [&](const FigureNode& child, const TautLock& lock) {
        if (child.parent_node < 0) return;
        const Lanes of_both = minimum(lock.excess_of_child, lock.excess_of_parent);
        for (float* strain : {system + child.strain, system + node_of(figure, child.parent_node).strain})
            store_lanes(maximum(load_lanes(strain), of_both), strain);
        most = maximum(most, of_both);
    });
    return any(most > Lanes(0));
}

/// Finds how the trees turn whose bodies are strained, and the trees whose momentum has to be kept.
inline void gather_trees(const FigureBlock& figure, int lane)
{
    const float* system = figure.system + lane;
    for (const PointTree& tree : figure.shape->point_trees) {
        Lanes heaviest(0), lightest(std::numeric_limits<float>::infinity()), strained(0);
        for (int i = tree.begin; i < tree.end; ++i) {
            const FigureNode& node = node_of(figure, i);
            const Lanes mass = inverse_or_zero(body_of(figure, node, lane).inverse_mass);
            heaviest = maximum(heaviest, mass);
            lightest = minimum(lightest, mass);
            strained = maximum(strained, load_lanes(system + node.strain));
        }
        const Lanes zero(0);
        RigidTree rigid{};
        rigid.uneven = select(heaviest > Lanes(even_masses) * lightest, Lanes(1), zero);
        rigid.keeps_momentum = maximum(rigid.uneven, strained);
        if (any(rigid.keeps_momentum > zero)) gather_tree(figure, tree, lightest, lane, rigid);
        store_row(rigid, rigid_tree(figure, tree, lane));
    }
}

/// Adds h2 K of a strained body to its M, and -h2 K (w - rotation) to what pulls at it, in lanes where `anew` is above 0.
[[gnu::noinline, gnu::cold]] inline void stiffen(const FigureBlock& figure, const FigureNode& node,
                                                 const Vec3<Lanes>& lever, const Lanes& excess_at_lever,
                                                 const Vec3<Lanes>& rotation, const Lanes& anew, int lane)
{
    float* system = figure.system + lane;
    const Lanes excess = select(load_lanes(system + node.strain) > Lanes(0), excess_at_lever, Lanes(0));
    const Vec3<Lanes> n = square_root(inverse_or_zero(dot(lever, lever))) * lever;
    const Sym3<Lanes> k{excess - excess * n.x * n.x, -(excess * n.x * n.y), -(excess * n.x * n.z),
                        excess - excess * n.y * n.y, -(excess * n.y * n.z), excess - excess * n.z * n.z};
    auto m = load_row<Triangle<6>>(system + node.mass);
    m.at(3, 3) = m.at(3, 3) + k.xx;
    m.at(4, 3) = m.at(4, 3) + k.xy;
    m.at(4, 4) = m.at(4, 4) + k.yy;
    m.at(5, 3) = m.at(5, 3) + k.xz;
    m.at(5, 4) = m.at(5, 4) + k.yz;
    m.at(5, 5) = m.at(5, 5) + k.zz;
    store_row(m, system + node.mass);
    const Vec3<Lanes> against = k * (body_of(figure, node, lane).angular - rotation);
    const Vec3<Lanes> none{Lanes(0), Lanes(0), Lanes(0)};
    store_row(load_row<Vec3<Lanes>>(system + node.pull) - select(anew > Lanes(0), against, none),
              system + node.pull);
}

/// Stiffens the locks of the figure's trees, whose mass matrices are known. `anew`: see stiffen().
inline void stiffen_trees(const FigureBlock& figure, const Lanes& anew, int lane)
{
    const bool any_strained = find_strained(figure, lane);
    gather_trees(figure, lane);
    if (!any_strained) return;
    for_each_taut_lock(figure, lane, [&](const FigureNode& child, const TautLock& lock) {
        Vec3<Lanes> rotation{Lanes(0), Lanes(0), Lanes(0)};
        if (child.point_tree >= 0) {
            const PointTree& tree = figure.shape->point_trees[static_cast<std::size_t>(child.point_tree)];
            rotation = load_row<RigidTree>(rigid_tree(figure, tree, lane)).rotation;
        }
        stiffen(figure, child, lock.arms.of_child, lock.excess_of_child, rotation, anew, lane);
        if (child.parent_node >= 0)
            stiffen(figure, node_of(figure, child.parent_node), lock.arms.of_parent, lock.excess_of_parent,
                    rotation, anew, lane);
    });
}
