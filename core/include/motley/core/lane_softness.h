// Softness in lanes: a joint's own frequency where it has one, the solver's where it has none.
#pragma once

#include "motley/core/scalar.h"
#include "motley/core/step_constants.h"

namespace motley {

/// delta lambda = -mass_scale K^-1 (J v + rate C) - impulse_scale lambda.
template <class Real>
struct LaneSoftness {
    Real rate, mass_scale, impulse_scale;
    Real
        is_own;  ///< 1 where the joint has its own frequency: a spring, which relaxation leaves as it is; else 0
};

/// soft() of step_constants.h where hertz > 0, else `usual`.
template <class Real>
LaneSoftness<Real> softness_or(const StepConstants& step, const Real& hertz, const Real& damping_ratio,
                               const Softness& usual)
{
    const auto own = hertz > Real(0);
    const Real h(step.substep);
    // Capped at 0.25 / h: a quarter of a turn is pi/2.
    const Real omega = minimum(Real(6.2831853F) * hertz, Real(1.5707963F * step.inverse_substep));
    const Real a1 = select(own, Real(2) * damping_ratio + h * omega, Real(1));
    const Real a2 = h * omega * a1;
    const Real a3 = Real(1) / (Real(1) + a2);
    return {select(own, omega / a1, Real(usual.rate)), select(own, a2 * a3, Real(usual.mass_scale)),
            select(own, a3, Real(usual.impulse_scale)), select(own, Real(1), Real(0))};
}

/// What a sweep solves with: a spring as it is, everything else as soft as the sweep's constants say, which are rigid when
/// it relaxes.
template <class Real>
LaneSoftness<Real> softness_in(const StepConstants& step, const LaneSoftness<Real>& soft)
{
    const auto own = soft.is_own > Real(0);
    return {select(own, soft.rate, Real(step.joint.rate)),
            select(own, soft.mass_scale, Real(step.joint.mass_scale)),
            select(own, soft.impulse_scale, Real(step.joint.impulse_scale)), soft.is_own};
}

}  // namespace motley
