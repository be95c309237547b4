// Opens a solver for the parts of the library that need more of it than a host does.
#pragma once

#include "motley/parallel/solver.h"
#include "region_link.h"

namespace motley {

struct SolverAccess {
    /// From now on the scenes that it steps are regions of a larger crowd; null: they are not.
    static void set_region(Solver& solver, RegionLink* region);
};

}  // namespace motley
