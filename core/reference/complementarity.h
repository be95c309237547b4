// Linear complementarity with bounds and cones over the velocities of bodies, solved to the rounding of doubles.
#pragma once

#include <Eigen/Core>
#include <array>
#include <deque>
#include <vector>

namespace motley::reference {

/// The norm of lambda over `count` rows from `first` on is at most `bound`, or, where normal_count is above 0, `bound`
/// times the sum of lambda over these normal rows. Row indices are within the group.
struct Cone {
    int first = 0, count = 0;
    double bound = 0;
    int first_normal = 0, normal_count = 0;
};

/// Rows of one joint or contact, which cones and softness may couple in addition to their bodies.
struct RowGroup {
    static constexpr int most_rows = 12;
    template <int columns>
    using Rows = Eigen::Matrix<double, Eigen::Dynamic, columns,
                               columns == 1 ? Eigen::ColMajor : Eigen::RowMajor, most_rows, columns>;
    using Square =
        Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, most_rows, most_rows>;

    static constexpr std::size_t most_bodies = 3;
    std::array<int, most_bodies> bodies{-1, -1, -1};  ///< whose velocities the rows take; -1: no body
    std::array<Rows<6>, most_bodies> jacobian{};  ///< over velocities scaled such that every body's mass is 1
    Rows<1> offset{};                             ///< w without any impulse
    Rows<1> low{}, high{};
    Square softness{};  ///< Gamma, symmetric positive semi-definite; empty is zero
    std::vector<Cone> cones{};
    bool is_contact = false;  ///< two bodies may have more contact rows than degrees of freedom
    Rows<1> lambda{};         ///< a guess, then the solution

    [[nodiscard]] int size() const { return static_cast<int>(offset.size()); }
};

/// w = J y + Gamma lambda + offset with y = J^T lambda. low <= lambda <= high, w = 0 between the bounds, w >= 0 at the
/// low one and w <= 0 at the high one. Rows of a cone have no bounds of their own; at its edge w points against lambda.
struct Problem {
    int bodies = 0;
    std::deque<RowGroup> groups;  ///< which are large, so that they had better not be moved when more come
};

struct Solution {
    Eigen::VectorXd change;  ///< y, six numbers a body: change of scaled velocities by all impulses
    double violation =
        0;  ///< largest residual of the natural map, in units of w; infinite where an offset was not finite
    int unsolved = 0;  ///< islands with a violation above `solved_to`
};

/// What counts as solved, in the units of w.
inline constexpr double solved_to = 1e-9;

/// Solves each part of the problem that bodies connect by itself, starting from the guesses of the groups; parts that
/// have only equations start from zero, so that redundant rows get the impulses of least norm. Contradictory rows are
/// solved in the least squares sense, and `violation` says how far they are from being met.
Solution solve(Problem& problem);

}  // namespace motley::reference
