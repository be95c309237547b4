// Warm starts of joints that turn bodies much lighter than what they turn, such as the cross of two hinges.
//
// An angular impulse T of a substep h acts about an axis that turns with the bodies. Applied again in the next substep,
// it misses by up to |T| times the angle by which the axis has turned since, and makes the body turn by I^-1 of that.
// Beyond h |T| = 2 I each substep turns it further than the last: a blow on a limit then grows a thousandfold within a
// step, however exactly the sweeps solve. So no substep is warm started with more than that, and the sweeps find the
// rest again.
#pragma once

#include "maths/lane_body.h"

namespace motley {

/// The trace of I^-1 of a rigid body, 1/(kg m2): at least the response to any torque. 0 for others: in a plane the axis
/// of all torques stays where it is.
template <class Real, BodyKind kind>
Real largest_response(const LaneBody<Real, kind>& body)
{
    if constexpr (kind == BodyKind::rigid) {
        const Sym3<Real>& i = body.inverse_inertia;
        return i.xx + i.yy + i.zz;
    } else {
        return Real(0);
    }
}

/// The share of an angular impulse, N m s, with which a substep, s, may begin: 1 for nearly all.
template <class Real, BodyKind kind_a, BodyKind kind_b>
Real bearable_share(const LaneBody<Real, kind_a>& a, const LaneBody<Real, kind_b>& b, const Real& torque,
                    const Real& substep)
{
    const Real load = substep * torque * maximum(largest_response(a), largest_response(b));
    return Real(1) / maximum(Real(0.5F) * load, Real(1));
}

}  // namespace motley
