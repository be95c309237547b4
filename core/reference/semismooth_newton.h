// The solver of one part of a problem.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "complementarity.h"

namespace motley::reference {

/// Solves groups that connect bodies with each other, from their guesses, and returns the violation. `place`: the number of each
/// body of the problem within this part, whose bodies are numbered from 0 on. Writes the change y of their scaled velocities.
double solve_part(const std::vector<RowGroup*>& groups, const std::vector<int>& place, int bodies,
                  Eigen::VectorXd& change);

}  // namespace motley::reference
