// Detects a second step on a scene or solver that is in use.
#pragma once

#include <atomic>

namespace motley {

/// Set while a step uses a scene or a solver. A copy starts unset, because it is another scene.
class BusyFlag {
  public:
    BusyFlag() = default;
    BusyFlag(const BusyFlag&) noexcept {}
    BusyFlag& operator=(const BusyFlag&) noexcept { return *this; }

    /// Takes the flag unless it is taken, and releases it at the end of its scope.
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
        /// False: the flag was taken already.
        [[nodiscard]] bool holds() const { return holds_; }

      private:
        BusyFlag& flag_;
        bool holds_;
    };

  private:
    std::atomic<bool> taken_{false};
};

}  // namespace motley
