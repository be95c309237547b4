// A body of the reference: state in double, inverse mass as an explicit 6 x 6 matrix in the world.
#pragma once

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <optional>

#include "motley/core/body.h"

namespace motley::reference {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// tr(I I'^-1) - 3 of a rotation that takes the inertia I to I': up to this, responses may stay as they were computed.
inline constexpr double most_change = 0.125;

/// A body in the world frame, SI units.
struct Body {
    BodyModel model = BodyModel::rigid;
    BodyMotion motion = BodyMotion::dynamic_body;
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();
    Vector6 velocity = Vector6::Zero();  ///< (linear, angular)
    Vector6 force = Vector6::Zero();     ///< (force, torque), constant through a step
    double mass = 1;
    Eigen::Matrix3d inertia = Eigen::Matrix3d::Identity();  ///< body frame
    double linear_damping = 0, angular_damping = 0;         ///< 1/s
    bool has_joints = false;                                ///< in the present step
    /// The orientation when the step began, if the body has joints whose rows are made then and not in each substep.
    std::optional<Eigen::Quaterniond> rows_made_at;
    /// The orientation in which inverse_mass() sees the inertia: see move_on().
    std::optional<Eigen::Quaterniond> inertia_kept_at;

    /// A body from a host's definition.
    static Body from(const BodyDefinition& definition);
    /// M^-1, with the inertia in the world frame; zero for coordinates that the model does not have.
    [[nodiscard]] Matrix6 inverse_mass() const;
    /// Moves the pose with a constant generalised velocity for a time, exactly.
    void advance(const Vector6& generalised_velocity, double seconds);
    /// Moves the pose as a position solve does. The angular velocity is rotated too, so that the energy stays.
    void displace(const Vector6& displacement);
    /// v += h (g + M^-1 f), with the time h, gravity g and the force f; then v /= 1 + h c, with the damping c.
    void accelerate(const Eigen::Vector3d& gravity, double seconds);
    /// x += h v. A rigid body is turned by the angular velocity that it has half way, and afterwards has the angular
    /// velocity that keeps its angular momentum; or, if its constraints are solved by sweeps, keeps inertia and angular
    /// velocity where rows would see too different an inertia: see rotate_again() of the lanes.
    void move_on(double seconds, bool sweeps);
    /// The inertia in the world if the body had this orientation, kg m2.
    [[nodiscard]] Eigen::Matrix3d inertia_at(const Eigen::Quaterniond& turned) const;
};

/// [u]x: the matrix of the cross product, skew(u) v = u x v.
Eigen::Matrix3d skew(const Eigen::Vector3d& u);

}  // namespace motley::reference
