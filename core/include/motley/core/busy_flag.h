// Tells a second thread that somebody is at work here.
#pragma once

#include <atomic>

namespace motley {

/// Set while a step is at work on a scene, or by a solver. A copy is at rest: it is another scene.
class BusyFlag {
  public:
    BusyFlag() = default;
    BusyFlag(const BusyFlag&) noexcept {}
    BusyFlag& operator=(const BusyFlag&) noexcept { return *this; }

    /// Takes the flag unless it is taken, and gives it back at the end.
    class Hold {
      public:
        explicit Hold(BusyFlag& flag)
            : flag_(flag), holds_(!flag.taken_.exchange(true, std::memory_order_acquire))
        {
        }
        ~Hold()
        {
            if (holds_) flag_.taken_.store(false, std::memory_order_release);
        }
        Hold(const Hold&) = delete;
        Hold& operator=(const Hold&) = delete;
        /// False: somebody else has it.
        [[nodiscard]] bool holds() const { return holds_; }

      private:
        BusyFlag& flag_;
        bool holds_;
    };

  private:
    std::atomic<bool> taken_{false};
};

}  // namespace motley
