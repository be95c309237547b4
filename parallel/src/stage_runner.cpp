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

StageRunner::StageRunner(Executor* executor)
    : executor_(executor),
      workers_(executor->concurrency()),
      shares_(std::make_unique<Share[]>(static_cast<std::size_t>(workers_)))
{
}

void StageRunner::open()
{
    closed_.store(false, std::memory_order_relaxed);
    open_ = true;
}

void StageRunner::publish(Job job, std::uint32_t count)
{
    job_ = job;
    done_.store(0, std::memory_order_relaxed);
    std::uint64_t first = 0;
    for (int worker = 0; worker < workers_; ++worker) {
        const std::uint64_t last = std::uint64_t{count} * static_cast<std::uint64_t>(worker + 1) /
                                   static_cast<std::uint64_t>(workers_);
        shares_[static_cast<std::size_t>(worker)].word.store(last << 32 | first, std::memory_order_release);
        first = last;
    }
    while (claim_and_run(0)) {
    }
    for (int spins = 0; done_.load(std::memory_order_acquire) != count;) {
        if (++spins < spins_before_yield) {
            pause();
        } else {
            std::this_thread::yield();
        }
    }
}

/// One chunk of the worker's own share, or else of the next one that has any left.
bool StageRunner::claim_and_run(int worker)
{
    for (int i = 0; i < workers_; ++i) {
        const int whose = worker + i < workers_ ? worker + i : worker + i - workers_;
        if (claim_and_run(shares_[static_cast<std::size_t>(whose)], worker)) return true;
    }
    return false;
}

bool StageRunner::claim_and_run(Share& share, int worker)
{
    std::uint64_t word = share.word.load(std::memory_order_acquire);
    for (;;) {
        const auto next = static_cast<std::uint32_t>(word);
        if (next >= static_cast<std::uint32_t>(word >> 32)) return false;
        if (share.word.compare_exchange_weak(word, word + 1, std::memory_order_acq_rel,
                                             std::memory_order_acquire)) {
            job_.call(job_.self, next, worker);
            done_.fetch_add(1, std::memory_order_release);
            return true;
        }
    }
}

void StageRunner::work(int worker)
{
    int spins = 0;
    while (!closed_.load(std::memory_order_acquire)) {
        if (claim_and_run(worker)) {
            spins = 0;
        } else if (++spins < spins_before_yield) {
            pause();
        } else {
            std::this_thread::yield();
        }
    }
}

}  // namespace motley
