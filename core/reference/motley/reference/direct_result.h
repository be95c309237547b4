// The result of a step of Method::direct.
#pragma once

namespace motley::reference {

/// How well a step was solved.
struct DirectResult {
    double violation =
        0;             ///< largest residual of the equations and inequalities of all substeps, m/s or rad/s
    int unsolved = 0;  ///< islands with a residual above 1e-9, summed over the substeps
};

}  // namespace motley::reference
