// One side of a limit, and a lock: what an accumulated impulse wants to be.
#pragma once

#include "motley/core/scalar.h"
#include "motley/core/step_constants.h"

namespace motley {

/// Of C >= 0 with speed dC/dt; the caller clamps it at 0. With room left it may be used up within the substep and no
/// further; without, the error goes as fast as the joints' softness and push_out_speed allow. Relaxation takes the
/// bias out.
template <bool relax, class Real>
Real limit_impulse(const StepConstants& step, const Real& c, const Real& speed, const Real& mass,
                   const Real& held)
{
    const auto room = c > Real(0);
    const Real closing = Real(step.inverse_substep) * c;
    const Real soft = relax ? Real(0) : maximum(Real(step.joint.rate) * c, Real(-step.push_out_speed));
    const Real mass_scale = relax ? Real(1) : select(room, Real(1), Real(step.joint.mass_scale));
    const Real impulse_scale = relax ? Real(0) : select(room, Real(0), Real(step.joint.impulse_scale));
    return held - mass_scale * mass * (speed + select(room, closing, soft)) - impulse_scale * held;
}

/// Of C = 0.
template <bool relax, class Real>
Real lock_impulse(const StepConstants& step, const Real& c, const Real& speed, const Real& mass,
                  const Real& held)
{
    if constexpr (relax) {
        return held - mass * speed;
    } else {
        return held - Real(step.joint.mass_scale) * mass * (speed + Real(step.joint.rate) * c) -
               Real(step.joint.impulse_scale) * held;
    }
}

}  // namespace motley
