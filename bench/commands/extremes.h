// Scenes with extreme numbers, each with a figure and a bound that follows from physics or rounding.
#pragma once

#include <array>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "motley/motley.h"

namespace motley::bench {

/// The ways to solve that each case is run under.
enum class ExtremeWay {
    soft_step,
    exact,  ///< soft_step with exact joints, limits and contacts
    baumgarte,
    projection,
    direct
};
inline constexpr int extreme_way_count = 5;
const char* name_of(ExtremeWay way);
/// The default settings of a way, without gravity.
SolverSettings settings_of(ExtremeWay way);

/// Used in place of a bound where no claim is made. The figure is printed all the same.
inline constexpr double no_claim = std::numeric_limits<double>::infinity();

struct ExtremeRun {
    ExtremeWay way;
    SolverOptions options;
};

struct ExtremeCase {
    const char* name;
    const char* must;  ///< what must happen, and why
    const char* unit;
    /// The largest figure allowed for each way, in `unit`.
    std::array<double, extreme_way_count> bound;
    /// Returns infinity when a state was not finite, a body was contained, or a step was refused.
    double (*figure)(const ExtremeRun& run);
};

std::span<const ExtremeCase> extreme_cases();

/// Runs every case under every way and prints a table. Returns how many figures are beyond their bounds.
int print_extremes(const SolverOptions& options);

}  // namespace motley::bench
