// Builds a complementarity problem from rows between bodies.
#pragma once

#include <cmath>
#include <limits>
#include <vector>

#include "complementarity.h"
#include "motley/reference/joint.h"

namespace motley::reference {

constexpr double unbounded = std::numeric_limits<double>::infinity();

/// The scaling S of a body, with S S^T = M^-1: for scaled velocities y = S^-1 v every body's mass is 1.
struct Scale {
    Eigen::Vector3d linear = Eigen::Vector3d::Zero();
    Eigen::Matrix3d angular = Eigen::Matrix3d::Zero();

    Scale() = default;
    explicit Scale(const Body& body)
    {
        const Matrix6 inverse_mass = body.inverse_mass();
        linear = inverse_mass.diagonal().head<3>().cwiseSqrt();
        // The Cholesky factor of I^-1, with zeros where the body does not turn.
        for (Eigen::Index i = 0; i < 3; ++i) {
            for (Eigen::Index k = 0; k <= i; ++k) {
                const double rest =
                    inverse_mass(3 + i, 3 + k) - angular.row(i).head(k).dot(angular.row(k).head(k));
                if (i == k)
                    angular(i, i) = std::sqrt(std::max(rest, 0.0));
                else if (angular(k, k) > 0)
                    angular(i, k) = rest / angular(k, k);
            }
        }
    }
};

class Assembly {
  public:
    explicit Assembly(const std::vector<Body>& bodies) : bodies_(bodies)
    {
        scales_.reserve(bodies.size());
        for (const Body& body : bodies) scales_.emplace_back(body);
        problem_.bodies = static_cast<int>(bodies.size());
    }

    /// Adds a group of `rows` rows between two bodies, which are zero until they are filled. Returns its index.
    std::size_t open(int a, int b, Eigen::Index rows)
    {
        RowGroup& group = problem_.groups.emplace_back();
        for (const auto& [side, body] : {std::pair{0U, a}, std::pair{1U, b}}) {
            const bool moves = bodies_[static_cast<std::size_t>(body)].motion == BodyMotion::dynamic_body;
            group.bodies[side] = moves ? body : -1;
            group.jacobian[side].setZero(rows, 6);
        }
        for (RowGroup::Rows<1>* column : {&group.offset, &group.low, &group.high, &group.lambda})
            column->setZero(rows);
        return problem_.groups.size() - 1;
    }
    /// Fills rows of a group from `first` on: their impulses are within [low, high], and w is `offset` without any
    /// impulse.
    void fill(std::size_t at, Eigen::Index first, const Jacobian& rows, const Eigen::VectorXd& offset,
              double low, double high, const Eigen::VectorXd& guess)
    {
        RowGroup& group = problem_.groups[at];
        const Eigen::Index count = rows.rows();
        group.offset.segment(first, count) = offset;
        group.low.segment(first, count).setConstant(low);
        group.high.segment(first, count).setConstant(high);
        group.lambda.segment(first, count) = guess;
        for (std::size_t side = 0; side < 2; ++side) {
            if (group.bodies[side] < 0) continue;
            const Scale& scale = scales_[static_cast<std::size_t>(group.bodies[side])];
            const auto from = static_cast<Eigen::Index>(6 * side);
            auto into = group.jacobian[side].middleRows(first, count);
            into.leftCols<3>() = rows.middleCols<3>(from) * scale.linear.asDiagonal();
            into.rightCols<3>() = rows.middleCols<3>(from + 3) * scale.angular;
        }
    }
    /// Softens rows of a group by a share of their own J M^-1 J^T.
    void soften(std::size_t at, Eigen::Index first, Eigen::Index count, double share)
    {
        if (share == 0) return;
        RowGroup& group = problem_.groups[at];
        if (group.softness.size() == 0) group.softness.setZero(group.size(), group.size());
        for (const auto& jacobian : group.jacobian) {
            if (jacobian.rows() == 0) continue;  // of no body
            const auto rows = jacobian.middleRows(first, count);
            group.softness.block(first, first, count, count) += share * rows.lazyProduct(rows.transpose());
        }
    }
    [[nodiscard]] RowGroup& group(std::size_t at) { return problem_.groups[at]; }

    /// Adds an artificial body that can only turn, with this moment of inertia about every axis. Returns its index.
    int add_spin(double inertia)
    {
        scales_.emplace_back();
        scales_.back().angular = Eigen::Matrix3d::Identity() / std::sqrt(inertia);
        return problem_.bodies++;
    }
    [[nodiscard]] const Scale& scale(std::size_t body) const { return scales_[body]; }

    Solution solve() { return reference::solve(problem_); }
    /// The change of a body's velocity by a solution.
    [[nodiscard]] Vector6 change(const Solution& solution, std::size_t body) const
    {
        const Vector6 y = solution.change.segment<6>(6 * static_cast<Eigen::Index>(body));
        Vector6 v;
        v << scales_[body].linear.cwiseProduct(y.head<3>()), scales_[body].angular * y.tail<3>();
        return v;
    }

  private:
    const std::vector<Body>& bodies_;
    std::vector<Scale> scales_;
    Problem problem_;
};

}  // namespace motley::reference
