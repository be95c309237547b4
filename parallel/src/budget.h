// How much work fits into a given time, learned from the steps before.
#pragma once

#include <algorithm>

namespace motley {

/// The time of a step is a fixed part and a part for each unit of work, which is a substep or an iteration. The
/// estimates of both follow measurements quickly upwards and slowly downwards: a step that is late is worse than one
/// that is less exact.
class Budget {
  public:
    /// How many units fit into `seconds`, at least 1 and at most `most`; 1 before anything has been learned.
    [[nodiscard]] int units_within(double seconds, int most) const
    {
        if (unit_ <= 0) return 1;
        return static_cast<int>(std::clamp((seconds - fixed_) / unit_, 1.0, static_cast<double>(most)));
    }
    /// Takes in how long a step with `units` units took.
    void learn(double fixed_seconds, double work_seconds, int units)
    {
        follow(fixed_, fixed_seconds);
        follow(unit_, work_seconds / units);
    }

  private:
    double fixed_ = 0, unit_ = 0;  ///< s

    static void follow(double& estimate, double seen)
    {
        constexpr double upwards = 0.5, downwards = 0.1;
        estimate =
            estimate == 0 ? seen : estimate + (seen > estimate ? upwards : downwards) * (seen - estimate);
    }
};

}  // namespace motley
