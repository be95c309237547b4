// A tree as one rigid body: how it turns on the whole, and what keeps the momentum of one that floats. Included inside an anonymous
// namespace, after kernel_acting_rows.h.
//
// What the bodies of a tree do to each other changes neither its momentum nor its angular momentum. Two things in a solve do:
// stiffened locks (kernel_stiffness.h), which brake light bodies and turn nothing the other way, and rounding, where a light body is
// between much heavier ones. What they have changed is taken back by moving the whole tree like a rigid body, which no lock resists.
#pragma once

struct RigidTree {
    Lanes uneven;          ///< above 0 in lanes where the masses are further apart than even_masses
    Lanes keeps_momentum;  ///< above 0 in lanes whose momentum would change too much
    Lanes inverse_mass;
    Vec3<Lanes> centre;           ///< of mass, from the root body's; 0 for a tree that hangs
    Sym3<Lanes> inverse_inertia;  ///< about the centre, or about the point at which the tree hangs
    Vec3<Lanes> rotation;  ///< the angular velocity with which it would have the tree's angular momentum
};
static_assert(fields_of<RigidTree> == PointTree::floats);

/// Up to this ratio of its heaviest body's mass to its lightest one's, rounding changes the momentum of a tree by less than 1e-5 of it
/// in a second (LightBetweenHeavy.MomentumIsKept). The tension of one beyond is followed within a substep (kernel_tension.h).
constexpr float even_masses = 100;

inline float* rigid_tree(const FigureBlock& figure, const PointTree& tree, int lane)
{
    return figure.system + tree.rigid + lane;
}
/// Calls work(node, body, where its centre of mass is from `centre`) for the nodes of a tree.
template <class Work>
void for_each_body(const FigureBlock& figure, const PointTree& tree, const Vec3<Lanes>& centre, int lane,
                   const Work& work)
{
    for (int i = tree.begin; i < tree.end; ++i) {
        const FigureNode& node = node_of(figure, i);
        work(node, body_of(figure, node, lane),
             load_row<Vec3<Lanes>>(figure.system + node.place + lane) - centre);
    }
}

/// The lever arms of a point that is held on a point, before its node is factored.
struct PointArms {
    Vec3<Lanes> of_child, of_parent;
};
inline PointArms arms_of(const FigureBlock& figure, const FigureNode& node, const FigureNode::Lock& lock,
                         int lane)
{
    const float* rows = figure.system + node.jacobian + lock.first_row * FigureNode::row_floats + lane;
    const auto x = load_row<EqualityRow<Lanes>>(rows);
    const auto y = load_row<EqualityRow<Lanes>>(rows + FigureNode::row_floats);
    return {lever_of_point(x.lever_b, y.lever_b), lever_of_point(x.lever_a, y.lever_a)};
}

/// Finds out where the centres of mass of a tree's bodies are: from that of the root, or from the point at which the root hangs.
/// Returns the velocity of that point, 0 for a tree that floats.
inline Vec3<Lanes> place_bodies(const FigureBlock& figure, const PointTree& tree, int lane)
{
    const Vec3<Lanes> none{Lanes(0), Lanes(0), Lanes(0)};
    Vec3<Lanes> velocity = none;
    for (int i = tree.end; i-- > tree.begin;) {
        const FigureNode& node = node_of(figure, i);
        Vec3<Lanes> place = none;
        if (node.parent >= 0) {
            const PointArms arms = arms_of(figure, node, *node.point_lock(), lane);
            if (node.parent_node >= 0) {
                const float* parent = figure.system + node_of(figure, node.parent_node).place + lane;
                place = load_row<Vec3<Lanes>>(parent) + arms.of_parent;
            } else {
                const Mover fixed = load_row<Mover>(figure.body(node.parent) + lane);
                velocity = fixed.linear + cross(fixed.angular, arms.of_parent);
            }
            place = place - arms.of_child;
        }
        store_row(place, figure.system + node.place + lane);
    }
    return velocity;
}

/// Finds the rigid body that has the mass, the inertia and the angular momentum of a tree. `lightest`: the mass of its lightest body.
[[gnu::noinline, gnu::cold]] inline void gather_tree(const FigureBlock& figure, const PointTree& tree,
                                                     const Lanes& lightest, int lane, RigidTree& rigid)
{
    const Vec3<Lanes> velocity = place_bodies(figure, tree, lane);
    const Lanes zero(0);
    const Vec3<Lanes> none{zero, zero, zero};
    Lanes mass(0);
    Vec3<Lanes> moment = none;
    for_each_body(figure, tree, none, lane,
                  [&](const FigureNode&, const Mover& body, const Vec3<Lanes>& place) {
                      const Lanes m = inverse_or_zero(body.inverse_mass);
                      mass = mass + m;
                      moment = moment + m * place;
                  });
    const bool hangs = node_of(figure, tree.end - 1).parent >= 0;
    // A body without mass does not move: it holds the tree, in its lane.
    const auto moves = lightest > zero;
    rigid.keeps_momentum = hangs ? zero : select(moves, rigid.keeps_momentum, zero);
    rigid.inverse_mass = inverse_or_zero(mass);
    rigid.centre = hangs ? none : rigid.inverse_mass * moment;
    Sym3<Lanes> inertia{zero, zero, zero, zero, zero, zero};
    Vec3<Lanes> spin = none;
    for_each_body(figure, tree, rigid.centre, lane,
                  [&](const FigureNode&, const Mover& body, const Vec3<Lanes>& d) {
                      const Lanes m = inverse_or_zero(body.inverse_mass);
                      const Sym3<Lanes> own = inverse(body.inverse_inertia);
                      const Lanes square = dot(d, d);
                      inertia.xx = inertia.xx + (own.xx + m * (square - d.x * d.x));
                      inertia.xy = inertia.xy + (own.xy - m * (d.x * d.y));
                      inertia.xz = inertia.xz + (own.xz - m * (d.x * d.z));
                      inertia.yy = inertia.yy + (own.yy + m * (square - d.y * d.y));
                      inertia.yz = inertia.yz + (own.yz - m * (d.y * d.z));
                      inertia.zz = inertia.zz + (own.zz + m * (square - d.z * d.z));
                      spin = spin + (own * body.angular + cross(d, m * (body.linear - velocity)));
                  });
    rigid.inverse_inertia = inverse(inertia);
    rigid.rotation = select(moves, rigid.inverse_inertia * spin, none);
}

/// Takes back by how much a solve has changed the momentum and the angular momentum of a tree that floats.
[[gnu::noinline, gnu::cold]] inline void keep_momentum(const FigureBlock& figure, const PointTree& tree,
                                                       TreeSweep sweep, int lane)
{
    const auto rigid = load_row<RigidTree>(rigid_tree(figure, tree, lane));
    if (!any(rigid.keeps_momentum > Lanes(0))) return;
    const Vec3<Lanes> none{Lanes(0), Lanes(0), Lanes(0)};
    Vec3<Lanes> push = none, turn = none;
    for_each_body(figure, tree, rigid.centre, lane,
                  [&](const FigureNode& node, const Mover& body, const Vec3<Lanes>& d) {
                      Row6 change;
                      load_array(figure.system + node.change + lane, change);
                      const Vec3<Lanes> linear{change[0], change[1], change[2]};
                      const Vec3<Lanes> angular{change[3], change[4], change[5]};
                      const Vec3<Lanes> own = inverse_or_zero(body.inverse_mass) * linear;
                      push = push + own;
                      turn = turn + (inverse(body.inverse_inertia) * angular + cross(d, own));
                  });
    // x - 0 is x for every x, also for -0.
    const auto keeps = rigid.keeps_momentum > Lanes(0);
    const auto where_kept = [&](const Vec3<Lanes>& back) {
        const Vec3<Lanes> kept = select(keeps, back, none);
        return sweep == TreeSweep::corrects ? where_exceeding(figure, lane, kept, none) : kept;
    };
    const Vec3<Lanes> linear = rigid.inverse_mass * push, angular = rigid.inverse_inertia * turn;
    for_each_body(figure, tree, rigid.centre, lane,
                  [&](const FigureNode& node, Mover body, const Vec3<Lanes>& d) {
                      body.linear = body.linear - where_kept(linear + cross(angular, d));
                      body.angular = body.angular - where_kept(angular);
                      store_copy_velocity(body, figure.body(node.body) + lane);
                  });
}
