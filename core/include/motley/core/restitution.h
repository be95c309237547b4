// Restitution: the speed that an impact gives back.
#pragma once

#include "motley/core/scalar.h"

namespace motley {

/// How fast a contact is to open at the end of a step in which it was hit, m/s: e times as fast as it closed when it was.
///
/// `approach` is how fast it opened when the step began, `acceleration` (m/s2) what forces alone make of that a second,
/// `start` and `now` (m) how far it was open then and is. A flight keeps v^2 / 2 - a x, so the speed of the impact, wherever
/// in the step it was, and the speed to leave with, which is given some substeps later or, by relaxation, one too early,
/// follow from that energy. Steps in which nothing pushes keep it too (see Flight), and so do bounces without loss.
template <class Real>
Real opening_speed(const Real& restitution, const Real& approach, const Real& acceleration, const Real& start,
                   const Real& now)
{
    const Real twice = acceleration + acceleration;
    const Real at_impact = minimum(start, Real(0));
    const Real of_impact = maximum(approach * approach + twice * (at_impact - start), Real(0));
    const Real of_leaving = restitution * restitution * of_impact + twice * (now - at_impact);
    return square_root(maximum(of_leaving, Real(0)));
}

}  // namespace motley
