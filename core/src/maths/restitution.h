// Restitution: the speed with which bodies separate after an impact.
#pragma once

#include "maths/scalar.h"

namespace motley {

/// The speed, m/s, at which a contact must open at the end of a step in which there was an impact, so that right after
/// the impact it opened with `restitution` times the speed at which it closed.
///
/// `approach` (m/s) is dC/dt when the step began, negative when closing, `acceleration` a (m/s2) its rate of change by
/// forces alone, `start` and `now` (m) are C when the step began and now. Free flight conserves v^2 / 2 - a x. From
/// that follow the speed of the impact, at whatever time in the step it was, and the speed to leave with, although it
/// is applied some substeps after the impact or, by relaxation, one before. Steps without impulses conserve it too (see
/// Flight), so bounces with a restitution of 1 lose no energy.
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
