// Runs the stages of a step on an executor's threads without giving them back between stages. Each worker has a share
// of a stage's chunks, about the same share every time, so that a sweep finds in a core's cache what the last one
// left there. A worker that is done helps the others, and gets a slightly larger share next time, because cores are
// seldom equally fast. A share is one word that says which stage it is of, how many chunks it has and how many are
// claimed. Workers spin on it, and a claim is one compare and swap, so a hand-over costs a few hundred nanoseconds
// instead of a task launch. The caller claims from every share and waits only for chunks that a worker has begun: a
// step finishes with any number of other threads, even none.
//
// A chunk that runs on another core moves its bodies to that core's cache, and the next stage has to move them back,
// which takes several times as long as the chunk. So no worker helps others before its own share of the stage is
// published, and the last chunk of a worker that has begun the stage is reserved for it for a while.
#pragma once

#include <atomic>
#include <cstdint>
#include <exception>
#include <memory>
#include <stdexcept>
#include <type_traits>

#include "float_environment.h"
#include "motley/parallel/executor.h"

namespace motley {

class StageRunner {
  public:
    static constexpr int most_workers = 1024;
    /// Refuses an executor whose concurrency is not 1 to 1024.
    explicit StageRunner(Executor* executor);
    [[nodiscard]] int workers() const { return workers_; }

    /// Calls `body()` on this thread with the executor's other threads standing by for run() unless `alone`, all of
    /// them in the floating-point environment of a step. Throws what `body` or a chunk threw, and what the executor
    /// threw before it called anything. What the executor threw after `body` was done is returned, because the work
    /// of `body` stands.
    template <class Body>
    std::exception_ptr with_workers(bool alone, const Body& body)
    {
        if (workers_ == 1 || alone) {
            const StepFloats floats;
            body();
            return nullptr;
        }
        struct Call {
            const Body& body;
            std::atomic<bool> begun{false};
            std::exception_ptr failure{};
        } own{body};
        open();
        // No exception leaves a call: threads that wait for the caller would wait forever, and the host's threads need
        // not be able to handle it.
        std::exception_ptr executors = run_on_executor([this, &own](int worker) noexcept {
            if (worker < 0 || worker >= workers_) return;
            const StepFloats floats;
            if (worker != 0) {
                if (comes_in_time(own.begun)) work(worker);
                return;
            }
            if (own.begun.exchange(true)) return;
            try {
                own.body();
            } catch (...) {
                own.failure = std::current_exception();
            }
            closed_.store(true, std::memory_order_release);
        });
        open_ = false;
        if (own.failure) std::rethrow_exception(own.failure);
        if (own.begun) return executors;
        if (executors) std::rethrow_exception(executors);
        throw std::runtime_error("Executor.run returned without calling job(0)");
    }

    /// Calls chunk(i), or chunk(i, worker), for each i in [0, count), on any of the threads; returns when all are
    /// done. A single chunk runs on the calling thread, and so do all chunks when no other thread stands by. When a
    /// chunk throws, those that have not begun are left out, and the exception is thrown here.
    template <class Chunk>
    void run(std::int64_t count, const Chunk& chunk)
    {
        if (count <= 1 || !open_) {
            for (std::int64_t i = 0; i < count; ++i) call(chunk, i, 0);
            return;
        }
        publish({&chunk, [](const void* self, std::int64_t i,
                            int worker) { call(*static_cast<const Chunk*>(self), i, worker); }},
                count);
    }

    [[nodiscard]] Executor* executor() const { return executor_; }

  private:
    /// A Job of a stage: it is called with the chunk too.
    struct ChunkJob {
        const void* self = nullptr;
        void (*call)(const void* self, std::int64_t index, int worker) = nullptr;
    };
    template <class Chunk>
    static void call(const Chunk& chunk, std::int64_t index, int worker)
    {
        if constexpr (std::is_invocable_v<const Chunk&, std::int64_t, int>) {
            chunk(index, worker);
        } else {
            chunk(index);
        }
    }
    /// All that a worker needs to know of a stage is in one cache line. A claim that succeeds is always one of the
    /// present stage: the caller does not move on before every claimed chunk is done.
    struct alignas(64) Share {
        std::atomic<std::uint64_t> word{0};  ///< a ShareWord
        ChunkJob job;                        ///< of the stage that the word is of
        std::int64_t ran = 0;                ///< chunks of this stage, of any share, that its worker ran
        double size = 0;                     ///< fraction of all chunks; only the caller uses it
    };
    void open();
    std::exception_ptr run_on_executor(Job job);
    void publish(ChunkJob job, std::int64_t count);
    void hand_out(ChunkJob job, std::int64_t count);
    void learn_sizes(std::int64_t count);
    void run_chunk(const ChunkJob& job, std::int64_t index, int worker);
    bool claim_and_run(int whose, int worker, std::uint64_t stage, bool patient);
    bool help_others(int worker, std::uint64_t stage, bool patient);
    bool come_to_work(int worker, int spins);
    /// Waits for the caller to begin, but not for long: an executor that fails before it calls job(0) may join this
    /// thread before anybody hears of the failure. Returns whether the caller has begun.
    static bool comes_in_time(const std::atomic<bool>& begun);
    void work(int worker);

    Executor* executor_;
    bool open_ = false;
    int workers_;
    std::uint32_t stage_ = 0;
    std::unique_ptr<Share[]> shares_;
    alignas(64) std::atomic<std::int64_t> done_{0};
    alignas(64) std::atomic<bool> closed_{false};
    std::atomic<bool> failed_{false};  ///< a chunk of this stage threw
    std::exception_ptr failure_;       ///< what it threw; written by the thread that set failed_
};

}  // namespace motley
