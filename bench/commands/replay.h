// One step's problem, solved again.
#pragma once

#include <string>

#include "motley/motley.h"

namespace motley::bench {

/// Runs `steps` steps from a problem of save_problem(), with its contacts in the first step only. Returns as text the
/// hash of the state, what was left unsolved, and where the time went.
std::string replay(StepProblem problem, const SolverOptions& options, int steps);

}  // namespace motley::bench
