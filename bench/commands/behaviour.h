// What the steering of a crowd decides, beside what was measured with people. None of it tests the solver.
#pragma once

namespace motley::bench {

struct BehaviourOptions {
    bool quick = false;  ///< fewer people, shorter runs
};

/// Prints the tables one after another: flow against the width of a door, its drift with the step, speed against density,
/// counterflow, steering models, and what a sparse crowd costs.
void print_behaviour(const BehaviourOptions& options);

}  // namespace motley::bench
