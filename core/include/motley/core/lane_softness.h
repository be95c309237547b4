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

/// A spring of a row: of a frequency on the row's own effective mass, or of a stiffness k and a damping c. Both implicit:
///
///   h (k C' + c v') = -lambda',  C' = C + h v'    =>    v' + k / (c + h k) C + lambda' / (h (c + h k)) = 0.
template <class Real>
struct SpringSoftness {
    Real rate;  ///< 1/s
    Real mass_scale,
        impulse_scale;  ///< of a frequency; where there is no spring nothing is wanted and nothing kept
    Real give;          ///< 1 / (h (c + h k)); 0 where the spring is no stiffness
};
template <class Real>
SpringSoftness<Real> spring_softness(const StepConstants& step, const Real& hertz, const Real& damping_ratio,
                                     const Real& stiffness, const Real& damping)
{
    const LaneSoftness<Real> own = softness_or(step, hertz, damping_ratio, Softness{0, 0, 1});
    const Real h(step.substep), resistance = damping + h * stiffness, zero(0);
    const auto is_stiffness = h * resistance > zero;
    const Real safe = select(is_stiffness, resistance, Real(1));
    return {select(is_stiffness, stiffness / safe, own.rate), own.mass_scale, own.impulse_scale,
            select(is_stiffness, Real(1) / (h * safe), zero)};
}

/// delta lambda = -effective_mass (J v + rate C) - kept lambda.
template <class Real>
struct SoftRow {
    Real rate, effective_mass, kept;
};
/// With K = J M^-1 J^T where the bodies are now, and its inverse, 0 where nothing can move.
template <class Real>
SoftRow<Real> soft_row(const SpringSoftness<Real>& spring, const Real& response, const Real& effective_mass)
{
    const Real zero(0);
    const auto is_stiffness = (spring.give > zero) & (effective_mass > zero);
    const Real inverse = Real(1) / select(is_stiffness, response + spring.give, Real(1));
    return {spring.rate, select(is_stiffness, inverse, spring.mass_scale * effective_mass),
            select(is_stiffness, spring.give * inverse, spring.impulse_scale)};
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
