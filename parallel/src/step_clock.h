// Measures where the time of a step goes.
#pragma once

#include <chrono>
#include <cstddef>
#include <optional>

#include "motley/core/step_report.h"

namespace motley {

/// Adds the time from one enter() to the next, or to leave(), to the stage that was entered. Reads the clock only
/// when the stage changes.
class StepClock {
  public:
    explicit StepClock(StepReport& report) : report_(report) {}
    void enter(Stage stage)
    {
        if (stage_ == stage) return;
        charge();
        stage_ = stage;
    }
    /// The time from here on is counted for no stage.
    void leave()
    {
        charge();
        stage_.reset();
    }

  private:
    using Clock = std::chrono::steady_clock;
    StepReport& report_;
    std::optional<Stage> stage_;
    Clock::time_point began_ = Clock::now();

    void charge()
    {
        const Clock::time_point now = Clock::now();
        if (stage_) {
            report_.seconds[static_cast<std::size_t>(*stage_)] +=
                std::chrono::duration<double>(now - began_).count();
        }
        began_ = now;
    }
};

}  // namespace motley
