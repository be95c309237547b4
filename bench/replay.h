// One step's problem, solved again.
#pragma once

#include <string>

#include "motley/motley.h"

namespace motley::bench {

/// Solves `steps` steps from a problem of save_problem(), with its contacts in the first of them alone, and says what came
/// of it: the state's hash, what was left unsolved, where the time went.
std::string replay(StepProblem problem, const SolverOptions& options, int steps);

}  // namespace motley::bench
