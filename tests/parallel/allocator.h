// The operator new of this executable: it counts, and fails when told to. Defined in allocation_test.cpp.
#pragma once

#include <atomic>
#include <limits>

namespace motley::testing {

inline constexpr long never = std::numeric_limits<long>::max();
extern std::atomic<long> allocations;
extern std::atomic<long> bytes_allocated;
/// How many more allocations succeed, and how many of those after that fail.
extern std::atomic<long> allocations_until_failure;
extern std::atomic<long> failures_left;

/// While it lives, the allocation after `successes` others fails: only that one, or also all that follow.
class FailingAllocator {
  public:
    FailingAllocator(long successes, bool for_good)
    {
        failures_left = for_good ? never : 1;
        allocations_until_failure = successes;
    }
    ~FailingAllocator() { allocations_until_failure = never; }
    FailingAllocator(const FailingAllocator&) = delete;
    FailingAllocator& operator=(const FailingAllocator&) = delete;
    /// Whether an allocation has failed.
    [[nodiscard]] static bool has_failed() { return allocations_until_failure < 0; }
};

}  // namespace motley::testing
