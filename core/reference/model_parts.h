// What several models of joints are made of.
#pragma once

#include <algorithm>

#include "as_eigen.h"
#include "motley/reference/constraints.h"
#include "motley/reference/joint_models.h"

namespace motley::reference {

inline Eigen::VectorXd scalar(double value)
{
    return Eigen::VectorXd::Constant(1, value);
}

/// lower <= C <= upper: the nearer end as an inequality, or an equation where both are equal.
inline Block limit_block(const Jacobian& jacobian, double value, double lower, double upper)
{
    const double above = value - lower, below = upper - value;
    Block block{.jacobian = jacobian, .error = scalar(above)};
    if (lower == upper) return block;
    block.kind = Block::Kind::limit;
    block.side = above < below ? 1 : -1;
    block.error = scalar(std::min(above, below));
    return block;
}

/// Both impulses of a locked point act midway between the anchors.
inline Block::Point midway(const Body& a, const Body& b, const Eigen::Vector3d& local_a,
                           const Eigen::Vector3d& local_b)
{
    const Eigen::Vector3d half = point_error(a, b, local_a, local_b) / 2;
    return {a.orientation * local_a + half, b.orientation * local_b - half};
}

}  // namespace motley::reference
