// The rows of the textbook.
#include "motley/reference/constraints.h"

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

Eigen::MatrixXd effective_mass(const Jacobian& jacobian, const Body& a, const Body& b)
{
    const Eigen::MatrixXd k = jacobian * pair_inverse_mass(a, b) * jacobian.transpose();
    return k.completeOrthogonalDecomposition().pseudoInverse();
}

}  // namespace motley::reference
