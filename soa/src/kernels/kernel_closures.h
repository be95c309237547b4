// Locks that close loops of a figure: a small dense system, made of the tree's response to each of their rows.
// Included inside an anonymous namespace, after kernel_tension.h.
//
// With the tree's locks held, a unit impulse along row j changes J v of row i by K_ij (J: Jacobian, v: velocities).
// Loops are often redundant (a flat four-bar closes by five rows and needs two): rows whose pivot is only rounding
// get no impulse, because the rows before them already enforce them.
#pragma once

/// A row depends on those before it if its pivot is below this share of J M^-1 J^T of its two bodies alone (M: mass
/// matrix).
constexpr float closure_rounding = 1e-4F;

/// One row of a closure and its two bodies in lanes.
struct ClosureRow {
    EqualityRow<Lanes> row;
    float* a;
    float* b;
    bool a_moves, b_moves;
};
inline ClosureRow closure_row(const FigureBlock& figure, const FigureClosure& closure, int i, int lane)
{
    const FigureShape::Joint& joint = figure.shape->joints[static_cast<std::size_t>(closure.joint)];
    const float* row = figure.system + figure.shape->closure_jacobian +
                       std::int64_t{FigureNode::row_floats} * (closure.first_row + i) + lane;
    return {load_row<EqualityRow<Lanes>>(row), figure.body(joint.a) + lane, figure.body(joint.b) + lane,
            joint.kind_a == BodyKind::rigid, joint.kind_b == BodyKind::rigid};
}
/// Calls work(row, its number) for each row of each closure.
template <class Work>
void for_each_closure_row(const FigureBlock& figure, int lane, const Work& work)
{
    for (const FigureClosure& closure : figure.shape->closures) {
        for (int i = 0; i < closure.rows; ++i)
            work(closure_row(figure, closure, i, lane), closure.first_row + i);
    }
}

/// linear . v + lever . w of one body (v: velocity, w: angular velocity).
inline Lanes end_speed(const Vec3<Lanes>& linear, const Vec3<Lanes>& lever, const float* body)
{
    const Mover m = load_row<Mover>(body);
    return dot(linear, m.linear) + dot(lever, m.angular);
}
inline Lanes speed_along(const ClosureRow& c)
{
    return end_speed(c.row.linear, c.row.lever_b, c.b) - end_speed(c.row.linear, c.row.lever_a, c.a);
}
/// v += M^-1 J^T lambda for one body. Returns the body's part of J M^-1 J^T.
inline Lanes push_end(const Vec3<Lanes>& linear, const Vec3<Lanes>& lever, float* body, bool moves,
                      const Lanes& lambda)
{
    if (!moves) return Lanes(0);
    Mover m = load_row<Mover>(body);
    const Vec3<Lanes> turn = m.inverse_inertia * lever;
    m.linear = m.linear + (m.inverse_mass * lambda) * linear;
    m.angular = m.angular + lambda * turn;
    store_copy_velocity(m, body);
    return m.inverse_mass * dot(linear, linear) + dot(lever, turn);
}
inline Lanes push_along(const ClosureRow& c, const Lanes& lambda)
{
    return push_end(c.row.linear, c.row.lever_b, c.b, c.b_moves, lambda) +
           push_end(c.row.linear, c.row.lever_a, c.a, c.a_moves, -lambda);
}

/// Computes K of the closures and factors it, after the tree has been factored.
inline void factor_closures(const FigureBlock& figure, int lane)
{
    const FigureShape& shape = *figure.shape;
    const StoredTriangle k{figure.system + shape.closure_factor + lane};
    float* alone = figure.system + shape.closure_alone + lane;
    const Vec3<Lanes> still{Lanes(0), Lanes(0), Lanes(0)};
    const auto stop = [&] {
        for (const FigureNode& node : shape.nodes) {
            Mover body = body_of(figure, node, lane);
            body.linear = body.angular = still;
            store_copy_velocity(body, figure.body(node.body) + lane);
        }
    };
    for (const FigureNode& node : shape.nodes) {
        const Mover body = body_of(figure, node, lane);
        Row6 velocity;
        put(body.linear, body.angular, velocity);
        store_array(velocity, figure.system + node.kept + lane);
    }
    for_each_closure_row(figure, lane, [&](const ClosureRow& pushed, int column) {
        stop();
        store_lanes(push_along(pushed, Lanes(1)), alone + column * block_lanes);
        sweep_tree(figure, 0, TreeSweep::answers, lane);
        for_each_closure_row(figure, lane, [&](const ClosureRow& seen, int row) {
            if (row < column) return;
            const Lanes of_a = seen.a_moves ? end_speed(seen.row.linear, seen.row.lever_a, seen.a) : Lanes(0);
            const Lanes of_b = seen.b_moves ? end_speed(seen.row.linear, seen.row.lever_b, seen.b) : Lanes(0);
            k.set(row, column, of_b - of_a);
        });
    });
    for (const FigureNode& node : shape.nodes) {
        Row6 velocity;
        load_array(figure.system + node.kept + lane, velocity);
        Mover body = body_of(figure, node, lane);
        body.linear = {velocity[0], velocity[1], velocity[2]};
        body.angular = {velocity[3], velocity[4], velocity[5]};
        store_copy_velocity(body, figure.body(node.body) + lane);
    }
    factor_in_place(shape.closure_rows, k, [&](int i, const Lanes& pivot) {
        const auto usable = pivot > Lanes(closure_rounding) * load_lanes(alone + i * block_lanes);
        return select(usable, inverse_or_zero(pivot), Lanes(0));
    });
}

/// Applies the impulses with which the closures hold, then solves the tree so that its locks hold too.
inline void solve_closures(const FigureBlock& figure, float rate, TreeSweep sweep, int lane)
{
    const FigureShape& shape = *figure.shape;
    const StoredTriangle k{figure.system + shape.closure_factor + lane};
    const StoredColumn x{figure.system + shape.closure_target + lane};
    for_each_closure_row(figure, lane, [&](const ClosureRow& c, int row) {
        const Lanes target = -(speed_along(c) + Lanes(rate) * c.row.error);
        x.set(row, sweep == TreeSweep::corrects ? where_exceeding(figure, lane, target, Lanes(0)) : target);
    });
    // A row without a pivot gets no impulse.
    solve_in_place(shape.closure_rows, k, x, [&](int i, const Lanes& value) {
        return select(k.get(i, i) > Lanes(0), value, Lanes(0));
    });
    for (const FigureClosure& closure : shape.closures) {
        float* impulse = figure.joints[closure.joint].impulses() + lane;
        const Vec3<Lanes> none{Lanes(0), Lanes(0), Lanes(0)};
        Wrench<Lanes> sum{none, none};
        for (int i = 0; i < closure.rows; ++i) {
            const Lanes lambda = x.get(closure.first_row + i);
            const ClosureRow pushed = closure_row(figure, closure, i, lane);
            push_along(pushed, lambda);
            store_lanes(load_lanes(impulse + i * block_lanes) + lambda, impulse + i * block_lanes);
            add_row(pushed.row.linear, pushed.row.lever_b, lambda, sum);
        }
        add_to_sum(figure, closure.joint, sum, lane);
    }
    sweep_tree(figure, rate, sweep, lane);
}

inline void factor_trees(const FigureBlock& figure, const float* only)
{
    for (int lane = 0; lane < figure.count; lane += Lanes_width) {
        factor_tree(figure, only, lane);
        if (figure.shape->closure_rows > 0) factor_closures(figure, lane);
    }
}

[[gnu::noinline]] inline void sweep_trees(const FigureBlock& figure, float rate, TreeSweep sweep)
{
    for (int lane = 0; lane < figure.count; lane += Lanes_width) {
        sweep_tree(figure, rate, sweep, lane);
        if (figure.shape->closure_rows > 0) solve_closures(figure, rate, sweep, lane);
    }
}
inline void follow_tensions(const FigureBlock& figure, float substep, float rate)
{
    for (int lane = 0; lane < figure.count; lane += Lanes_width) follow_tension(figure, substep, rate, lane);
}
inline void solve_trees(const FigureBlock& figure, float rate)
{
    sweep_trees(figure, rate, TreeSweep::solves);
}
inline void correct_trees(const FigureBlock& figure, float rate)
{
    sweep_trees(figure, rate, TreeSweep::corrects);
}
