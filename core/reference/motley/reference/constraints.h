// Constraint functions C and their Jacobians, as the textbook has them: dense, in double, over the generalised
// velocity (v_a, omega_a, v_b, omega_b). Nothing here is shared with the lanes.
#pragma once

#include "motley/core/constraints/contact_definition.h"
#include "motley/reference/body.h"

namespace motley::reference {

/// m rows of J, each over twelve velocities.
using Jacobian = Eigen::Matrix<double, Eigen::Dynamic, 12>;

/// C = p_b - p_a.
Eigen::Vector3d point_error(const Body& a, const Body& b, const Eigen::Vector3d& local_a,
                            const Eigen::Vector3d& local_b);
/// [-I, [r_a]x, I, -[r_b]x].
Jacobian point_jacobian(const Body& a, const Body& b, const Eigen::Vector3d& local_a,
                        const Eigen::Vector3d& local_b);

/// C = |p_b - p_a| - length; the axis is x where the points coincide.
double distance_error(const Body& a, const Body& b, const Eigen::Vector3d& local_a,
                      const Eigen::Vector3d& local_b, double length);
/// [-u, -r_a x u, u, r_b x u].
Jacobian distance_jacobian(const Body& a, const Body& b, const Eigen::Vector3d& local_a,
                           const Eigen::Vector3d& local_b);

/// [-n, -r_a x n, n, r_b x n]: the row of any direction at a contact, normal or tangent.
Jacobian direction_jacobian(const Eigen::Vector3d& direction, const Eigen::Vector3d& arm_a,
                            const Eigen::Vector3d& arm_b);

/// M^-1 of a pair, 12 x 12.
Eigen::Matrix<double, 12, 12> pair_inverse_mass(const Body& a, const Body& b);
/// (J M^-1 J^T)^+: the pseudo-inverse, so that directions nobody can move along take no impulse.
Eigen::MatrixXd effective_mass(const Jacobian& jacobian, const Body& a, const Body& b);

}  // namespace motley::reference
