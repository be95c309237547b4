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
    Column over = Column::Zero(rows);  // 1 / pivot
    // Columns are shortened by zeros, so that those of a fixed size stay so.
    for (Index k = 0; k < rows; ++k) {
        Index pivot = k;
        for (Index i = k + 1; i < rows; ++i) {
            if (std::abs(a(i, k)) > std::abs(a(pivot, k))) pivot = i;
        }
        if (pivot != k) {
            a.row(k).swap(a.row(pivot));
            b.row(k).swap(b.row(pivot));
        }
        over(k) = 1 / a(k, k);
        Column below = over(k) * a.col(k);
        below.head(k + 1).setZero();
        for (Index j = k + 1; j < rows; ++j) a.col(j) -= a(k, j) * below;
        for (Index j = 0; j < columns; ++j) b.col(j) -= b(k, j) * below;
    }
    for (Index k = rows; k-- > 0;) {
        Column above = a.col(k);
        above.tail(rows - k).setZero();
        for (Index j = 0; j < columns; ++j) {
            b(k, j) *= over(k);
            b.col(j) -= b(k, j) * above;
        }
    }
}

}  // namespace motley::reference
