// The modes of small symmetric matrices. Eigen's decompositions are made for large ones: the three that would be used here took most
// of the time to compile this folder, and a fifth of its code.
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace motley::reference {

/// s = vectors diag(values) vectors^T for a symmetric s, by rotations that make one pair of off-diagonal elements zero at a time
/// (C. G. J. Jacobi 1846; G. Golub and C. Van Loan, Matrix Computations, 8.5). The values are not sorted. Of a matrix that is not
/// finite, they are not finite.
template <class Square>
struct SymmetricModes {
    Square vectors;
    Eigen::Matrix<double, Square::RowsAtCompileTime, 1> values;

    explicit SymmetricModes(Square s) : vectors(Square::Identity(s.rows(), s.cols()))
    {
        using Eigen::Index;
        constexpr int most_sweeps = 50;
        const double negligible = 1e-34 * s.squaredNorm();
        const auto rotate = [](auto p, auto q, double cosine, double sine) {
            for (Index k = 0; k < p.size(); ++k) {
                const double old = p(k);
                p(k) = cosine * old - sine * q(k);
                q(k) = sine * old + cosine * q(k);
            }
        };
        for (int sweep = 0; sweep < most_sweeps; ++sweep) {
            double beside = 0;
            for (Index p = 0; p < s.rows(); ++p) {
                for (Index q = p + 1; q < s.rows(); ++q) {
                    if (s(p, q) == 0) continue;
                    beside += s(p, q) * s(p, q);
                    const double ratio = (s(q, q) - s(p, p)) / (2 * s(p, q));
                    const double length = std::abs(ratio) + std::sqrt(ratio * ratio + 1);
                    const double tangent = std::copysign(1 / length, ratio);
                    const double cosine = 1 / std::sqrt(tangent * tangent + 1), sine = tangent * cosine;
                    rotate(s.col(p), s.col(q), cosine, sine);
                    rotate(s.row(p), s.row(q), cosine, sine);
                    rotate(vectors.col(p), vectors.col(q), cosine, sine);
                }
            }
            if (!(beside > negligible)) break;
        }
        values = s.diagonal();
    }
};

/// The Moore-Penrose inverse of a symmetric matrix. Values that are only the rounding of the largest one count as 0.
template <class Square>
Square symmetric_pseudo_inverse(const Square& s)
{
    const SymmetricModes<Square> modes(s);
    const double least = 4e-16 * static_cast<double>(s.rows()) * modes.values.cwiseAbs().maxCoeff();
    Square inverse = Square::Zero(s.rows(), s.cols());
    for (Eigen::Index mode = 0; mode < s.rows(); ++mode) {
        const double value = modes.values(mode);
        if (std::abs(value) <= least) continue;
        for (Eigen::Index j = 0; j < s.cols(); ++j)
            inverse.col(j) += modes.vectors(j, mode) / value * modes.vectors.col(mode);
    }
    return inverse;
}

}  // namespace motley::reference
