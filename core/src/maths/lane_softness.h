// Softness in lanes: from a joint's own frequency where it has one, from the solver's settings where it has none.
#pragma once

#include "maths/scalar.h"
#include "maths/step_constants.h"

namespace motley {

/// delta lambda = -mass_scale K^-1 (J v + rate C) - impulse_scale lambda: see Softness.
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
    // The frequency is capped at 0.25 / h, that is omega = 2 pi hertz at pi / (2 h).
    const Real omega = minimum(Real(6.2831853F) * hertz, Real(1.5707963F * step.inverse_substep));
    const Real a1 = select(own, Real(2) * damping_ratio + h * omega, Real(1));
    const Real a2 = h * omega * a1;
    const Real a3 = Real(1) / (Real(1) + a2);
    return {select(own, omega / a1, Real(usual.rate)), select(own, a2 * a3, Real(usual.mass_scale)),
            select(own, a3, Real(usual.impulse_scale)), select(own, Real(1), Real(0))};
}

/// The spring of a row, given by a frequency on the row's own effective mass, or by a stiffness k and a damping c. Both
/// are integrated implicitly. For the latter, with C', v' and the impulse lambda' at the end of the substep h:
///
///   h (k C' + c v') = -lambda',  C' = C + h v'    =>    v' + k / (c + h k) C + lambda' / (h (c + h k)) = 0.
template <class Real>
struct SpringSoftness {
    Real rate;  ///< 1/s
    Real mass_scale,
        impulse_scale;  ///< of a frequency; 0 and 1 where there is no spring, which makes its impulse 0
    Real give;          ///< 1 / (h (c + h k)); 0 without stiffness and damping
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
    /// The same law is J v + rate C + give lambda = 0, with the whole lambda: effective_mass = 1 / (K + give) for a stiffness,
    /// and the give of a frequency is that which has the same quotient.
    [[nodiscard]] Real give() const
    {
        const auto exists = effective_mass > Real(0);
        return select(exists, kept / select(exists, effective_mass, Real(1)), Real(0));
    }
};
/// `response` is K = J M^-1 J^T in the present poses, `effective_mass` its inverse, or 0 where nothing can move.
template <class Real>
SoftRow<Real> soft_row(const SpringSoftness<Real>& spring, const Real& response, const Real& effective_mass)
{
    const Real zero(0);
    const auto is_stiffness = (spring.give > zero) & (effective_mass > zero);
    const Real inverse = Real(1) / select(is_stiffness, response + spring.give, Real(1));
    return {spring.rate, select(is_stiffness, inverse, spring.mass_scale * effective_mass),
            select(is_stiffness, spring.give * inverse, spring.impulse_scale)};
}

/// The softness that a sweep uses: that of the spring where there is one, else that of the sweep's constants, which are
/// rigid in relaxation.
template <class Real>
LaneSoftness<Real> softness_in(const StepConstants& step, const LaneSoftness<Real>& soft)
{
    const auto own = soft.is_own > Real(0);
    return {select(own, soft.rate, Real(step.joint.rate)),
            select(own, soft.mass_scale, Real(step.joint.mass_scale)),
            select(own, soft.impulse_scale, Real(step.joint.impulse_scale)), soft.is_own};
}

}  // namespace motley
