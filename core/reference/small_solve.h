// Gaussian elimination for the few rows of a joint or body. Eigen's own solvers are made for large matrices: at six rows and fewer
// they take most of their time to find out how to divide them into parts.
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace motley::reference {

/// Solves a x = b in place, with the largest pivot of each column: `b` becomes x, and `a` is lost. Where `a` is singular, x is not
/// finite.
template <class Square, class Columns>
void solve_small(Square& a, Columns& b)
{
    using Eigen::Index;
    using Column =
        Eigen::Matrix<double, Square::RowsAtCompileTime, 1, Eigen::ColMajor, Square::MaxRowsAtCompileTime, 1>;
    const Index rows = a.rows(), columns = b.cols();
    for (Index k = 0; k < rows; ++k) {
        Index pivot = k;
        for (Index i = k + 1; i < rows; ++i) {
            if (std::abs(a(i, k)) > std::abs(a(pivot, k))) pivot = i;
        }
        if (pivot != k) {
            a.row(k).swap(a.row(pivot));
            b.row(k).swap(b.row(pivot));
        }
        const double over = 1 / a(k, k);
        Column others = a.col(k);
        others(k) = 0;
        const auto eliminate = [&](auto column) {
            const double x = over * column(k);
            column -= x * others;
            column(k) = x;
        };
        for (Index j = k + 1; j < rows; ++j) eliminate(a.col(j));
        for (Index j = 0; j < columns; ++j) eliminate(b.col(j));
    }
}

}  // namespace motley::reference
