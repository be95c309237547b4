// The inverse of the matrix of a few rows. Eigen's own solvers are made for large matrices: at six rows and fewer they take most of
// their time to find out how to divide them into parts.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>

namespace motley::reference {

/// Inverts a matrix of bounded size in place by Gauss-Jordan elimination with row exchanges. The inverse of a singular matrix is not
/// finite.
template <class Square>
void invert_small(Square& a)
{
    using Eigen::Index;
    using Column =
        Eigen::Matrix<double, Square::RowsAtCompileTime, 1, Eigen::ColMajor, Square::MaxRowsAtCompileTime, 1>;
    const Index rows = a.rows();
    std::array<Index, Square::MaxRowsAtCompileTime> pivots{};
    for (Index k = 0; k < rows; ++k) {
        Index pivot = k;
        for (Index i = k + 1; i < rows; ++i) {
            if (std::abs(a(i, k)) > std::abs(a(pivot, k))) pivot = i;
        }
        pivots[static_cast<std::size_t>(k)] = pivot;
        if (pivot != k) a.row(k).swap(a.row(pivot));
        // Column k, which elimination makes a unit vector, is replaced by column k of the inverse.
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
    // Rows that were exchanged are columns of the inverse.
    for (Index k = rows; k-- > 0;) {
        const Index pivot = pivots[static_cast<std::size_t>(k)];
        if (pivot != k) a.col(k).swap(a.col(pivot));
    }
}

}  // namespace motley::reference
