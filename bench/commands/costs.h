// What each feature costs: the same step with one feature more, or one less.
#pragma once

#include <string>
#include <vector>

namespace motley::bench {

struct CostLine {
    std::string group;  ///< what is compared; the first line of a group is what the others are compared with
    std::string name;
    double seconds = 0;  ///< median solver time of a step
    double error = -1;   ///< overlap p99, share of the radius; negative where there is none
};

/// Runs every line in turn, `rounds` times, and takes medians.
std::vector<CostLine> measure_costs(int rounds, bool progress);

/// Throughput of the crowd on every instruction set and on two threads: agent-steps/s of the solver.
struct WayLine {
    std::string name;
    double agent_steps_per_second = 0;
};
std::vector<WayLine> measure_ways(int rounds, bool progress);

}  // namespace motley::bench
