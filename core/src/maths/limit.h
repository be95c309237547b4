// Limits, locks, springs and bounds on one row. Each function returns the new accumulated impulse of the row from its
// constraint function C, its `speed` dC/dt = J v, its `effective_mass` K^-1, and `held`, the accumulated impulse so
// far.
#pragma once

#include "maths/lane_softness.h"
#include "maths/scalar.h"
#include "maths/step_constants.h"

namespace motley {

/// `wanted`, but no more than what makes the row open at push_out_speed. The bound is on the speed, not on the impulse:
/// a load of any size is held, and moves in only as far as the softness allows. (A bound on the bias alone would bound
/// the impulse, because softness takes away a share of the impulse in each sweep.)
template <class Real>
Real no_faster_than_push_out(const StepConstants& step, const Real& wanted, const Real& speed,
                             const Real& effective_mass, const Real& held)
{
    return minimum(wanted, held - effective_mass * (speed - Real(step.push_out_speed)));
}

/// The share of its impulse that a soft row loses in a sweep. A row that exact joints hold has no effective mass here, and keeps
/// all.
template <class Real>
Real lost_share(const StepConstants& step, const Real& effective_mass)
{
    return select(effective_mass > Real(0), Real(step.joint.impulse_scale), Real(0));
}

/// For C >= 0; the caller clamps the result at 0. While there is room, C > 0, the row may close by that much within the
/// substep and no more; without room the error is removed as fast as the softness of joints and push_out_speed allow.
template <class Real>
Real limit_impulse(const StepConstants& step, const Real& c, const Real& speed, const Real& effective_mass,
                   const Real& held)
{
    const auto room = c > Real(0);
    const Real closing = Real(step.inverse_substep) * c;
    const Real soft = Real(step.joint.rate) * c;
    const Real mass_scale = select(room, Real(1), Real(step.joint.mass_scale));
    const Real impulse_scale = select(room, Real(0), lost_share(step, effective_mass));
    const Real wanted =
        held - mass_scale * effective_mass * (speed + select(room, closing, soft)) - impulse_scale * held;
    // With room this bound never applies, since closing > -push_out_speed.
    return no_faster_than_push_out(step, wanted, speed, effective_mass, held);
}

/// For C = 0.
template <class Real>
Real lock_impulse(const StepConstants& step, const Real& c, const Real& speed, const Real& effective_mass,
                  const Real& held)
{
    return held - Real(step.joint.mass_scale) * effective_mass * (speed + Real(step.joint.rate) * c) -
           lost_share(step, effective_mass) * held;
}

/// For a contact, C >= 0: with room as a limit; without, penetration beyond the slop is removed as fast as `soft` and
/// push_out_speed allow.
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

/// Where the force of a contact has a bound f, N: the largest lambda of a position solve, kg m. It moves a mass m by no more than
/// the force would in a substep h, h^2 f / m.
template <class Real>
Real most_projection(const StepConstants& step, const Real& most_force)
{
    return Real(step.substep * step.substep) * most_force;
}

/// For lower <= C <= upper. Only the nearer limit acts; where both are equal, the coordinate is locked.
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

/// For a spring, a soft C = 0, of an impulse of at most `most`. A spring is a force, so relaxation keeps its softness.
template <class Real>
Real spring_impulse(const SoftRow<Real>& spring, const Real& c, const Real& speed, const Real& held,
                    const Real& most)
{
    const Real wanted = held - spring.effective_mass * (speed + spring.rate * c) - spring.kept * held;
    return maximum(minimum(wanted, most), -most);
}

}  // namespace motley
