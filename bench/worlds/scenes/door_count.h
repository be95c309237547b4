// Counts the people who pass a door.
#pragma once

#include <algorithm>
#include <vector>

#include "worlds/bench_scene.h"

namespace motley::bench {

/// Their flow, and how often and how long nobody passed.
class DoorCount {
  public:
    static constexpr double clog = 1;  ///< s without anybody from which on the door counts as clogged

    void pass(double time)
    {
        if (passed_++ == 0)
            first_ = time;
        else
            wait(time - last_);
        last_ = time;
    }
    /// Ends the count while people still wait.
    void stop(double time)
    {
        if (passed_ > 0) wait(time - last_);
    }
    [[nodiscard]] int passed() const { return passed_; }
    [[nodiscard]] int clogs() const { return clogs_; }
    [[nodiscard]] double clogged() const { return clogged_; }  ///< s
    [[nodiscard]] double longest() const { return longest_; }  ///< s
    /// Persons a second, from the first who passed to the last.
    [[nodiscard]] double flow() const { return passed_ > 1 ? (passed_ - 1) / (last_ - first_) : 0; }

  private:
    int passed_ = 0, clogs_ = 0;
    double first_ = 0, last_ = 0, clogged_ = 0, longest_ = 0;

    void wait(double seconds)
    {
        longest_ = std::max(longest_, seconds);
        if (seconds <= clog) return;
        ++clogs_;
        clogged_ += seconds;
    }
};

}  // namespace motley::bench
