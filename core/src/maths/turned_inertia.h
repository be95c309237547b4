// How much a body's inertia in the world changes when it turns: by how much responses that were computed before it turned
// are wrong after it.
#pragma once

#include "maths/lane_body.h"

namespace motley {

/// tr(I I'^-1) - 3: how much a rotation changed the inertia I, with I' after it. Where it made a response c times as high
/// or as low, about a principal axis, it is c + 1/c - 2.
template <class Real>
Real change_of_inertia(const Sym3<Real>& inertia, const Sym3<Real>& inverse_after)
{
    return trace_of_product(inertia, inverse_after) - Real(3);
}

/// tr I tr I^-1 - 9: 0 for a body whose inertia is that of a ball, the larger the thinner or flatter it is. With s the sine
/// of half the angle, no rotation changes I by more than 4 s^2 times this.
template <class Real>
Real spread_of(const Sym3<Real>& inertia, const Sym3<Real>& inverse_inertia)
{
    return trace(inertia) * trace(inverse_inertia) - Real(9);
}

/// A change of I up to which responses may stay as they were computed: they are wrong by less than a factor of 1.5.
inline constexpr float most_change = 0.125F;

/// s^2 of the turn since the step began.
template <class Real>
Real squared_half_sine(const LaneBody<Real, BodyKind::rigid>& body)
{
    const Quat<Real>& q = body.delta_rotation;
    return q.x * q.x + q.y * q.y + q.z * q.z;
}

/// The most that the turn since the step began may have changed I; 0 for bodies whose inertia does not turn.
template <class Real, BodyKind kind>
Real change_at_most(const LaneBody<Real, kind>& body)
{
    if constexpr (kind == BodyKind::rigid) {
        return Real(4) * squared_half_sine(body) *
               spread_of(inverse(body.inverse_inertia), body.inverse_inertia);
    } else {
        return Real(0);
    }
}

}  // namespace motley
