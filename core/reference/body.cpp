// Bodies of the reference and their motion.
#include "motley/reference/body.h"

namespace motley::reference {

Eigen::Matrix3d skew(const Eigen::Vector3d& u)
{
    Eigen::Matrix3d m;
    m << 0, -u.z(), u.y(), u.z(), 0, -u.x(), -u.y(), u.x(), 0;
    return m;
}

Body Body::from(const BodyDefinition& d)
{
    Body body;
    body.model = d.model;
    body.motion = d.motion;
    body.position = {d.position.x, d.position.y, d.position.z};
    body.orientation =
        Eigen::Quaterniond(d.orientation.w, d.orientation.x, d.orientation.y, d.orientation.z).normalized();
    if (d.motion == BodyMotion::dynamic_body) {
        if (d.model == BodyModel::planar) {
            body.orientation = Eigen::AngleAxisd(d.yaw, Eigen::Vector3d::UnitZ());
        } else if (d.model == BodyModel::particle) {
            body.orientation.setIdentity();
        }
    }
    body.velocity << d.linear_velocity.x, d.linear_velocity.y, d.linear_velocity.z, d.angular_velocity.x,
        d.angular_velocity.y, d.angular_velocity.z;
    body.mass = d.mass;
    body.linear_damping = d.linear_damping;
    body.angular_damping = d.angular_damping;
    body.inertia << d.inertia.xx, d.inertia.xy, d.inertia.xz, d.inertia.xy, d.inertia.yy, d.inertia.yz,
        d.inertia.xz, d.inertia.yz, d.inertia.zz;
    return body;
}

Matrix6 Body::inverse_mass() const
{
    Matrix6 m = Matrix6::Zero();
    if (motion != BodyMotion::dynamic_body) return m;
    switch (model) {
        case BodyModel::particle:
            m.topLeftCorner<3, 3>().diagonal().setConstant(1 / mass);
            break;
        case BodyModel::planar:
            m(0, 0) = m(1, 1) = 1 / mass;
            m(5, 5) = 1 / inertia(2, 2);
            break;
        case BodyModel::rigid: {
            m.topLeftCorner<3, 3>().diagonal().setConstant(1 / mass);
            m.bottomRightCorner<3, 3>() = inertia_at(inertia_kept_at.value_or(orientation)).inverse();
            break;
        }
    }
    return m;
}

void Body::advance(const Vector6& v, double seconds)
{
    position += seconds * v.head<3>();
    const Eigen::Vector3d turn = seconds * v.tail<3>();
    const double angle = turn.norm();
    if (angle > 0)
        orientation = (Eigen::Quaterniond(Eigen::AngleAxisd(angle, turn / angle)) * orientation).normalized();
}

void Body::displace(const Vector6& displacement)
{
    const Eigen::Quaterniond before = orientation;
    advance(displacement, 1);
    const Eigen::Quaterniond turn = orientation * before.conjugate();
    velocity.tail<3>() = turn * Eigen::Vector3d(velocity.tail<3>());
    if (inertia_kept_at) inertia_kept_at = turn * *inertia_kept_at;
}

void Body::accelerate(const Eigen::Vector3d& gravity, double h)
{
    if (motion != BodyMotion::dynamic_body) return;
    Vector6 g = Vector6::Zero();
    g.head<3>() = gravity;
    if (model == BodyModel::planar) g(2) = 0;
    velocity += h * (g + inverse_mass() * force);
    velocity.head<3>() /= 1 + h * linear_damping;
    velocity.tail<3>() /= 1 + h * angular_damping;
}

Eigen::Matrix3d Body::inertia_at(const Eigen::Quaterniond& turned) const
{
    const Eigen::Matrix3d r = turned.toRotationMatrix();
    return r * inertia * r.transpose();
}

void Body::move_on(double seconds, bool sweeps)
{
    if (motion == BodyMotion::static_body) return;
    if (motion == BodyMotion::kinematic_body || model != BodyModel::rigid) {
        advance(velocity, seconds);
        return;
    }
    const Eigen::Quaterniond before = inertia_kept_at.value_or(orientation);
    Body half_way = *this;
    half_way.advance(velocity, seconds / 2);
    const Eigen::Matrix3d then = inertia_at(before), between = inertia_at(half_way.orientation).inverse();
    double change = sweeps && has_joints ? (then * between).trace() - 3 : 0;
    if (sweeps && rows_made_at) change = std::max(change, (inertia_at(*rows_made_at) * between).trace() - 3);
    inertia_kept_at.reset();
    if (change > most_change) inertia_kept_at = before;
    // A body that turns by a radian or more keeps its angular velocity, and with it its energy.
    const double turn = seconds * velocity.tail<3>().norm();
    if (inertia_kept_at || turn >= 1) {
        advance(velocity, seconds);
        return;
    }
    const Eigen::Vector3d momentum = then * velocity.tail<3>();
    const auto speed = [&](const Body& turned) {
        return Eigen::Vector3d(inertia_at(turned.orientation).inverse() * momentum);
    };
    // A body may precess too fast for one piece: see precesses() of the lanes.
    const double spread = then.trace() * then.inverse().trace() - 9;
    const int pieces = spread > 0.1 && turn * turn > 0.01 ? 16 : 1;
    for (int piece = 0; piece < pieces; ++piece) {
        half_way = *this;
        half_way.advance(velocity, seconds / pieces / 2);
        velocity.tail<3>() = speed(half_way);
        advance(velocity, seconds / pieces);
        velocity.tail<3>() = speed(*this);
    }
}

}  // namespace motley::reference
