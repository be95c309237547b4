// Where many sweeps come to rest: at changes that velocities in float could not tell from rounding.
//
// Near the solution a row still sees a speed of a unit or two in the last place of the velocities that it is the difference
// of. The impulse against that is finer than what velocities can take in: it is lost in their rounding, is asked for again in
// the next sweep, and again, and the impulses run away from the velocities by 1e-7 of them a sweep. So a change too small to
// tell is not made, and sweeps come to rest where nothing changes any more. Whether a change is one is seen from what solving
// the constraint does to its bodies, whatever the type of the constraint.
//
// A few sweeps have no time for that, and are spared the looking: `StepConstants::comes_to_rest`.
#pragma once

#include "motley/core/lane_body.h"

namespace motley {

/// Share of the speeds of two bodies below which a change of theirs is rounding: two units in the last place.
inline constexpr float rounding_of_speeds = 2.4e-7F;

/// m2: the square of about twice the radius of gyration of a body: where it is touched.
template <class Real>
Real square_of_reach(const LaneBody<Real, BodyKind::planar>& body)
{
    return Real(4) * body.inverse_mass * inverse_or_zero(body.inverse_inertia);
}
template <class Real>
Real square_of_reach(const LaneBody<Real, BodyKind::rigid>& body)
{
    const Sym3<Real>& i = body.inverse_inertia;
    return Real(12) * body.inverse_mass * inverse_or_zero(i.xx + i.yy + i.zz);
}

/// m2/s2: how fast a body's centre and what is in its reach move; of the velocity that it has, or of a change of it.
template <class Real>
Real square_of_speeds(const LaneBody<Real, BodyKind::particle>& velocity)
{
    return dot(velocity.linear, velocity.linear);
}
template <class Real>
Real square_of_speeds(const LaneBody<Real, BodyKind::planar>& velocity)
{
    return dot(velocity.linear, velocity.linear) +
           square_of_reach(velocity) * (velocity.yaw_rate * velocity.yaw_rate);
}
template <class Real>
Real square_of_speeds(const LaneBody<Real, BodyKind::rigid>& velocity)
{
    return dot(velocity.linear, velocity.linear) +
           square_of_reach(velocity) * dot(velocity.angular, velocity.angular);
}
template <class Real>
Real square_of_speeds(const LaneBody<Real, BodyKind::fixed>& velocity)
{
    return dot(velocity.linear, velocity.linear);
}

/// A body with the change of its velocity for a velocity.
template <class Real, BodyKind kind>
LaneBody<Real, kind> change_between(const LaneBody<Real, kind>& before, LaneBody<Real, kind> body)
{
    body.linear = body.linear - before.linear;
    if constexpr (requires { body.angular; }) body.angular = body.angular - before.angular;
    if constexpr (requires { body.yaw_rate; }) body.yaw_rate = body.yaw_rate - before.yaw_rate;
    return body;
}

/// Whether solving a constraint has made a difference to its bodies, whose squares of speeds these are in sum.
inline bool makes_a_difference(float changes, float speeds)
{
    return changes > rounding_of_speeds * rounding_of_speeds * speeds;
}

}  // namespace motley
