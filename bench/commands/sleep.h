// What crowds and piles at rest cost, awake and asleep.
#pragma once

#include <string>
#include <vector>

#include "motley/motley.h"

namespace motley::bench {

struct SleepOptions {
    int side = 316;  ///< people in a row of the square crowd; >= 10
    int net = 141;   ///< bodies in a row of the net of listed contacts; >= 2
    int rounds = 3;  ///< runs of each, in turn; >= 1
    SolverOptions solver{};
};

struct SleepLine {
    std::string name;
    double seconds = 0;         ///< a step, median of the rounds' means
    std::int64_t contacts = 0;  ///< solved in the last step
    std::int64_t asleep = 0;    ///< after it
};

/// Throws InvalidInput for options of the solver out of range.
std::vector<SleepLine> measure_sleep(const SleepOptions& options);
std::string table_of(const std::vector<SleepLine>& lines);

}  // namespace motley::bench
