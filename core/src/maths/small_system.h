// The few rows of one joint, solved exactly: K = L D L^T in lanes. Gauss-Seidel inside a joint does not converge for
// long levers, so a joint's rows are never solved one after another.
#pragma once

#include "maths/scalar.h"

namespace motley {

/// The factors of a symmetric positive semi-definite K of n rows.
template <class Real, int n>
struct SmallFactor {
    Real lower[n * (n - 1) / 2];  ///< of L, row by row below the diagonal
    Real inverse_diagonal[n];     ///< of D; 0 for a row that depends on those before it
};

template <class Real>
struct SmallFactor<Real, 1> {
    Real inverse_diagonal[1];
};

constexpr int below_diagonal(int row, int column)
{
    return row * (row - 1) / 2 + column;
}

/// Factors K, of which the lower triangle is read. A row whose diagonal is not above its floor cannot move; a row whose
/// pivot is lost in the rounding of its diagonal depends on the rows before it. Neither gets an impulse of its own.
template <class Real, int n>
SmallFactor<Real, n> factor(const Real (&k)[n][n], const Real (&floor)[n])
{
    SmallFactor<Real, n> f;
    Real diagonal[n];
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j < i; ++j) {
            Real sum = k[i][j];
            for (int m = 0; m < j; ++m)
                sum = sum - f.lower[below_diagonal(i, m)] * diagonal[m] * f.lower[below_diagonal(j, m)];
            f.lower[below_diagonal(i, j)] = sum * f.inverse_diagonal[j];
        }
        diagonal[i] = k[i][i];
        for (int m = 0; m < i; ++m) {
            const Real& l = f.lower[below_diagonal(i, m)];
            diagonal[i] = diagonal[i] - l * l * diagonal[m];
        }
        const auto usable = (diagonal[i] > Real(2e-6F) * k[i][i]) & (k[i][i] > floor[i]);
        f.inverse_diagonal[i] = select(usable, Real(1) / select(usable, diagonal[i], Real(1)), Real(0));
    }
    return f;
}

template <class Real>
SmallFactor<Real, 1> factor(const Real (&k)[1][1], const Real (&floor)[1])
{
    const auto usable = k[0][0] > floor[0];
    return {{select(usable, Real(1) / select(usable, k[0][0], Real(1)), Real(0))}};
}

/// K^-1 x in place.
template <class Real, int n>
void solve_in_place(const SmallFactor<Real, n>& f, Real (&x)[n])
{
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j < i; ++j) x[i] = x[i] - f.lower[below_diagonal(i, j)] * x[j];
    }
    for (int i = 0; i < n; ++i) x[i] = x[i] * f.inverse_diagonal[i];
    for (int i = n; i-- > 0;) {
        for (int j = i + 1; j < n; ++j) x[i] = x[i] - f.lower[below_diagonal(j, i)] * x[j];
    }
}

template <class Real>
void solve_in_place(const SmallFactor<Real, 1>& f, Real (&x)[1])
{
    x[0] = x[0] * f.inverse_diagonal[0];
}

}  // namespace motley
