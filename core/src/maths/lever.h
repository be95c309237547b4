// One row of a Jacobian along a direction n with arms r_a and r_b that all stay fixed for a step:
// J = [-n, -(r_a x n), n, r_b x n]. The levers r x n are stored instead of the arms: one number for planar bodies, none
// for particles.
#pragma once

#include <type_traits>

#include "maths/lane_body.h"

namespace motley {

struct NoLever {};

/// The type of r x n, by the kind of the body and by whether the pair is planar: nothing, its z component, or a vector.
template <class Real, BodyKind kind, bool planar_pair>
using Lever =
    std::conditional_t<kind == BodyKind::particle, NoLever,
                       std::conditional_t<kind == BodyKind::planar || planar_pair, Real, Vec3<Real>>>;

template <class Lever, class Vector>
Lever lever_of(const Vector& arm, const Vector& n)
{
    if constexpr (std::is_same_v<Lever, NoLever>) {
        return {};
    } else if constexpr (requires(Lever lever) { lever.x; }) {
        return cross(arm, n);
    } else {
        return arm.x * n.y - arm.y * n.x;
    }
}

// ---- the part of J v of one body: added for b, subtracted for a -----------------------------------------------------

template <class Real>
Real speed_along(const LaneBody<Real, BodyKind::particle>& body, const Vec3<Real>& n, NoLever)
{
    return dot(n, body.linear);
}
template <class Real, class Vector>
Real speed_along(const LaneBody<Real, BodyKind::planar>& body, const Vector& n, const Real& lever)
{
    return n.x * body.linear.x + n.y * body.linear.y + lever * body.yaw_rate;
}
template <class Real, BodyKind kind>
Real speed_along(const LaneBody<Real, kind>& body, const Vec3<Real>& n, const Vec3<Real>& lever)
{
    return dot(n, body.linear) + dot(lever, body.angular);
}
template <class Real>
Real speed_along(const LaneBody<Real, BodyKind::fixed>& body, const Vec2<Real>& n, const Real& lever)
{
    return n.x * body.linear.x + n.y * body.linear.y + lever * body.angular.z;
}

// ---- v += M^-1 J^T lambda -------------------------------------------------------------------------------------------

template <class Real>
void push_along(LaneBody<Real, BodyKind::particle>& body, const Vec3<Real>& n, NoLever, const Real& lambda)
{
    body.linear = body.linear + (body.inverse_mass * lambda) * n;
}
template <class Real, class Vector>
void push_along(LaneBody<Real, BodyKind::planar>& body, const Vector& n, const Real& lever,
                const Real& lambda)
{
    const Real change = body.inverse_mass * lambda;
    body.linear = body.linear + change * Vec2<Real>{n.x, n.y};
    body.yaw_rate = body.yaw_rate + (body.inverse_inertia * lambda) * lever;
}
template <class Real>
void push_along(LaneBody<Real, BodyKind::rigid>& body, const Vec3<Real>& n, const Vec3<Real>& lever,
                const Real& lambda)
{
    body.linear = body.linear + (body.inverse_mass * lambda) * n;
    body.angular = body.angular + body.inverse_inertia * (lambda * lever);
}
template <class Real, class Vector, class Lever>
void push_along(LaneBody<Real, BodyKind::fixed>&, const Vector&, const Lever&, const Real&)
{
}

// ---- the part of J M^-1 J^T of one body -----------------------------------------------------------------------------

template <class Real, BodyKind kind, class Vector, class Lever>
Real response_along(const LaneBody<Real, kind>& body, const Vector& n, const Lever& lever)
{
    if constexpr (kind == BodyKind::fixed) {
        return Real(0);
    } else if constexpr (kind == BodyKind::particle) {
        return body.inverse_mass * dot(n, n);
    } else if constexpr (kind == BodyKind::planar) {
        return body.inverse_mass * (n.x * n.x + n.y * n.y) + body.inverse_inertia * lever * lever;
    } else {
        return body.inverse_mass * dot(n, n) + dot(lever, body.inverse_inertia * lever);
    }
}

// ---- the same for displacements since the step began, to first order in the rotation --------------------------------

template <class Real>
Real moved_along(const LaneBody<Real, BodyKind::particle>& body, const Vec3<Real>& n, NoLever)
{
    return dot(n, body.delta);
}
template <class Real, class Vector>
Real moved_along(const LaneBody<Real, BodyKind::planar>& body, const Vector& n, const Real& lever)
{
    return n.x * body.delta.x + n.y * body.delta.y + lever * body.delta_yaw;
}
template <class Real, BodyKind kind>
Real moved_along(const LaneBody<Real, kind>& body, const Vec3<Real>& n, const Vec3<Real>& lever)
{
    return dot(n, body.delta) + dot(lever, small_rotation(body.delta_rotation));
}
template <class Real>
Real moved_along(const LaneBody<Real, BodyKind::fixed>& body, const Vec2<Real>& n, const Real& lever)
{
    return n.x * body.delta.x + n.y * body.delta.y + lever * small_rotation(body.delta_rotation).z;
}

// ---- displacement by M^-1 J^T lambda, for position solves -----------------------------------------------------------

template <class Real>
void displace_along(LaneBody<Real, BodyKind::particle>& body, const Vec3<Real>& n, NoLever,
                    const Real& lambda)
{
    body.delta = body.delta + (body.inverse_mass * lambda) * n;
}
template <class Real, class Vector>
void displace_along(LaneBody<Real, BodyKind::planar>& body, const Vector& n, const Real& lever,
                    const Real& lambda)
{
    const Real change = body.inverse_mass * lambda;
    body.delta = body.delta + change * Vec2<Real>{n.x, n.y};
    body.delta_yaw = body.delta_yaw + (body.inverse_inertia * lambda) * lever;
}
template <class Real>
void displace_along(LaneBody<Real, BodyKind::rigid>& body, const Vec3<Real>& n, const Vec3<Real>& lever,
                    const Real& lambda)
{
    body.delta = body.delta + (body.inverse_mass * lambda) * n;
    body.delta_rotation =
        normalised(rotation_by(body.inverse_inertia * (lambda * lever)) * body.delta_rotation);
}
template <class Real, class Vector, class Lever>
void displace_along(LaneBody<Real, BodyKind::fixed>&, const Vector&, const Lever&, const Real&)
{
}

}  // namespace motley
