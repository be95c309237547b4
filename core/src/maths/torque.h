// Warm starts of joints that turn bodies much lighter than what they turn, such as the cross of two hinges.
//
// The angular impulse T of a substep h acts about an axis that turns with the bodies. When the next substep is warm
// started with it, the axis has turned by an angle of h w, and T misses by up to |T| h w. That changes the angular
// velocity w of a body of inertia I by I^-1 |T| h w: by more than w itself where h |T| I^-1 is above 1, and the next
// substep misses by more again. A blow on a limit then grows a thousandfold within a step, however exactly the sweeps
// solve. So no substep is warm started with more than h |T| tr I^-1 = 2, and the sweeps find the rest again.
#pragma once

#include "maths/lane_body.h"

namespace motley {

/// The trace of I^-1 of a rigid body, 1/(kg m2): at least the response to any torque. 0 for others: in a plane the axis
/// of all torques stays where it is.
template <class Real, BodyKind kind>
Real largest_response(const LaneBody<Real, kind>& body)
{
    if constexpr (kind == BodyKind::rigid) {
        return trace(body.inverse_inertia);
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
