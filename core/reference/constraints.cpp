// Constraint functions and their Jacobians, as in textbooks.
#include "motley/reference/constraints.h"

#include "symmetric_modes.h"

namespace motley::reference {
namespace {

Eigen::Vector3d arm(const Body& body, const Eigen::Vector3d& local)
{
    return body.orientation * local;
}

}  // namespace

Eigen::Vector3d point_error(const Body& a, const Body& b, const Eigen::Vector3d& local_a,
                            const Eigen::Vector3d& local_b)
{
    return b.position + arm(b, local_b) - a.position - arm(a, local_a);
}

Jacobian point_jacobian(const Body& a, const Body& b, const Eigen::Vector3d& local_a,
                        const Eigen::Vector3d& local_b)
{
    Jacobian j(3, 12);
    const Eigen::Matrix3d one = Eigen::Matrix3d::Identity();
    j << -one, skew(arm(a, local_a)), one, -skew(arm(b, local_b));
    return j;
}

Jacobian lock_jacobian(const Body& a, const Body& b, const Eigen::Vector3d& local_a,
                       const Eigen::Vector3d& local_b)
{
    Jacobian j(3, 12);
    const Eigen::Matrix3d one = Eigen::Matrix3d::Identity();
    const Eigen::Vector3d half = point_error(a, b, local_a, local_b) / 2;
    j << -one, skew(arm(a, local_a) + half), one, -skew(arm(b, local_b) - half);
    return j;
}

double distance_error(const Body& a, const Body& b, const Eigen::Vector3d& local_a,
                      const Eigen::Vector3d& local_b, double length)
{
    return point_error(a, b, local_a, local_b).norm() - length;
}

Jacobian distance_jacobian(const Body& a, const Body& b, const Eigen::Vector3d& local_a,
                           const Eigen::Vector3d& local_b)
{
    const Eigen::Vector3d d = point_error(a, b, local_a, local_b);
    const Eigen::Vector3d u = d.norm() > 1e-9 ? Eigen::Vector3d(d.normalized()) : Eigen::Vector3d::UnitX();
    return direction_jacobian(u, arm(a, local_a), arm(b, local_b));
}

Eigen::VectorXd frame_error(const Body& a, const Body& b, const Frame& frame_a, const Frame& frame_b,
                            LinearLock linear, AngularLock angular)
{
    const Eigen::Matrix3d axes_a = (a.orientation * frame_a.rotation).toRotationMatrix();
    const Eigen::Matrix3d axes_b = (b.orientation * frame_b.rotation).toRotationMatrix();
    const Eigen::Vector3d d = point_error(a, b, frame_a.position, frame_b.position);
    Eigen::VectorXd error(static_cast<int>(linear) + static_cast<int>(angular));
    if (linear == LinearLock::point) error.head<3>() = d;
    if (linear == LinearLock::line) error.head<2>() = axes_a.rightCols<2>().transpose() * d;
    if (linear == LinearLock::plane) error(0) = axes_a.col(0).dot(d);
    if (angular == AngularLock::all) {
        Eigen::Quaterniond q =
            (a.orientation * frame_a.rotation).conjugate() * (b.orientation * frame_b.rotation);
        if (q.w() < 0) q.coeffs() = -q.coeffs();
        error.tail<3>() = 2 * q.vec();
    }
    if (angular == AngularLock::swing) error.tail<2>() = axes_a.rightCols<2>().transpose() * axes_b.col(0);
    if (angular == AngularLock::perpendicular) error.tail<1>()(0) = axes_a.col(0).dot(axes_b.col(1));
    return error;
}

Jacobian frame_jacobian(const Body& a, const Body& b, const Frame& frame_a, const Frame& frame_b,
                        LinearLock linear, AngularLock angular)
{
    const Eigen::Quaterniond rotation_a = a.orientation * frame_a.rotation;
    const Eigen::Matrix3d axes_a = rotation_a.toRotationMatrix();
    const Eigen::Matrix3d axes_b = (b.orientation * frame_b.rotation).toRotationMatrix();
    const Eigen::Vector3d d = point_error(a, b, frame_a.position, frame_b.position);
    const int linear_rows = static_cast<int>(linear), angular_rows = static_cast<int>(angular);
    Jacobian j = Jacobian::Zero(linear_rows + angular_rows, 12);
    if (linear == LinearLock::point) {
        j.topRows<3>() = lock_jacobian(a, b, frame_a.position, frame_b.position);
    } else {
        const int first_axis = linear == LinearLock::line ? 1 : 0;
        for (int i = 0; i < linear_rows; ++i) {
            j.row(i) = direction_jacobian(axes_a.col(first_axis + i), arm(a, frame_a.position) + d,
                                          arm(b, frame_b.position));
        }
    }
    Eigen::MatrixXd g(angular_rows, 3);
    if (angular == AngularLock::all) {
        Eigen::Quaterniond q = rotation_a.conjugate() * (b.orientation * frame_b.rotation);
        if (q.w() < 0) q.coeffs() = -q.coeffs();
        g = (q.w() * Eigen::Matrix3d::Identity() - skew(q.vec())) * axes_a.transpose();
    } else if (angular == AngularLock::swing) {
        g.row(0) = axes_b.col(0).cross(axes_a.col(1)).transpose();
        g.row(1) = axes_b.col(0).cross(axes_a.col(2)).transpose();
    } else if (angular == AngularLock::perpendicular) {
        g.row(0) = axes_b.col(1).cross(axes_a.col(0)).transpose();
    }
    j.block(linear_rows, 3, angular_rows, 3) = -g;
    j.block(linear_rows, 9, angular_rows, 3) = g;
    return j;
}

namespace {

/// Angles of R = R_x R_y R_z.
Eigen::Vector3d euler_angles(const Eigen::Matrix3d& r)
{
    return {std::atan2(-r(1, 2), r(2, 2)), std::atan2(r(0, 2), std::hypot(r(0, 0), r(0, 1))),
            std::atan2(-r(0, 1), r(0, 0))};
}

/// The angular velocity of b relative to a is E (x', y', z')^T, where the columns of E are the axes of a chain of three
/// hinges that makes this rotation and x', y', z' the rates of its angles. This is the row of E^-1 of an angle, over
/// angular velocities in the world frame.
Eigen::RowVector3d euler_row(const Eigen::Matrix3d& rotation_a, const Eigen::Matrix3d& rotation_b,
                             EulerAngle angle)
{
    using Eigen::AngleAxisd, Eigen::Vector3d;
    const Vector3d angles = euler_angles(rotation_a.transpose() * rotation_b);
    const Eigen::Quaterniond first(AngleAxisd(angles.x(), Vector3d::UnitX()));
    const Eigen::Quaterniond second = first * AngleAxisd(angles.y(), Vector3d::UnitY());
    Eigen::Matrix3d axes;
    axes << Vector3d::UnitX(), first * Vector3d::UnitY(), second * Vector3d::UnitZ();
    const Eigen::Matrix3d rows = axes.inverse() * rotation_a.transpose();
    return rows.row(static_cast<int>(angle));
}

}  // namespace

double drive_value(const Body& a, const Body& b, const Frame& frame_a, const Frame& frame_b, DriveAxis axis,
                   EulerAngle angle)
{
    const Eigen::Quaterniond rotation_a = a.orientation * frame_a.rotation;
    if (axis == DriveAxis::euler) {
        const Eigen::Quaterniond q = rotation_a.conjugate() * (b.orientation * frame_b.rotation);
        return euler_angles(q.toRotationMatrix())(static_cast<int>(angle));
    }
    if (axis == DriveAxis::slide) {
        return (rotation_a * Eigen::Vector3d::UnitX())
            .dot(point_error(a, b, frame_a.position, frame_b.position));
    }
    const Eigen::Quaterniond q = rotation_a.conjugate() * (b.orientation * frame_b.rotation);
    return 2 * std::atan2(q.w() < 0 ? -q.x() : q.x(), std::abs(q.w()));
}

Jacobian drive_jacobian(const Body& a, const Body& b, const Frame& frame_a, const Frame& frame_b,
                        DriveAxis axis, EulerAngle angle)
{
    const Eigen::Vector3d x_a = a.orientation * (frame_a.rotation * Eigen::Vector3d::UnitX());
    const Eigen::Vector3d x_b = b.orientation * (frame_b.rotation * Eigen::Vector3d::UnitX());
    if (axis == DriveAxis::slide) {
        const Eigen::Vector3d d = point_error(a, b, frame_a.position, frame_b.position);
        return direction_jacobian(x_a, arm(a, frame_a.position) + d, arm(b, frame_b.position));
    }
    Eigen::Vector3d t = (x_a + x_b) / (1 + x_a.dot(x_b));
    if (axis == DriveAxis::euler) {
        t = euler_row((a.orientation * frame_a.rotation).toRotationMatrix(),
                      (b.orientation * frame_b.rotation).toRotationMatrix(), angle)
                .transpose();
    }
    Jacobian j = Jacobian::Zero(1, 12);
    j.block<1, 3>(0, 3) = -t.transpose();
    j.block<1, 3>(0, 9) = t.transpose();
    return j;
}

double swing_angle(const Body& a, const Body& b, const Frame& frame_a, const Frame& frame_b)
{
    const Eigen::Vector3d x_a = a.orientation * (frame_a.rotation * Eigen::Vector3d::UnitX());
    const Eigen::Vector3d x_b = b.orientation * (frame_b.rotation * Eigen::Vector3d::UnitX());
    return std::atan2(x_a.cross(x_b).norm(), x_a.dot(x_b));
}

Jacobian swing_jacobian(const Body& a, const Body& b, const Frame& frame_a, const Frame& frame_b)
{
    const Eigen::Vector3d x_a = a.orientation * (frame_a.rotation * Eigen::Vector3d::UnitX());
    const Eigen::Vector3d x_b = b.orientation * (frame_b.rotation * Eigen::Vector3d::UnitX());
    Jacobian j = Jacobian::Zero(1, 12);
    const Eigen::Vector3d n = x_a.cross(x_b).stableNormalized();
    j.block<1, 3>(0, 3) = -n.transpose();
    j.block<1, 3>(0, 9) = n.transpose();
    return j;
}

Jacobian direction_jacobian(const Eigen::Vector3d& direction, const Eigen::Vector3d& arm_a,
                            const Eigen::Vector3d& arm_b)
{
    Jacobian j(1, 12);
    j << -direction.transpose(), -arm_a.cross(direction).transpose(), direction.transpose(),
        arm_b.cross(direction).transpose();
    return j;
}

Eigen::Matrix<double, 12, 12> pair_inverse_mass(const Body& a, const Body& b)
{
    Eigen::Matrix<double, 12, 12> m = Eigen::Matrix<double, 12, 12>::Zero();
    m.topLeftCorner<6, 6>() = a.inverse_mass();
    m.bottomRightCorner<6, 6>() = b.inverse_mass();
    return m;
}

Eigen::MatrixXd pseudo_inverse(const Eigen::MatrixXd& m)
{
    const Eigen::MatrixXd square = m.lazyProduct(m.transpose());
    return m.transpose().lazyProduct(symmetric_pseudo_inverse(square));
}

Eigen::MatrixXd response(const Jacobian& jacobian, const Eigen::Matrix<double, 12, 12>& inverse_mass)
{
    // For these few rows Eigen's ordinary product would be slower, and far larger.
    const Jacobian moved = jacobian.lazyProduct(inverse_mass);
    return moved.lazyProduct(jacobian.transpose());
}

Eigen::MatrixXd effective_mass(const Jacobian& jacobian, const Body& a, const Body& b)
{
    const Eigen::Matrix<double, 12, 12> inverse_mass = pair_inverse_mass(a, b);
    const Eigen::MatrixXd k = response(jacobian, inverse_mass);
    // Rows along which the pair cannot move: K is only rounding, and must not be inverted.
    if (k.diagonal().maxCoeff() < 1e-12 * inverse_mass.diagonal().maxCoeff())
        return Eigen::MatrixXd::Zero(k.rows(), k.cols());
    return symmetric_pseudo_inverse(k);
}

}  // namespace motley::reference
