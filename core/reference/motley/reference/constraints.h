// Constraint functions C and their Jacobians, as the textbook has them: dense, in double, over the generalised
// velocity (v_a, omega_a, v_b, omega_b). Nothing here is shared with the lanes.
#pragma once

#include "motley/core/constraints/contact_definition.h"
#include "motley/core/constraints/drive_definition.h"
#include "motley/core/constraints/frame_joint_definition.h"
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
/// The same with both arms to the midpoint between the anchors, as used by joints that lock a point: equal and opposite
/// impulses there have no moment together. J v is the rate of C in a frame that turns with the mean of both angular
/// velocities.
Jacobian lock_jacobian(const Body& a, const Body& b, const Eigen::Vector3d& local_a,
                       const Eigen::Vector3d& local_b);

/// C = |p_b - p_a| - length; the axis is x where the points coincide.
double distance_error(const Body& a, const Body& b, const Eigen::Vector3d& local_a,
                      const Eigen::Vector3d& local_b, double length);
/// [-u, -r_a x u, u, r_b x u].
Jacobian distance_jacobian(const Body& a, const Body& b, const Eigen::Vector3d& local_a,
                           const Eigen::Vector3d& local_b);

/// A frame on a body, in the frame of the body.
struct Frame {
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
};
/// The locked coordinates of frame b in frame a: of a point all of d (world), of a line d along y and z of a, of a
/// plane d along x; of all rotations 2 vec(q_a* q_b) with w >= 0, of swing x_b along y and z of a, of perpendicular
/// axes x_a . y_b.
Eigen::VectorXd frame_error(const Body& a, const Body& b, const Frame& frame_a, const Frame& frame_b,
                            LinearLock linear, AngularLock angular);
/// Rows [-e, -(r_a + d) x e, e, r_b x e] and [0, -g, 0, g].
Jacobian frame_jacobian(const Body& a, const Body& b, const Frame& frame_a, const Frame& frame_b,
                        LinearLock linear, AngularLock angular);

/// The coordinate of a drive: the position of b's frame along x of a's frame, its rotation about the x axis that the
/// frames share, or the Euler angle `angle`.
double drive_value(const Body& a, const Body& b, const Frame& frame_a, const Frame& frame_b, DriveAxis axis,
                   EulerAngle angle = EulerAngle::x);
/// [-x, -(r_a + d) x x, x, r_b x x] of a slide, or [0, -t, 0, t], of a twist with t = (x_a + x_b) / (1 + x_a . x_b).
Jacobian drive_jacobian(const Body& a, const Body& b, const Frame& frame_a, const Frame& frame_b,
                        DriveAxis axis, EulerAngle angle = EulerAngle::x);

/// The angle between the x axes of the frames, and its row [0, -n, 0, n], n = x_a x x_b / |x_a x x_b|.
double swing_angle(const Body& a, const Body& b, const Frame& frame_a, const Frame& frame_b);
Jacobian swing_jacobian(const Body& a, const Body& b, const Frame& frame_a, const Frame& frame_b);

/// [-n, -r_a x n, n, r_b x n]: the row of any direction at a contact, normal or tangent.
Jacobian direction_jacobian(const Eigen::Vector3d& direction, const Eigen::Vector3d& arm_a,
                            const Eigen::Vector3d& arm_b);

/// The Moore-Penrose inverse, from that of m m^T: of rows that are nearly dependent it has half of the digits.
Eigen::MatrixXd pseudo_inverse(const Eigen::MatrixXd& m);

/// M^-1 of a pair, 12 x 12.
Eigen::Matrix<double, 12, 12> pair_inverse_mass(const Body& a, const Body& b);
/// J M^-1 J^T: what the rows of J answer to their own impulses.
Eigen::MatrixXd response(const Jacobian& jacobian, const Eigen::Matrix<double, 12, 12>& inverse_mass);
/// (J M^-1 J^T)^+: the pseudo-inverse, so that directions in which no body can move get no impulse.
Eigen::MatrixXd effective_mass(const Jacobian& jacobian, const Body& a, const Body& b);

}  // namespace motley::reference
