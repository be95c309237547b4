// One row of a joint that locks something, as solvers of many joints at once see it.
#pragma once

#include "motley/core/vector.h"

namespace motley {

/// J = [-linear, -lever_a, linear, lever_b] over (v_a, omega_a, v_b, omega_b), and C, where the bodies are now.
template <class Real>
struct EqualityRow {
    Vec3<Real> linear;
    Vec3<Real> lever_a, lever_b;
    Real error;  ///< C, m or rad
};

}  // namespace motley
