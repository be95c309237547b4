// Claims, spins and the hand-over between stages.
#include "stage_runner.h"

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>

#include "motley/core/invalid_input.h"

namespace motley {
namespace {

inline void pause()
{
#if defined(__x86_64__)
    __builtin_ia32_pause();
#endif
}

/// Spins before a thread yields its core to others: longer than any serial stretch inside a sweep, shorter than a
/// scheduler's slice, so that a loaded machine is not held up by a worker without work.
constexpr int spins_before_yield = 4000;
/// Spins before a thread takes the last chunk of another's share: longer than a chunk takes.
constexpr int spins_before_last_chunk = 400;
/// For how long a thread that an executor lends waits for the caller: longer than a caller is late on a loaded machine.
constexpr std::chrono::milliseconds patience{100};
/// Weight of one stage's measurement of the workers' speeds in their learned shares.
constexpr double learning_rate = 1.0 / 32;

void wait_a_moment(int spins)
{
    if (spins < spins_before_yield) {
        pause();
    } else {
        std::this_thread::yield();
    }
}

/// A share in one word: its stage, whether its worker has begun it, its last chunk plus one, and the next chunk to
/// claim.
struct ShareWord {
    static constexpr int bits = 24;
    static constexpr std::uint64_t most = (std::uint64_t{1} << bits) - 1;
    static constexpr std::uint64_t owner_came = std::uint64_t{1} << 2 * bits;
    std::uint64_t word;
    static ShareWord of(std::uint32_t stage, std::uint64_t first, std::uint64_t last)
    {
        return {std::uint64_t{stage} << (2 * bits + 1) | last << bits | first};
    }
    [[nodiscard]] std::uint64_t stage() const { return word >> (2 * bits + 1); }
    [[nodiscard]] std::uint64_t last() const { return word >> bits & most; }
    [[nodiscard]] std::uint64_t next() const { return word & most; }
    /// The number of chunks that other workers may not claim yet.
    [[nodiscard]] std::uint64_t reserved() const { return (word & owner_came) != 0 ? 1 : 0; }
};

int checked_concurrency(const Executor& executor)
{
    const int concurrency = executor.concurrency();
    if (concurrency < 1 || concurrency > StageRunner::most_workers)
        refuse("SolverOptions.executor.concurrency()", concurrency, "1 to 1024");
    return concurrency;
}

}  // namespace

StageRunner::StageRunner(Executor* executor)
    : executor_(executor),
      workers_(checked_concurrency(*executor)),
      shares_(std::make_unique<Share[]>(static_cast<std::size_t>(workers_)))
{
    for (int worker = 0; worker < workers_; ++worker)
        shares_[static_cast<std::size_t>(worker)].size = 1.0 / workers_;
}

void StageRunner::open()
{
    closed_.store(false, std::memory_order_relaxed);
    open_ = true;
}

/// Returns what the executor throws, or null.
std::exception_ptr StageRunner::run_on_executor(Job job)
{
    try {
        executor_->run(workers_, job);
    } catch (...) {
        closed_.store(true, std::memory_order_release);
        return std::current_exception();
    }
    return nullptr;
}

void StageRunner::publish(ChunkJob job, std::int64_t count)
{
    done_.store(0, std::memory_order_relaxed);
    ++stage_;
    hand_out(job, count);
    for (int spins = 0; done_.load(std::memory_order_acquire) != count;) {
        spins = come_to_work(0, spins) ? 0 : spins + 1;
    }
    learn_sizes(count);
    if (failed_.exchange(false, std::memory_order_acquire))
        std::rethrow_exception(std::exchange(failure_, nullptr));
}

/// Publishes the caller's own share last: the other workers begin while it is still publishing.
void StageRunner::hand_out(ChunkJob job, std::int64_t count)
{
    double before = 1;  // the part of all workers before this one
    auto last = static_cast<std::uint64_t>(count);
    for (int worker = workers_; worker-- > 0;) {
        Share& share = shares_[static_cast<std::size_t>(worker)];
        before -= share.size;
        const std::uint64_t first =
            worker == 0 ? 0
                        : std::min(last, static_cast<std::uint64_t>(
                                             std::max(0.0, before * static_cast<double>(count) + 0.5)));
        share.job = job;
        share.word.store(ShareWord::of(stage_, first, last).word, std::memory_order_release);
        last = first;
    }
}

/// A worker that ran more than its share gets a larger one next time.
void StageRunner::learn_sizes(std::int64_t count)
{
    const bool tells = count >= 4 * workers_;
    for (int worker = 0; worker < workers_; ++worker) {
        Share& share = shares_[static_cast<std::size_t>(worker)];
        const auto ran = static_cast<double>(std::exchange(share.ran, 0));
        if (tells) share.size += learning_rate * (ran / static_cast<double>(count) - share.size);
    }
}

/// A chunk that throws counts as done, because the caller waits for it.
void StageRunner::run_chunk(const ChunkJob& job, std::int64_t index, int worker)
{
    if (failed_.load(std::memory_order_relaxed)) return;
    try {
        job.call(job.self, index, worker);
    } catch (...) {
        if (!failed_.exchange(true, std::memory_order_relaxed)) failure_ = std::current_exception();
    }
}

/// Claims a chunk of the share of worker `whose` and runs it, if the share is of this stage. With `patient`, the last
/// chunk of another worker that has begun the stage is left to that worker.
bool StageRunner::claim_and_run(int whose, int worker, std::uint64_t stage, bool patient)
{
    Share& share = shares_[static_cast<std::size_t>(whose)];
    std::atomic<std::uint64_t>& word = share.word;
    const bool is_own = whose == worker;
    ShareWord seen{word.load(std::memory_order_acquire)};
    while (seen.stage() == stage && seen.next() + (patient ? seen.reserved() : 0) < seen.last()) {
        const std::uint64_t claimed = (seen.word + 1) | (is_own ? ShareWord::owner_came : 0);
        if (word.compare_exchange_weak(seen.word, claimed, std::memory_order_acq_rel,
                                       std::memory_order_acquire)) {
            run_chunk(share.job, static_cast<std::int64_t>(seen.next()), worker);
            return true;
        }
    }
    return false;
}

bool StageRunner::help_others(int worker, std::uint64_t stage, bool patient)
{
    for (int i = 1; i < workers_; ++i) {
        const int whose = worker + i < workers_ ? worker + i : worker + i - workers_;
        if (claim_and_run(whose, worker, stage, patient)) return true;
    }
    return false;
}

/// Runs what is left of the worker's own share, or else a chunk of another's of the same stage. Waits a moment when
/// there is none.
bool StageRunner::come_to_work(int worker, int spins)
{
    Share& own = shares_[static_cast<std::size_t>(worker)];
    const std::uint64_t stage = ShareWord{own.word.load(std::memory_order_acquire)}.stage();
    std::int64_t count = 0;
    while (claim_and_run(worker, worker, stage, false)) ++count;
    if (count == 0 && help_others(worker, stage, spins < spins_before_last_chunk)) count = 1;
    if (count > 0) {
        own.ran += count;
        done_.fetch_add(count, std::memory_order_release);
        return true;
    }
    wait_a_moment(spins);
    return false;
}

bool StageRunner::comes_in_time(const std::atomic<bool>& begun)
{
    const auto last = std::chrono::steady_clock::now() + patience;
    for (int spins = 0; !begun.load(std::memory_order_acquire); ++spins) {
        if (spins >= spins_before_yield && std::chrono::steady_clock::now() > last) return false;
        wait_a_moment(spins);
    }
    return true;
}

void StageRunner::work(int worker)
{
    int spins = 0;
    while (!closed_.load(std::memory_order_acquire)) {
        spins = come_to_work(worker, spins) ? 0 : spins + 1;
    }
}

}  // namespace motley
