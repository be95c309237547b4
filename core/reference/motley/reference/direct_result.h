// What Method::direct says of its step.
#pragma once

namespace motley::reference {

/// How well a step was solved at once.
struct DirectResult {
    double violation =
        0;  ///< largest that is left of the equations and inequalities of all substeps, m/s or rad/s
    int unsolved = 0;  ///< islands with more than 1e-9 of it, counted in every substep
};

}  // namespace motley::reference
