// A loop over an executor, for a host's own work between steps (steering, neighbour search).
#pragma once

#include <atomic>
#include <cstdint>
#include <exception>

#include "motley/parallel/executor.h"

#pragma GCC visibility push(default)
namespace motley {

/// Calls body(begin, end) for consecutive chunks of at most `grain` elements that cover [0, count), on the executor's
/// threads; returns when all are done. The chunks do not depend on the number of threads. The caller starts at the
/// front and the others at the back, so that of two loops in a row over the same data each thread finds about the
/// same part in its cache. When a call throws, chunks that have not begun are left out, and what was thrown first is
/// thrown here once all threads are done.
template <class Body>
void parallel_for(Executor& executor, std::int64_t count, std::int64_t grain, const Body& body)
{
    const auto chunks = static_cast<std::uint32_t>((count + grain - 1) / grain);
    // The chunks that no thread has claimed: the first in the low half, one past the last in the high half.
    std::atomic<std::uint64_t> left{std::uint64_t{chunks} << 32};
    std::atomic<bool> failed{false};
    std::exception_ptr failure;
    const auto work_until_done = [&](int worker) {
        std::uint64_t seen = left.load();
        while (!failed.load(std::memory_order_relaxed)) {
            const auto first = static_cast<std::uint32_t>(seen),
                       last = static_cast<std::uint32_t>(seen >> 32);
            if (first == last) return;
            const std::uint64_t after = worker == 0 ? seen + 1 : seen - (std::uint64_t{1} << 32);
            if (!left.compare_exchange_weak(seen, after)) continue;
            const std::int64_t begin = grain * (worker == 0 ? first : last - 1);
            body(begin, begin + grain < count ? begin + grain : count);
            seen = left.load();
        }
    };
    // No exception leaves a call: the executor's threads need not be able to handle it.
    const auto work = [&](int worker) noexcept {
        try {
            work_until_done(worker);
        } catch (...) {
            if (!failed.exchange(true)) failure = std::current_exception();
        }
    };
    if (executor.concurrency() <= 1 || chunks <= 1) {
        work(0);
    } else {
        executor.run(executor.concurrency(), work);
        work(0);  // runs what is left if the executor made no call
    }
    if (failure) std::rethrow_exception(failure);
}

}  // namespace motley
#pragma GCC visibility pop
