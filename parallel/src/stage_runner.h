// Runs the stages of a step on an executor's threads without giving them back between stages. Workers spin on
// one word that says how many chunks the current stage has and how many are claimed; a claim is one compare
// and swap, so a hand-over costs a few hundred nanoseconds instead of a task launch. The caller claims chunks
// too and waits only for chunks that a worker has begun: a step finishes with whichever threads come, even
// none.
#pragma once

#include <atomic>
#include <cstdint>

#include "motley/parallel/executor.h"

namespace motley {

class StageRunner {
  public:
    explicit StageRunner(Executor* executor) : executor_(executor) {}

    /// Calls `body()` on this thread with the executor's other threads standing by for run().
    template <class Body>
    void with_workers(const Body& body)
    {
        if (executor_ == nullptr || executor_->concurrency() == 1) {
            body();
            return;
        }
        open();
        // Two words captured: small enough that std::function does not allocate.
        executor_->run(executor_->concurrency(), [this, &body](int worker) {
            if (worker != 0) {
                work();
                return;
            }
            body();
            closed_.store(true, std::memory_order_release);
        });
        open_ = false;
    }

    /// Calls chunk(i) for each i in [0, count), on whichever thread; returns when all are done. A single
    /// chunk, or no other thread, runs in line.
    template <class Chunk>
    void run(std::int64_t count, const Chunk& chunk)
    {
        if (count <= 1 || !open_) {
            for (std::int64_t i = 0; i < count; ++i) chunk(i);
            return;
        }
        publish({&chunk, [](const void* self, std::int64_t i) { (*static_cast<const Chunk*>(self))(i); }},
                static_cast<std::uint32_t>(count));
    }

    [[nodiscard]] Executor* executor() const { return executor_; }

  private:
    struct Job {
        const void* self = nullptr;
        void (*call)(const void* self, std::int64_t index) = nullptr;
    };
    void open();
    void publish(Job job, std::uint32_t count);
    bool claim_and_run();
    void work();

    Executor* executor_;
    bool open_ = false;
    Job job_;
    // Chunks of the stage in the high half, the next to claim in the low half. A claim that succeeds is
    // always one of the present stage: the caller does not move on before every claimed chunk is done.
    alignas(64) std::atomic<std::uint64_t> tickets_{0};
    alignas(64) std::atomic<std::uint32_t> done_{0};
    alignas(64) std::atomic<bool> closed_{false};
};

}  // namespace motley
