// Claims, spins and the hand-over between stages.
#include "stage_runner.h"

#include <thread>

namespace motley {
namespace {

inline void pause()
{
#if defined(__x86_64__)
    __builtin_ia32_pause();
#endif
}

/// Spins before a thread offers its core to others: longer than any serial stretch inside a sweep, shorter
/// than a scheduler's slice, so that a loaded machine is not held up by a worker without work.
constexpr int spins_before_yield = 4000;

}  // namespace

void StageRunner::open()
{
    closed_.store(false, std::memory_order_relaxed);
    tickets_.store(0, std::memory_order_relaxed);
    open_ = true;
}

void StageRunner::publish(Job job, std::uint32_t count)
{
    job_ = job;
    done_.store(0, std::memory_order_relaxed);
    tickets_.store(std::uint64_t{count} << 32, std::memory_order_release);
    while (claim_and_run()) {
    }
    for (int spins = 0; done_.load(std::memory_order_acquire) != count;) {
        if (++spins < spins_before_yield) {
            pause();
        } else {
            std::this_thread::yield();
        }
    }
}

bool StageRunner::claim_and_run()
{
    std::uint64_t tickets = tickets_.load(std::memory_order_acquire);
    for (;;) {
        const auto next = static_cast<std::uint32_t>(tickets);
        if (next >= static_cast<std::uint32_t>(tickets >> 32)) return false;
        if (tickets_.compare_exchange_weak(tickets, tickets + 1, std::memory_order_acq_rel,
                                           std::memory_order_acquire)) {
            job_.call(job_.self, next);
            done_.fetch_add(1, std::memory_order_release);
            return true;
        }
    }
}

void StageRunner::work()
{
    int spins = 0;
    while (!closed_.load(std::memory_order_acquire)) {
        if (claim_and_run()) {
            spins = 0;
        } else if (++spins < spins_before_yield) {
            pause();
        } else {
            std::this_thread::yield();
        }
    }
}

}  // namespace motley
