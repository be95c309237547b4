#include "commands/cores.h"

#include <algorithm>
#include <atomic>
#include <limits>
#include <vector>

#include "measuring/clock.h"

namespace motley::bench {
namespace {

/// Multiplies and adds for about half a millisecond, in enough independent chains to keep every port of a core busy.
void keep_busy()
{
    using Four = float __attribute__((vector_size(16)));
    Four chains[12];
    for (int i = 0; i < 12; ++i) chains[i] = Four{} + (1.0F + 0.1F * static_cast<float>(i));
    const Four scale = Four{} + 0.999999F, step = Four{} + 1e-6F;
    for (int round = 0; round < 200'000; ++round) {
        for (Four& chain : chains) chain = chain * scale + step;
    }
    Four sum{};
    for (const Four& chain : chains) sum = sum + chain;
    [[maybe_unused]] const volatile float kept = sum[0];
}

/// A barrier that gives up after a while, because an executor may run fewer threads than it was asked for.
class Meeting {
  public:
    explicit Meeting(int threads) : threads_(threads) {}
    /// Waits at most 2 ms for the other threads. Returns whether all of them arrived.
    bool come()
    {
        constexpr double longest_wait = 2e-3;  // s
        int came = came_.load();
        do {
            if (came == closed) return false;
        } while (!came_.compare_exchange_weak(came, came + 1));
        for (const double began = now(); came_ != closed && came_ < threads_;) {
            came = came_.load();
            if (now() - began > longest_wait && came < threads_) came_.compare_exchange_strong(came, closed);
        }
        return came_ != closed;
    }

  private:
    static constexpr int closed = -1;
    int threads_;
    std::atomic<int> came_{0};
};

double measure_cores(Executor& executor)
{
    const int threads = executor.concurrency();
    const double began = now();
    keep_busy();
    const double alone = now() - began;
    Meeting meeting(threads);
    std::vector<double> together(static_cast<std::size_t>(threads), threads * alone);
    executor.run(threads, [&](int worker) {
        if (!meeting.come()) return;
        const double start = now();
        keep_busy();
        together[static_cast<std::size_t>(worker)] = now() - start;
    });
    return threads * alone / *std::max_element(together.begin(), together.end());
}

double measure_hand_over(Executor& executor)
{
    constexpr int rounds = 100;
    Meeting meeting(2);
    std::atomic<int> ball{0};
    double seconds = std::numeric_limits<double>::infinity();
    executor.run(2, [&](int worker) {
        if (!meeting.come()) return;
        const double start = now();
        for (int round = 0; round < rounds; ++round) {
            while (ball.load(std::memory_order_acquire) != 2 * round + worker) {
            }
            ball.store(2 * round + worker + 1, std::memory_order_release);
        }
        if (worker == 0) seconds = (now() - start) / (2 * rounds);
    });
    return seconds;
}

}  // namespace

CoresAtHand look_at_cores(Executor& executor)
{
    return {measure_cores(executor), measure_hand_over(executor)};
}

}  // namespace motley::bench
