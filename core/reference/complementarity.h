// Linear complementarity with bounds and cones, solved to the rounding of doubles.
#pragma once

#include <Eigen/SparseCore>
#include <vector>

namespace motley::reference {

/// |lambda[first .. first + count)| <= bound, or <= bound times the sum of lambda over the normals where there are any.
struct Cone {
    Eigen::Index first = 0, count = 0;
    double bound = 0;
    std::vector<Eigen::Index> normals{};
};

/// w = A lambda + q, A symmetric positive semi-definite. low <= lambda <= high, w = 0 between the bounds, w >= 0 at the
/// low one and w <= 0 at the high one. Rows of a cone have no bounds of their own; at its edge w points against lambda.
struct Problem {
    Eigen::SparseMatrix<double> a;
    Eigen::VectorXd q;
    std::vector<double> low, high;
    std::vector<Cone> cones;
};

struct Solution {
    Eigen::VectorXd lambda;
    double violation = 0;  ///< largest of the natural map, in the units of w; infinite where q was not finite
};

/// Solves each part of the problem that hangs together on its own. Redundant rows share their impulse with the least
/// norm; contradictory ones are met in the least squares, and the violation says by how much not.
Solution solve(const Problem& problem);

}  // namespace motley::reference
