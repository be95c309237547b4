// Restitution: the speed that an impact gives back.
#pragma once

#include "motley/core/scalar.h"
#include "motley/core/step_constants.h"

namespace motley {

/// How fast a contact is to open at the end of a step in which it was hit, m/s: e times as fast as it closed when it was.
///
/// `approach` is how fast it opened when the step began, `acceleration` (m/s2) what forces alone make of that a second,
/// `start` and `now` (m) how far it was open then and is. What flies freely by v += h a, x += h v keeps
/// (v + h a/2)^2 / 2 - a x, so the speed of the impact, wherever in the step it was, and the speed to leave with, which is
/// given some substeps later or, by relaxation, one too early, follow from that energy. Given back from `approach` itself,
/// a ball would lose 2 % of its height a bounce at 240 steps a second. (1 - e) h a/2 is left of the difference between
/// speeds at the middle and at the end of a substep: with e = 0 nothing opens.
template <class Real>
Real opening_speed(const StepConstants& step, const Real& restitution, const Real& approach,
                   const Real& acceleration, const Real& start, const Real& now)
{
    const Real half = Real(0.5F * step.substep) * acceleration, twice = acceleration + acceleration;
    const Real before = approach + half;
    const Real at_impact = minimum(start, Real(0));
    const Real of_impact = maximum(before * before + twice * (at_impact - start), Real(0));
    const Real of_leaving = restitution * restitution * of_impact + twice * (now - at_impact);
    return maximum(square_root(maximum(of_leaving, Real(0))) - restitution * half, Real(0));
}

}  // namespace motley
