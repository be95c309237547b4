// See parallel_for.h.
#include "motley/parallel/parallel_for.h"

#include <algorithm>
#include <atomic>
#include <exception>

namespace motley {

void run_in_chunks(Executor& executor, std::int64_t count, std::int64_t grain, const void* body,
                   void (*call)(const void* body, std::int64_t begin, std::int64_t end))
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
            call(body, begin, std::min(begin + grain, count));
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
