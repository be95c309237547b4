// The inverse of the matrix of a few rows. Eigen's own solvers are made for large matrices: at six rows and fewer they take most of
// their time to find out how to divide them into parts.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <utility>

namespace motley::reference {

/// Inverts in place by Gauss and Jordan's elimination, with the largest pivot of each column; at most 12 rows. The inverse of a
/// singular matrix is not finite.
template <class Square>
void invert_small(Square& a)
{
    using Eigen::Index;
    using Column =
        Eigen::Matrix<double, Square::RowsAtCompileTime, 1, Eigen::ColMajor, Square::MaxRowsAtCompileTime, 1>;
    const Index rows = a.rows();
    std::array<Index, 12> pivots{};
    for (Index k = 0; k < rows; ++k) {
        Index pivot = k;
        for (Index i = k + 1; i < rows; ++i) {
            if (std::abs(a(i, k)) > std::abs(a(pivot, k))) pivot = i;
        }
        pivots[static_cast<std::size_t>(k)] = pivot;
        for (Index j = 0; j < rows && pivot != k; ++j) std::swap(a(k, j), a(pivot, j));
        // The column that is eliminated makes room for that of the inverse.
        const double over = 1 / a(k, k);
        Column others = a.col(k);
        others(k) = 0;
        a.col(k).setZero();
        a(k, k) = 1;
        for (Index j = 0; j < rows; ++j) {
            const double x = over * a(k, j);
            a.col(j) -= x * others;
            a(k, j) = x;
        }
    }
    // Exchanged rows are exchanged columns of the inverse.
    for (Index k = rows; k-- > 0;) {
        const Index pivot = pivots[static_cast<std::size_t>(k)];
        if (pivot != k) a.col(k).swap(a.col(pivot));
    }
}

}  // namespace motley::reference
