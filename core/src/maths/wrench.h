// Bodies that turn, treated in three dimensions whatever their kind: linear and angular velocities, and wrenches (a
// linear and an angular impulse), for constraints whose rows may point anywhere. Along a direction in which a kind
// cannot move its inverse mass is zero, so that impulses have no effect.
#pragma once

#include "scene/joint_pose.h"

namespace motley {

// ---- velocities -----------------------------------------------------------------------------------------------------

template <class Real, BodyKind kind>
Vec3<Real> linear_of(const LaneBody<Real, kind>& body)
{
    return to_three(body.linear);
}
template <class Real, BodyKind kind>
Vec3<Real> angular_of(const LaneBody<Real, kind>& body)
{
    return body.angular;
}
template <class Real>
Vec3<Real> angular_of(const LaneBody<Real, BodyKind::planar>& body)
{
    return {Real(0), Real(0), body.yaw_rate};
}

// ---- M^-1 -----------------------------------------------------------------------------------------------------------

template <class Real>
Vec3<Real> over_mass(const LaneBody<Real, BodyKind::rigid>& body, const Vec3<Real>& v)
{
    return body.inverse_mass * v;
}
template <class Real>
Vec3<Real> over_mass(const LaneBody<Real, BodyKind::planar>& body, const Vec3<Real>& v)
{
    return {body.inverse_mass * v.x, body.inverse_mass * v.y, Real(0)};
}
template <class Real>
Vec3<Real> over_mass(const LaneBody<Real, BodyKind::fixed>&, const Vec3<Real>&)
{
    return {Real(0), Real(0), Real(0)};
}
template <class Real>
Vec3<Real> over_inertia(const LaneBody<Real, BodyKind::rigid>& body, const Vec3<Real>& v)
{
    return body.inverse_inertia * v;
}
template <class Real>
Vec3<Real> over_inertia(const LaneBody<Real, BodyKind::planar>& body, const Vec3<Real>& v)
{
    return {Real(0), Real(0), body.inverse_inertia * v.z};
}
template <class Real>
Vec3<Real> over_inertia(const LaneBody<Real, BodyKind::fixed>&, const Vec3<Real>&)
{
    return {Real(0), Real(0), Real(0)};
}

/// I^-1.
template <class Real>
const Sym3<Real>& angular_response(const LaneBody<Real, BodyKind::rigid>& body)
{
    return body.inverse_inertia;
}
template <class Real>
Sym3<Real> angular_response(const LaneBody<Real, BodyKind::planar>& body)
{
    const Real none(0);
    return {none, none, none, none, none, body.inverse_inertia};
}
template <class Real>
Sym3<Real> angular_response(const LaneBody<Real, BodyKind::fixed>&)
{
    const Real none(0);
    return {none, none, none, none, none, none};
}

/// Whether the body never moves by impulses: of its kind, not of its state.
template <class Real, BodyKind kind>
constexpr bool is_fixed(const LaneBody<Real, kind>&)
{
    return kind == BodyKind::fixed;
}
/// Whether nothing can turn the body out of the plane z = 0: of its kind, not of its state.
template <class Real, BodyKind kind>
constexpr bool stays_in_plane(const LaneBody<Real, kind>&)
{
    return kind != BodyKind::rigid;
}

/// The magnitude of M^-1. A row whose J M^-1 J^T is below `rounding_share` of it is one that the bodies cannot follow:
/// for example a row perpendicular to the plane of planar bodies, where only rounding is left.
template <class Real, BodyKind kind>
Real linear_size(const LaneBody<Real, kind>& body)
{
    return body.inverse_mass;
}
template <class Real>
Real linear_size(const LaneBody<Real, BodyKind::fixed>&)
{
    return Real(0);
}
template <class Real>
Real angular_size(const LaneBody<Real, BodyKind::particle>&)
{
    return Real(0);
}
template <class Real>
Real angular_size(const LaneBody<Real, BodyKind::rigid>& body)
{
    return trace(body.inverse_inertia);
}
template <class Real>
Real angular_size(const LaneBody<Real, BodyKind::planar>& body)
{
    return body.inverse_inertia;
}
template <class Real>
Real angular_size(const LaneBody<Real, BodyKind::fixed>&)
{
    return Real(0);
}
/// The share of that magnitude below which a row is only rounding: the square of an error of 1e-5 in its direction.
inline constexpr float rounding_share = 1e-10F;

// ---- v += M^-1 (linear, angular) ------------------------------------------------------------------------------------

template <class Real>
void apply_wrench(LaneBody<Real, BodyKind::rigid>& body, const Vec3<Real>& linear, const Vec3<Real>& angular)
{
    body.linear = body.linear + over_mass(body, linear);
    body.angular = body.angular + over_inertia(body, angular);
}
template <class Real>
void apply_wrench(LaneBody<Real, BodyKind::planar>& body, const Vec3<Real>& linear, const Vec3<Real>& angular)
{
    body.linear = body.linear + body.inverse_mass * Vec2<Real>{linear.x, linear.y};
    body.yaw_rate = body.yaw_rate + body.inverse_inertia * angular.z;
}
template <class Real>
void apply_wrench(LaneBody<Real, BodyKind::fixed>&, const Vec3<Real>&, const Vec3<Real>&)
{
}

/// The same without a linear part.
template <class Real>
void apply_turn(LaneBody<Real, BodyKind::rigid>& body, const Vec3<Real>& angular)
{
    body.angular = body.angular + over_inertia(body, angular);
}
template <class Real>
void apply_turn(LaneBody<Real, BodyKind::planar>& body, const Vec3<Real>& angular)
{
    body.yaw_rate = body.yaw_rate + body.inverse_inertia * angular.z;
}
template <class Real>
void apply_turn(LaneBody<Real, BodyKind::fixed>&, const Vec3<Real>&)
{
}

/// The same for positions, in a position solve.
template <class Real>
void displace(LaneBody<Real, BodyKind::rigid>& body, const Vec3<Real>& linear, const Vec3<Real>& angular)
{
    body.delta = body.delta + over_mass(body, linear);
    body.delta_rotation = normalised(rotation_by(over_inertia(body, angular)) * body.delta_rotation);
}
template <class Real>
void displace(LaneBody<Real, BodyKind::planar>& body, const Vec3<Real>& linear, const Vec3<Real>& angular)
{
    body.delta = body.delta + body.inverse_mass * Vec2<Real>{linear.x, linear.y};
    body.delta_yaw = body.delta_yaw + body.inverse_inertia * angular.z;
}
template <class Real>
void displace(LaneBody<Real, BodyKind::fixed>&, const Vec3<Real>&, const Vec3<Real>&)
{
}

// ---- orientations ---------------------------------------------------------------------------------------------------

/// The rotation of a body since the step began.
template <class Real, BodyKind kind>
Quat<Real> turn_of(const LaneBody<Real, kind>& body)
{
    return body.delta_rotation;
}
template <class Real>
Quat<Real> turn_of(const LaneBody<Real, BodyKind::planar>& body)
{
    const SineCosine<Real> half = sine_cosine(Real(0.5F) * body.delta_yaw);
    return {Real(0), Real(0), half.sine, half.cosine};
}

/// The same as a rotation vector, to first order.
template <class Real, BodyKind kind>
Vec3<Real> small_turn_of(const LaneBody<Real, kind>& body)
{
    return small_rotation(body.delta_rotation);
}
template <class Real>
Vec3<Real> small_turn_of(const LaneBody<Real, BodyKind::planar>& body)
{
    return {Real(0), Real(0), body.delta_yaw};
}

/// The angle, rad, by which a body has turned since the step began about an axis that is fixed in it. `axis` is that
/// axis in the world when the step began.
template <class Real, BodyKind kind>
Real turn_about(const LaneBody<Real, kind>& body, const Vec3<Real>& axis)
{
    const Quat<Real>& q = body.delta_rotation;
    return Real(2) * arc_tangent2(dot(axis, Vec3<Real>{q.x, q.y, q.z}), q.w);
}
template <class Real>
Real turn_about(const LaneBody<Real, BodyKind::planar>& body, const Vec3<Real>& axis)
{
    return axis.z * body.delta_yaw;
}

/// Takes a rotation from the body frame to the world frame.
template <class Real, BodyKind kind>
Quat<Real> to_world(const Orientation<Real, kind>& o, const Quat<Real>& local)
{
    return o.rotation * local;
}
template <class Real>
Quat<Real> to_world(const Orientation<Real, BodyKind::planar>& o, const Quat<Real>& local)
{
    const SineCosine<Real> half = sine_cosine(Real(0.5F) * o.yaw);
    return Quat<Real>{Real(0), Real(0), half.sine, half.cosine} * local;
}

/// The rotation from a to b in the frame of a, with w >= 0: of the two quaternions the one of the shorter turn.
template <class Real>
Quat<Real> relative_rotation(const Quat<Real>& a, const Quat<Real>& b)
{
    const Quat<Real> q = conjugate(a) * b;
    const auto far = q.w < Real(0);
    return {select(far, -q.x, q.x), select(far, -q.y, q.y), select(far, -q.z, q.z), select(far, -q.w, q.w)};
}

template <class Real>
Vec3<Real> axis_x(const Quat<Real>& frame)
{
    return rotate(frame, Vec3<Real>{Real(1), Real(0), Real(0)});
}
template <class Real>
Vec3<Real> axis_y(const Quat<Real>& frame)
{
    return rotate(frame, Vec3<Real>{Real(0), Real(1), Real(0)});
}
template <class Real>
Vec3<Real> axis_z(const Quat<Real>& frame)
{
    return rotate(frame, Vec3<Real>{Real(0), Real(0), Real(1)});
}

/// The rows of a lock of all rotations.
template <class Real>
struct RotationRows {
    Vec3<Real> axis[3];  ///< the rows of G: J = [0, -G, 0, G]
};
/// The error C = 2 v and the rows G = (w I - [v]x) F_a^T, with (v, w) = q_a* q_b, w >= 0, from the rotations q_a and
/// q_b of the frames and the rotation matrix F_a of q_a.
template <class Real>
RotationRows<Real> rotation_rows(const Quat<Real>& frame_a, const Quat<Real>& frame_b, Real* error)
{
    const Quat<Real> q = relative_rotation(frame_a, frame_b);
    error[0] = q.x + q.x;
    error[1] = q.y + q.y;
    error[2] = q.z + q.z;
    return {{rotate(frame_a, Vec3<Real>{q.w, q.z, -q.y}), rotate(frame_a, Vec3<Real>{-q.z, q.w, q.x}),
             rotate(frame_a, Vec3<Real>{q.y, -q.x, q.w})}};
}

}  // namespace motley
