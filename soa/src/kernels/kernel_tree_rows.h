// The Jacobian J and the position errors C of the locks between a child body and its parent, in the two forms in
// which a tree keeps them. Included inside an anonymous namespace, before kernel_trees.h.
//
// Most numbers in the rows that hold a point on a point are 0 or 1. A node with one such point and purely angular
// rows (a ball-socket, a hinge or a fixed joint: nearly every figure) keeps only its lever arms and computes without
// the rest, which takes a third of the memory and half of the work. Sums are in the order of the whole rows, so the
// bits are the same.
#pragma once

using Row6 = Lanes[6];

/// Calls work(i) for i = 0 ... count - 1, each i a compile-time constant: the numbers of a node must stay in
/// registers, and compilers give up on unrolling loops within loops.
template <int count, class Work>
[[gnu::always_inline]] inline void unrolled(const Work& work)
{
    [&]<int... i>(std::integer_sequence<int, i...>)
    {
        (work(std::integral_constant<int, i>{}), ...);
    }
    (std::make_integer_sequence<int, count>{});
}
template <int n>
using Constant = std::integral_constant<int, n>;
constexpr int one_more(int n)
{
    return n + 1;
}
template <int n>
constexpr Constant<n + 1> one_more(Constant<n>)
{
    return {};
}
/// Calls work(i) for i from 0 to count - 1: unrolled for a Constant, in a loop for an int.
template <class Count, class Work>
[[gnu::always_inline]] inline void repeat(Count count, const Work& work)
{
    if constexpr (std::is_same_v<Count, int>) {
        for (int i = 0; i < count; ++i) work(i);
    } else {
        unrolled<Count::value>(work);
    }
}
template <int count>
void load_array(const float* from, Lanes (&to)[count])
{
    unrolled<count>([&](auto i) { to[i] = load_lanes(from + i * block_lanes); });
}
template <int count>
void store_array(const Lanes (&from)[count], float* to)
{
    unrolled<count>([&](auto i) { store_lanes(from[i], to + i * block_lanes); });
}
inline Lanes dot6(const Row6& u, const Row6& v)
{
    return ((u[0] * v[0] + u[1] * v[1]) + (u[2] * v[2] + u[3] * v[3])) + (u[4] * v[4] + u[5] * v[5]);
}
inline void put(const Vec3<Lanes>& linear, const Vec3<Lanes>& angular, Row6& out)
{
    out[0] = linear.x, out[1] = linear.y, out[2] = linear.z;
    out[3] = angular.x, out[4] = angular.y, out[5] = angular.z;
}

/// The lever arm r of a point, from its rows: r x e_x = (0, r_z, -r_y) along x, r x e_y = (-r_z, 0, r_x) along y.
inline Vec3<Lanes> lever_of_point(const Vec3<Lanes>& along_x, const Vec3<Lanes>& along_y)
{
    return {along_y.z, -along_x.z, along_x.y};
}

/// Adds a row's wrench at the point where the row acts: there a row with a linear part is a pure impulse, and one
/// without is a pure angular impulse.
inline void add_row(const Vec3<Lanes>& linear, const Vec3<Lanes>& lever, const Lanes& lambda,
                    Wrench<Lanes>& sum)
{
    sum.push = sum.push + lambda * linear;
    const Lanes turns = select(dot(linear, linear) > Lanes(0), Lanes(0), lambda);
    sum.turn = sum.turn + turns * lever;
}

/// Locks of any kind: J on the child body, J on the parent body, and C. Few nodes have such rows, so their number is not a
/// constant: one loop serves all.
struct AnyRows {
    static constexpr int most = 6;
    int rows;
    Row6 child[most], parent[most];
    Lanes error[most], speed[most];
    [[nodiscard]] int count() const { return rows; }
    [[nodiscard]] Lanes speed_of(int i) const { return speed[i]; }

    /// of() reads EqualityRows, kept() what keep() has stored in their place.
    static AnyRows of(const float* from, int rows)
    {
        AnyRows out;
        out.rows = rows;
        for (int i = 0; i < rows; ++i) {
            const auto row = load_row<EqualityRow<Lanes>>(from + i * FigureNode::row_floats);
            put(row.linear, row.lever_b, out.child[i]);
            put(-row.linear, -row.lever_a, out.parent[i]);
            out.error[i] = row.error;
            out.speed[i] = row.speed;
        }
        return out;
    }
    static AnyRows kept(const float* from, int rows) { return of(from, rows); }
    void keep(float* to) const
    {
        for (int i = 0; i < rows; ++i)
            store_lanes(error[i], to + i * FigureNode::row_floats + 9 * block_lanes);
    }
    /// Entries of J on the child before first_entry(row) are 0. If reaches_parent(row, entry) is false, that entry of
    /// J on the parent is 0 in this row and in those before it.
    static constexpr int first_entry(int) { return 0; }
    static constexpr bool reaches_parent(int, int) { return true; }
    /// Whether a row may be that of a spring.
    static constexpr bool may_give(int) { return true; }

    void child_row(int i, Row6& out) const
    {
        for (int c = 0; c < 6; ++c) out[c] = child[i][c];
    }
    void parent_row(int i, Row6& out) const
    {
        for (int c = 0; c < 6; ++c) out[c] = parent[i][c];
    }
    [[nodiscard]] Lanes along_child(int i, const Row6& x) const { return dot6(child[i], x); }
    [[nodiscard]] Lanes along_parent(int i, const Row6& x) const { return dot6(parent[i], x); }
    /// x += J^T y of the parent body.
    void push_parent(const Lanes* y, Row6& x) const
    {
        for (int i = 0; i < rows; ++i)
            for (int c = 0; c < 6; ++c) x[c] = x[c] + y[i] * parent[i][c];
    }
    /// The wrench of the impulses lambda of rows [first, last) on the child body, at the point where they act.
    [[nodiscard]] Wrench<Lanes> wrench(const Lanes* lambda, int first, int last) const
    {
        const Vec3<Lanes> none{Lanes(0), Lanes(0), Lanes(0)};
        Wrench<Lanes> sum{none, none};
        for (int i = first; i < last; ++i)
            add_row({child[i][0], child[i][1], child[i][2]}, {child[i][3], child[i][4], child[i][5]},
                    lambda[i], sum);
        return sum;
    }
};

/// Three rows that hold a point on a point along x, y and z, and purely angular rows.
template <int rows>
struct PointRows {
    static constexpr int most = rows;
    static constexpr int turns = rows - 3;
    static constexpr auto count() { return Constant<rows>{}; }
    Vec3<Lanes> arm_child, arm_parent;
    Lanes error[rows];
    Vec3<Lanes> turn[turns > 0 ? turns : 1];  ///< angular rows: J on the child, and -J on the parent
    Lanes speed[turns > 0 ? turns : 1];       ///< of angular rows, the only ones that a motor may have
    Lanes speed_of(auto i) const
    {
        if constexpr (i() < 3) {
            return Lanes(0);
        } else {
            return speed[i() - 3];
        }
    }

    static PointRows of(const float* from, int)
    {
        PointRows out;
        unrolled<rows>([&](auto i) {
            out.error[i] = load_row<EqualityRow<Lanes>>(from + i * FigureNode::row_floats).error;
        });
        const auto x = load_row<EqualityRow<Lanes>>(from);
        const auto y = load_row<EqualityRow<Lanes>>(from + FigureNode::row_floats);
        out.arm_child = lever_of_point(x.lever_b, y.lever_b);
        out.arm_parent = lever_of_point(x.lever_a, y.lever_a);
        unrolled<turns>([&](auto i) {
            const auto row = load_row<EqualityRow<Lanes>>(from + (3 + i) * FigureNode::row_floats);
            out.turn[i] = row.lever_b;
            out.speed[i] = row.speed;
        });
        return out;
    }
    static PointRows kept(const float* from, int)
    {
        PointRows out;
        out.arm_child = load_row<Vec3<Lanes>>(from);
        out.arm_parent = load_row<Vec3<Lanes>>(from + 3 * block_lanes);
        load_array(from + 6 * block_lanes, out.error);
        unrolled<turns>(
            [&](auto i) { out.turn[i] = load_row<Vec3<Lanes>>(from + (6 + rows + 3 * i) * block_lanes); });
        unrolled<turns>(
            [&](auto i) { out.speed[i] = load_lanes(from + (6 + rows + 3 * turns + i) * block_lanes); });
        return out;
    }
    void keep(float* to) const
    {
        store_row(arm_child, to);
        store_row(arm_parent, to + 3 * block_lanes);
        store_array(error, to + 6 * block_lanes);
        unrolled<turns>([&](auto i) { store_row(turn[i], to + (6 + rows + 3 * i) * block_lanes); });
        unrolled<turns>(
            [&](auto i) { store_lanes(speed[i], to + (6 + rows + 3 * turns + i) * block_lanes); });
    }
    static constexpr int first_entry(int row) { return row < 3 ? row : 3; }
    static constexpr bool may_give(int row) { return row >= 3; }
    static constexpr bool reaches_parent(int row, int entry)
    {
        return entry < 3 ? entry <= row : row > 0 || entry != 3;
    }

    void child_row(auto i, Row6& out) const { whole_row(i, arm_child, out); }
    void parent_row(auto i, Row6& out) const
    {
        whole_row(i, arm_parent, out);
        unrolled<6>([&](auto c) { out[c] = -out[c]; });
    }
    Lanes along_child(auto i, const Row6& x) const { return along(i, arm_child, x); }
    Lanes along_parent(auto i, const Row6& x) const { return -along(i, arm_parent, x); }
    void push_parent(const Lanes* y, Row6& x) const
    {
        const Vec3<Lanes>& r = arm_parent;
        x[0] = x[0] - y[0];
        x[1] = x[1] - y[1];
        x[2] = x[2] - y[2];
        x[3] = (x[3] + y[1] * r.z) - y[2] * r.y;
        x[4] = (x[4] - y[0] * r.z) + y[2] * r.x;
        x[5] = (x[5] + y[0] * r.y) - y[1] * r.x;
        unrolled<turns>([&](auto i) {
            x[3] = x[3] - y[3 + i] * turn[i].x;
            x[4] = x[4] - y[3 + i] * turn[i].y;
            x[5] = x[5] - y[3 + i] * turn[i].z;
        });
    }
    /// The wrench of the node's only lock, whose rows end before `last`.
    [[nodiscard]] Wrench<Lanes> wrench(const Lanes* lambda, int, int last) const
    {
        Wrench<Lanes> sum{{lambda[0], lambda[1], lambda[2]}, {Lanes(0), Lanes(0), Lanes(0)}};
        unrolled<turns>([&](auto i) {
            if (3 + i < last) sum.turn = sum.turn + lambda[3 + i] * turn[i];
        });
        return sum;
    }

  private:
    void whole_row(auto i, const Vec3<Lanes>& r, Row6& out) const
    {
        const Lanes zero(0);
        unrolled<3>([&](auto c) { out[c] = i() == c() ? Lanes(1) : zero; });
        if constexpr (i() == 0) {
            out[3] = zero, out[4] = r.z, out[5] = -r.y;
        } else if constexpr (i() == 1) {
            out[3] = -r.z, out[4] = zero, out[5] = r.x;
        } else if constexpr (i() == 2) {
            out[3] = r.y, out[4] = -r.x, out[5] = zero;
        } else {
            out[3] = turn[i - 3].x, out[4] = turn[i - 3].y, out[5] = turn[i - 3].z;
        }
    }
    Lanes along(auto i, const Vec3<Lanes>& r, const Row6& x) const
    {
        if constexpr (i() == 0) {
            return x[0] + (r.z * x[4] - r.y * x[5]);
        } else if constexpr (i() == 1) {
            return (x[1] - r.z * x[3]) + r.x * x[5];
        } else if constexpr (i() == 2) {
            return (x[2] + r.y * x[3]) - r.x * x[4];
        } else {
            const Vec3<Lanes>& t = turn[i - 3];
            return t.x * x[3] + (t.y * x[4] + t.z * x[5]);
        }
    }
};
