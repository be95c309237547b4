// Solves all locks of a figure at once: J M^-1 J^T is factored along its tree, one copy per lane. Included inside an
// anonymous namespace, after kernel_stiffness.h.
//
// In the system
//
//   | M  -J^T | | change |   |   0    |
//   | J    0  | | lambda | = | target |,   target = -(J v + rate C)
//
// (M: mass matrix, J: Jacobian of the locks, v: velocities, change: what is added to v, lambda: impulses, C: position
// errors, rate: share of C to remove, 1/s) a body without children is eliminated first, then its locks, which add
// J_p^T K^-1 J_p to the mass matrix of the parent body, where J_p is their Jacobian on the parent and K^-1 their
// effective mass: the articulated inertia of R. Featherstone (Rigid Body Dynamics Algorithms, 2008, chapter 7).
// Masses are only ever added, so nothing cancels whatever their ratio. If all bodies were eliminated first, the
// system of the locks would consist of terms 1/m + 1/m' - ..., which cancel.
#pragma once

/// Factors K in place. Its pivots are known to be at least `least`, so one that rounding has made smaller is raised
/// to that. For a row without a pivot, 1 / D is 0.
template <class Count, int n>
void factor_in_place(Count rows, Triangle<n>& k, const Lanes (&least)[n])
{
    factor_in_place(rows, k,
                    [&](int i, const Lanes& pivot) { return inverse_or_zero(maximum(pivot, least[i])); });
}

/// Swaps the sides of a row whose body a is the child body: J v, C and the speed change sign.
inline void turn_round(float* row)
{
    auto r = load_row<EqualityRow<Lanes>>(row);
    store_row(EqualityRow<Lanes>{r.linear, r.lever_b, r.lever_a, -r.error, -r.speed}, row);
}

/// The first `rows` rows of a triangle, from and to memory.
template <class Count, int n>
void store_factor(Count rows, const Triangle<n>& from, float* to)
{
    repeat(rows, [&](auto i) {
        repeat(one_more(i),
               [&](auto j) { store_lanes(from.at(i, j), to + in_triangle(i, j) * block_lanes); });
    });
}
template <class Count, int n>
void load_factor(Count rows, const float* from, Triangle<n>& to)
{
    repeat(rows, [&](auto i) {
        repeat(one_more(i),
               [&](auto j) { to.at(i, j) = load_lanes(from + in_triangle(i, j) * block_lanes); });
    });
}

/// M of a body, without -0: what stiffened locks add may be 0. One that does not move gets 1 kg here, and factor_mass() clears its
/// pivots.
inline Triangle<6> mass_of(const Mover& body)
{
    const auto moves = body.inverse_mass > Lanes(0);
    const Lanes zero(0), one(1);
    const Lanes m = select(moves, one / select(moves, body.inverse_mass, one), one);
    const Sym3<Lanes> inertia = inverse(body.inverse_inertia);
    const Lanes xy = zero + inertia.xy, xz = zero + inertia.xz, yz = zero + inertia.yz;
    return {{m,    zero, m,    zero,       zero,       m,  //
             zero, zero, zero, inertia.xx,                 //
             zero, zero, zero, xy,         inertia.yy,     //
             zero, zero, zero, xz,         yz,         inertia.zz}};
}

/// The pivots of M.
inline void pivots_of(const Mover& body, const Triangle<6>& mass, Row6& pivots)
{
    pivots[0] = pivots[1] = pivots[2] = mass.at(0, 0);
    pivots[3] = mass.at(3, 3);
    // In this order, because squares of moments of inertia leave the range of floats.
    pivots[4] = mass.at(4, 4) - mass.at(4, 3) * (mass.at(4, 3) * inverse_or_zero(mass.at(3, 3)));
    // The last pivot of I is 1 / (I^-1)_zz.
    pivots[5] = inverse_or_zero(body.inverse_inertia.zz);
}

/// Factors M', whose pivots are at least those of the body's own M.
inline void factor_mass(const Mover& body, const Row6& pivots_alone, Triangle<6>& mass)
{
    factor_in_place(Constant<6>{}, mass, pivots_alone);
    const auto moves = body.inverse_mass > Lanes(0);
    unrolled<6>([&](auto i) { mass.at(i, i) = select(moves, mass.at(i, i), Lanes(0)); });
}

/// A pivot of K below this share of J M^-1 J^T of the child body alone is only rounding.
constexpr float tree_rounding = 1e-7F;

/// How far a substep may rotate a body (rad) to correct the position error of its locks. A light link that swings
/// fast has a larger error: correcting it at once would throw the link, and the next substep would have a larger
/// error still.
constexpr float tree_turn = 0.25F;

/// The size of a node's lever arms, m (1 for an angular row). An error divided by it is about the angle by which
/// correcting it rotates the bodies.
template <class Rows>
Lanes reach_of(const Rows& j)
{
    Lanes squares(0);
    repeat(j.count(), [&](auto i) {
        Row6 child, parent;
        j.child_row(i, child);
        j.parent_row(i, parent);
        unrolled<3>([&](auto c) {
            squares = squares + (child[3 + c] * child[3 + c] + parent[3 + c] * parent[3 + c]);
        });
    });
    return square_root(squares);
}

template <class Rows>
void factor_locks(const Mover& body, const FigureNode& node, int row_count, float* system, float* parent_mass,
                  const Triangle<6>& mass)
{
    Rows j = Rows::of(system + node.jacobian, row_count);
    const auto rows = j.count();
    const Lanes most = Lanes(tree_turn) * reach_of(j);
    repeat(rows, [&](auto i) { j.error[i] = maximum(minimum(j.error[i], most), -most); });
    j.keep(system + node.jacobian);
    Triangle<Rows::most> k;
    Lanes least[Rows::most];
    repeat(rows, [&](auto i) {
        Row6 row, response;
        j.child_row(i, row);
        j.child_row(i, response);
        solve_in_place(Constant<6>{}, mass, response, Rows::first_entry(i));
        store_array(response, system + node.response + i * 6 * block_lanes);
        repeat(one_more(i), [&](auto m) { k.at(i, m) = j.along_child(m, response); });
        if (Rows::may_give(i)) k.at(i, i) = k.at(i, i) + load_lanes(system + node.give + i * block_lanes);
        const Vec3<Lanes> linear{row[0], row[1], row[2]};
        const Vec3<Lanes> lever{row[3], row[4], row[5]};
        least[i] = Lanes(tree_rounding) *
                   (body.inverse_mass * dot(linear, linear) + dot(lever, body.inverse_inertia * lever));
    });
    factor_in_place(rows, k, least);
    store_factor(rows, k, system + node.factor);
    if (parent_mass == nullptr) return;
    // J_p^T K^-1 J_p = B^T D^-1 B with K = L D L^T and B = L^-1 J_p.
    auto sum = load_row<Triangle<6>>(parent_mass);
    Row6 b[Rows::most];
    repeat(rows, [&](auto i) {
        j.parent_row(i, b[i]);
        unrolled<6>([&](auto c) {
            repeat(i, [&](auto m) {
                if (Rows::reaches_parent(m, c)) b[i][c] = b[i][c] - k.at(i, m) * b[m][c];
            });
        });
        unrolled<6>([&](auto c) {
            if (!Rows::reaches_parent(i, c)) return;
            const Lanes scaled = k.at(i, i) * b[i][c];
            unrolled<c + 1>([&](auto d) {
                if (Rows::reaches_parent(i, d)) sum.at(c, d) = sum.at(c, d) + scaled * b[i][d];
            });
        });
    });
    store_row(sum, parent_mass);
}

/// From child to parent: computes y = K^-1 (target - J_c M'^-1 f), where J_c is the Jacobian on the child and f the
/// force on it, and adds J_p^T y to the force on the parent.
template <class Rows>
void reach_up(const FigureBlock& figure, const FigureNode& node, float* system, float* parent_force,
              const Row6& change, const Lanes& rate, TreeSweep sweep, int lane)
{
    const Rows j = Rows::kept(system + node.jacobian, figure.rows_of(node));
    const auto rows = j.count();
    const Mover body = body_of(figure, node, lane);
    Row6 child, parent;
    put(body.linear, body.angular, child);
    if (node.parent_node >= 0 || sweep != TreeSweep::answers) {
        const Mover on = load_row<Mover>(figure.body(node.parent) + lane);
        put(on.linear, on.angular, parent);
    } else {
        unrolled<6>([&](auto c) { parent[c] = Lanes(0); });
    }
    Lanes y[Rows::most];
    repeat(rows, [&](auto i) {
        y[i] = -((j.along_child(i, child) + j.along_parent(i, parent)) + rate * j.error[i]);
        if (sweep != TreeSweep::answers) y[i] = y[i] + j.speed_of(i);
        y[i] = y[i] - j.along_child(i, change);
        if (sweep == TreeSweep::corrects) y[i] = where_exceeding(figure, lane, y[i], Lanes(0));
    });
    Triangle<Rows::most> factor;
    load_factor(rows, system + node.factor, factor);
    solve_in_place(rows, factor, y);
    repeat(rows, [&](auto i) { store_lanes(y[i], system + node.target + i * block_lanes); });
    if (parent_force == nullptr) return;
    Row6 force;
    load_array(parent_force, force);
    j.push_parent(y, force);
    store_array(force, parent_force);
}

/// Adds what a lock of the tree has just done to its body b to the sum of the step.
inline void add_to_sum(const FigureBlock& figure, int joint, const Wrench<Lanes>& more, int lane)
{
    const FigureBlock::Joint& lanes = figure.joints[joint];
    float* at = lanes.streams.sums +
                static_cast<std::int64_t>(lanes.block) * fields_of<Wrench<Lanes>> * block_lanes + lane;
    const auto sum = load_row<Wrench<Lanes>>(at);
    store_row(Wrench<Lanes>{sum.push + more.push, sum.turn + more.turn}, at);
}

/// From parent to child: lambda = y - K^-1 J_p (velocity change of the parent), change = M'^-1 (f + J_c^T lambda).
template <class Rows>
void reach_down(const FigureBlock& figure, const FigureNode& node, float* system, const float* parent_change,
                Row6& change, const Lanes& rate, TreeSweep sweep, int lane)
{
    const Rows j = Rows::kept(system + node.jacobian, figure.rows_of(node));
    const auto rows = j.count();
    Lanes lambda[Rows::most];
    repeat(rows, [&](auto i) { lambda[i] = load_lanes(system + node.target + i * block_lanes); });
    if (parent_change != nullptr) {
        Row6 above;
        load_array(parent_change, above);
        Lanes lacking[Rows::most];
        repeat(rows, [&](auto i) { lacking[i] = j.along_parent(i, above); });
        Triangle<Rows::most> factor;
        load_factor(rows, system + node.factor, factor);
        solve_in_place(rows, factor, lacking);
        repeat(rows, [&](auto i) { lambda[i] = lambda[i] - lacking[i]; });
    }
    repeat(rows, [&](auto i) {
        Row6 response;
        load_array(system + node.response + i * 6 * block_lanes, response);
        unrolled<6>([&](auto c) { change[c] = change[c] + lambda[i] * response[c]; });
    });
    if (sweep == TreeSweep::answers) return;
    if (sweep == TreeSweep::tries) {
        repeat(rows, [&](auto i) { store_lanes(lambda[i], system + node.target + i * block_lanes); });
        return;
    }
    for (const FigureNode::Lock& lock : node.locks) {
        float* impulse = figure.joints[lock.joint].impulses() + lane;
        for (int i = 0; i < lock.rows; ++i) {
            const Lanes pushed = lambda[lock.first_row + i];
            const Lanes before = load_lanes(impulse + i * block_lanes);
            store_lanes(lock.reversed ? before - pushed : before + pushed, impulse + i * block_lanes);
        }
        const Wrench<Lanes> on_child = j.wrench(lambda, lock.first_row, lock.first_row + lock.rows);
        add_to_sum(figure, lock.joint,
                   lock.reversed ? Wrench<Lanes>{-on_child.push, -on_child.turn} : on_child, lane);
    }
    if (!figure.shape->has_actives) return;
    Lanes of_rows[Rows::most];
    repeat(rows, [&](auto i) { of_rows[i] = lambda[i]; });
    add_to_impulses(figure, node, of_rows, rate, sweep, lane);
}

/// Calls work with a null pointer whose type is the form of the node's rows: PointRows or AnyRows. Not for a body that hangs by
/// nothing.
template <class Work>
void with_rows(const FigureNode& node, int row_count, const Work& work)
{
    if (row_count == 0) return;
    if (!node.hangs_by_point()) return work(static_cast<AnyRows*>(nullptr));
    switch (row_count) {
        case 3:
            return work(static_cast<PointRows<3>*>(nullptr));
        case 4:
            return work(static_cast<PointRows<4>*>(nullptr));
        case 5:
            return work(static_cast<PointRows<5>*>(nullptr));
        default:
            return work(static_cast<PointRows<6>*>(nullptr));
    }
}

/// `only`: if given, what pulls at the bodies is found in copies where that is not 0, and stays in the others.
inline void factor_tree(const FigureBlock& figure, const float* only, int lane)
{
    const Array<FigureNode>& nodes = figure.shape->nodes;
    float* system = figure.system + lane;
    const Lanes anew = only == nullptr ? Lanes(1) : load_lanes(only + lane);
    const Vec3<Lanes> none{Lanes(0), Lanes(0), Lanes(0)};
    for (const FigureNode& node : nodes) {
        for (const FigureNode::Lock& lock : node.locks) {
            for (int i = lock.first_row; lock.reversed && i < lock.first_row + lock.rows; ++i)
                turn_round(system + node.jacobian + i * FigureNode::row_floats);
        }
        figure.for_each_acting(node, [&](const FigureNode::Active& active, int row, const float*) {
            if (active.reversed) turn_round(system + node.jacobian + row * FigureNode::row_floats);
        });
        const Mover body = body_of(figure, node, lane);
        const Triangle<6> mass = mass_of(body);
        Row6 pivots;
        pivots_of(body, mass, pivots);
        store_row(mass, system + node.mass);
        store_array(pivots, system + node.pivots);
        store_row(select(anew > Lanes(0), none, load_row<Vec3<Lanes>>(system + node.pull)),
                  system + node.pull);
    }
    stiffen_trees(figure, anew, lane);
    for (const FigureNode& node : nodes) {
        const Mover body = body_of(figure, node, lane);
        Row6 pivots_alone;
        load_array(system + node.pivots, pivots_alone);
        auto factor = load_row<Triangle<6>>(system + node.mass);
        factor_mass(body, pivots_alone, factor);
        store_row(factor, system + node.mass_factor);
        float* parent_mass = node.parent_node < 0 ? nullptr : system + node_of(figure, node.parent_node).mass;
        const int row_count = figure.rows_of(node);
        with_rows(node, row_count, [&]<class Rows>(Rows*) {
            factor_locks<Rows>(body, node, row_count, system, parent_mass, factor);
        });
    }
}

/// Adds the impulse of what has let go to the force on a body, once.
[[gnu::noinline]] inline void apply_taken(const FigureNode& node, float* system)
{
    Row6 taken, force;
    load_array(system + node.taken, taken);
    load_array(system + node.force, force);
    for (int c = 0; c < 6; ++c) {
        force[c] = force[c] + taken[c];
        taken[c] = Lanes(0);
    }
    store_array(force, system + node.force);
    store_array(taken, system + node.taken);
}

/// Changes the velocities of all bodies such that J v + rate C is the speed of each row, 0 for the locks of the tree.
[[gnu::noinline]] inline void sweep_tree(const FigureBlock& figure, float rate, TreeSweep sweep, int lane)
{
    const Array<FigureNode>& nodes = figure.shape->nodes;
    float* system = figure.system + lane;
    const auto parent_of = [&](const FigureNode& node, std::int64_t FigureNode::*part) {
        return node.parent_node < 0 ? nullptr : system + node_of(figure, node.parent_node).*part;
    };
    const Vec3<Lanes> none{Lanes(0), Lanes(0), Lanes(0)};
    for (const FigureNode& node : nodes) {
        const bool pulls = sweep != TreeSweep::answers;
        store_row(none, system + node.force);
        store_row(pulls ? load_row<Vec3<Lanes>>(system + node.pull) : none,
                  system + node.force + 3 * block_lanes);
        if (!pulls) continue;
        if (sweep != TreeSweep::tries) store_row(none, system + node.pull);
        if (figure.shape->has_actives) apply_taken(node, system);
        if (figure.shape->has_rotors) follow_rotors(figure, node, lane);
    }
    for (const FigureNode& node : nodes) {
        Row6 change;
        load_array(system + node.force, change);
        solve_in_place(Constant<6>{}, load_row<Triangle<6>>(system + node.mass_factor), change);
        store_array(change, system + node.change);
        float* parent_force = parent_of(node, &FigureNode::force);
        with_rows(node, figure.rows_of(node), [&]<class Rows>(Rows*) {
            reach_up<Rows>(figure, node, system, parent_force, change, Lanes(rate), sweep, lane);
        });
    }
    for (std::size_t i = nodes.size(); i-- > 0;) {
        const FigureNode& node = nodes[i];
        Row6 change;
        load_array(system + node.change, change);
        const float* parent_change = parent_of(node, &FigureNode::change);
        with_rows(node, figure.rows_of(node), [&]<class Rows>(Rows*) {
            reach_down<Rows>(figure, node, system, parent_change, change, Lanes(rate), sweep, lane);
        });
        store_array(change, system + node.change);
        if (sweep == TreeSweep::tries) continue;
        Mover body = body_of(figure, node, lane);
        if (sweep == TreeSweep::corrects) {
            // x + -0 is x for every x, also for -0.
            for (Lanes& entry : change) entry = where_exceeding(figure, lane, entry, Lanes(-0.0F));
        }
        body.linear = body.linear + Vec3<Lanes>{change[0], change[1], change[2]};
        body.angular = body.angular + Vec3<Lanes>{change[3], change[4], change[5]};
        store_copy_velocity(body, figure.body(node.body) + lane);
    }
    if (sweep == TreeSweep::tries) return;
    for (const PointTree& tree : figure.shape->point_trees) keep_momentum(figure, tree, sweep, lane);
}
