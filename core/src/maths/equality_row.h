// One row of an equality constraint, as the solver of exact joints (SolverSettings::exact_joints) reads it.
#pragma once

#include "motley/core/vector.h"

namespace motley {

/// J = [-linear, -lever_a, linear, lever_b] over the velocities (v_a, omega_a, v_b, omega_b), and C, both in the
/// present poses of the bodies.
template <class Real>
struct EqualityRow {
    Vec3<Real> linear;
    Vec3<Real> lever_a, lever_b;
    Real error;  ///< C, m or rad
};

}  // namespace motley
