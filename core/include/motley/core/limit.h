// Limits, locks, springs and bounds on one row: what an accumulated impulse wants to be.
#pragma once

#include "motley/core/lane_softness.h"
#include "motley/core/scalar.h"
#include "motley/core/step_constants.h"

namespace motley {

/// An impulse that pushes out what is beyond a bound, but not faster than push_out_speed. It is the speed that is
/// held back, never the impulse: a load that is pressed on is held however large it is, and gives way as far as the softness
/// says and no further. (A bound on the bias alone would be one on the impulse, which then leaks as fast as it grows.)
template <class Real>
Real no_faster_than_push_out(const StepConstants& step, const Real& wanted, const Real& speed,
                             const Real& effective_mass, const Real& held)
{
    return minimum(wanted, held - effective_mass * (speed - Real(step.push_out_speed)));
}

/// Of C >= 0 with speed dC/dt; the caller clamps it at 0. With room left it may be used up within the substep and no
/// further; without, the error goes as fast as the joints' softness and push_out_speed allow.
template <class Real>
Real limit_impulse(const StepConstants& step, const Real& c, const Real& speed, const Real& effective_mass,
                   const Real& held)
{
    const auto room = c > Real(0);
    const Real closing = Real(step.inverse_substep) * c;
    const Real soft = Real(step.joint.rate) * c;
    const Real mass_scale = select(room, Real(1), Real(step.joint.mass_scale));
    const Real impulse_scale = select(room, Real(0), Real(step.joint.impulse_scale));
    const Real wanted =
        held - mass_scale * effective_mass * (speed + select(room, closing, soft)) - impulse_scale * held;
    // With room nothing opens, so it may stand for both.
    return no_faster_than_push_out(step, wanted, speed, effective_mass, held);
}

/// Of C = 0.
template <class Real>
Real lock_impulse(const StepConstants& step, const Real& c, const Real& speed, const Real& effective_mass,
                  const Real& held)
{
    return held - Real(step.joint.mass_scale) * effective_mass * (speed + Real(step.joint.rate) * c) -
           Real(step.joint.impulse_scale) * held;
}

/// Of a contact, C >= 0: with room as a limit; without, as deep as the slop allows and no faster than push_out_speed.
template <class Real>
Real contact_impulse(const StepConstants& step, const Softness& soft, const Real& separation,
                     const Real& speed, const Real& effective_mass, const Real& held)
{
    const auto apart = separation > Real(0);
    const Real bias = select(apart, Real(step.inverse_substep) * separation,
                             Real(soft.rate) * minimum(separation + Real(step.slop), Real(0)));
    const Real mass_scale = select(apart, Real(1), Real(soft.mass_scale));
    const Real impulse_scale = select(apart, Real(0), Real(soft.impulse_scale));
    const Real wanted = held - effective_mass * mass_scale * (speed + bias) - impulse_scale * held;
    return maximum(no_faster_than_push_out(step, wanted, speed, effective_mass, held), Real(0));
}

/// Of lower <= C <= upper. One limit at a time, the nearer one; a coordinate without room between them is held from
/// both sides.
template <class Real>
Real range_impulse(const StepConstants& step, const Real& c, const Real& lower, const Real& upper,
                   const Real& speed, const Real& effective_mass, const Real& held)
{
    const Real above = c - lower, below = upper - c;
    const Real at_lower = maximum(limit_impulse(step, above, speed, effective_mass, held), Real(0));
    // The upper limit is the lower one of the mirrored coordinate.
    const Real at_upper = -maximum(limit_impulse(step, below, -speed, effective_mass, -held), Real(0));
    return select(lower < upper, select(above < below, at_lower, at_upper),
                  lock_impulse(step, above, speed, effective_mass, held));
}

/// How far C is beyond lower (negative) or upper.
template <class Real>
Real beyond_range(const Real& c, const Real& lower, const Real& upper)
{
    return minimum(c - lower, Real(0)) + maximum(c - upper, Real(0));
}

/// Of a soft C = 0, bounded. A spring is physics: relaxation leaves it as it is.
template <class Real>
Real spring_impulse(const SoftRow<Real>& spring, const Real& c, const Real& speed, const Real& held,
                    const Real& most)
{
    const Real wanted = held - spring.effective_mass * (speed + spring.rate * c) - spring.kept * held;
    return maximum(minimum(wanted, most), -most);
}

}  // namespace motley
