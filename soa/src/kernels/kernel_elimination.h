// Symmetric systems of a figure, K = L D L^T, in lanes. Included inside an anonymous namespace, after kernel_tree_rows.h.
//
// The entries of a triangle are its lower half with the diagonal: first K, then L below the diagonal and 1 / D on it. Those
// of a node of the tree are in registers, and their number is a constant; those of closures are in memory. What is done about a
// pivot that rounding has spoilt is the caller's business. (Rows of one joint are factored by maths/small_system.h, which
// takes its products in another order: its bits are others.)
#pragma once

/// The index of an entry of a triangle that is stored row by row.
constexpr int in_triangle(int row, int column)
{
    return row * (row + 1) / 2 + column;
}

/// In registers.
template <int n>
struct Triangle {
    Lanes entry[n * (n + 1) / 2];
    Lanes& at(int row, int column) { return entry[in_triangle(row, column)]; }
    const Lanes& at(int row, int column) const { return entry[in_triangle(row, column)]; }
    [[nodiscard]] const Lanes& get(int row, int column) const { return at(row, column); }
    void set(int row, int column, const Lanes& value) { at(row, column) = value; }
};

template <int n>
struct Column {
    Lanes (&entry)[n];
    [[nodiscard]] const Lanes& get(int row) const { return entry[row]; }
    void set(int row, const Lanes& value) const { entry[row] = value; }
};

/// In memory.
struct StoredTriangle {
    float* entries;
    [[nodiscard]] Lanes get(int row, int column) const
    {
        return load_lanes(entries + in_triangle(row, column) * block_lanes);
    }
    void set(int row, int column, const Lanes& value) const
    {
        store_lanes(value, entries + in_triangle(row, column) * block_lanes);
    }
};
struct StoredColumn {
    float* entries;
    [[nodiscard]] Lanes get(int row) const { return load_lanes(entries + row * block_lanes); }
    void set(int row, const Lanes& value) const { store_lanes(value, entries + row * block_lanes); }
};

/// Factors K of n rows in place. inverse_of(i, pivot) returns 1 / D of row i, or 0 for a row without a pivot.
template <class Count, class Entries, class Inverse>
[[gnu::always_inline]] inline void factor_in_place(Count n, Entries& k, const Inverse& inverse_of)
{
    repeat(n, [&](auto i) {
        repeat(i, [&](auto j) {
            Lanes scaled = k.get(i, j);  // entry of L D, until the row is done
            repeat(j, [&](auto m) { scaled = scaled - k.get(i, m) * k.get(j, m); });
            k.set(i, j, scaled);
        });
        Lanes pivot = k.get(i, i);
        repeat(i, [&](auto j) {
            const Lanes scaled = k.get(i, j), l = scaled * k.get(j, j);
            pivot = pivot - scaled * l;
            k.set(i, j, l);
        });
        k.set(i, i, inverse_of(i, pivot));
    });
}

/// K^-1 x in place, n rows; entries of x before `first` are 0. keep(i, value) returns what entry i becomes.
template <class Count, class Entries, class Vector, class Keep>
[[gnu::always_inline]] inline void solve_in_place(Count n, const Entries& f, const Vector& x,
                                                  const Keep& keep, int first = 0)
{
    repeat(n, [&](auto i) {
        Lanes value = x.get(i);
        repeat(i, [&](auto j) {
            if (j >= first) value = value - f.get(i, j) * x.get(j);
        });
        x.set(i, value);
    });
    repeat(n, [&](auto back) {
        const int i = n - 1 - back;
        Lanes value = x.get(i) * f.get(i, i);
        repeat(back, [&](auto j) { value = value - f.get(i + 1 + j, i) * x.get(i + 1 + j); });
        x.set(i, keep(i, value));
    });
}
template <class Count, int n>
[[gnu::always_inline]] inline void solve_in_place(Count rows, const Triangle<n>& f, Lanes (&x)[n],
                                                  int first = 0)
{
    solve_in_place(
        rows, f, Column<n>{x}, [](int, const Lanes& value) { return value; }, first);
}
