// How far a constraint is from its solution, measured by what solving it once more changes.
//
// Solving a constraint changes its impulse by d lambda = -K^-1 r, where r is what is left of its equations and
// inequalities, softness and limits included, and its bodies' velocities by dv = M^-1 J^T d lambda. So
//     dv^T M dv = d lambda^T K d lambda = r^T K^-1 r,
// the squared K^-1 norm of the residual, for every type of constraint, so that no type needs code of its own. Where a
// limit or a friction cone holds the impulse back, d lambda is the projected residual: zero exactly when the
// complementarity conditions hold.
#pragma once

#include "maths/lane_body.h"

namespace motley {

template <class Real>
struct LaneResidual {
    Real energy;  ///< J, dv^T M dv
    Real speed;   ///< m/s, sqrt(energy (1/m_a + 1/m_b)): |r| itself where the constraint acts on the centres
};

/// Delta v^T M Delta v of one body.
template <class Real>
Real energy_of_change(const LaneBody<Real, BodyKind::particle>& before,
                      const LaneBody<Real, BodyKind::particle>& after)
{
    const Vec3<Real> change = after.linear - before.linear;
    return inverse_or_zero(after.inverse_mass) * dot(change, change);
}
template <class Real>
Real energy_of_change(const LaneBody<Real, BodyKind::planar>& before,
                      const LaneBody<Real, BodyKind::planar>& after)
{
    const Vec2<Real> change = after.linear - before.linear;
    const Real turn = after.yaw_rate - before.yaw_rate;
    return inverse_or_zero(after.inverse_mass) * dot(change, change) +
           inverse_or_zero(after.inverse_inertia) * turn * turn;
}
template <class Real>
Real energy_of_change(const LaneBody<Real, BodyKind::rigid>& before,
                      const LaneBody<Real, BodyKind::rigid>& after)
{
    const Vec3<Real> change = after.linear - before.linear, turn = after.angular - before.angular;
    return inverse_or_zero(after.inverse_mass) * dot(change, change) +
           dot(turn, inverse(after.inverse_inertia) * turn);
}
template <class Real>
Real energy_of_change(const LaneBody<Real, BodyKind::fixed>&, const LaneBody<Real, BodyKind::fixed>&)
{
    return Real(0);
}

template <class Real, BodyKind kind>
Real inverse_mass_of(const LaneBody<Real, kind>& body)
{
    if constexpr (kind == BodyKind::fixed) {
        return Real(0);
    } else {
        return body.inverse_mass;
    }
}

/// The residual from dv^T M dv of both bodies together and from 1/m_a + 1/m_b.
template <class Real>
LaneResidual<Real> residual_of(const Real& energy_of_changes, const Real& inverse_masses)
{
    // Rounding may leave it below zero. With the arguments in this order NaN stays NaN, and is never taken for solved.
    const Real energy = maximum(Real(0), energy_of_changes);
    return {energy, square_root(energy * inverse_masses)};
}

}  // namespace motley
