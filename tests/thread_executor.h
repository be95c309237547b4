// A host's own threads, of the standard library. The thread sanitizer sees all that they synchronise, which it does not
// of oneTBB (.ci/tsan.supp).
#pragma once

#include <thread>
#include <vector>

#include "motley/parallel/executor.h"

namespace motley::testing {

/// Starts a thread for every worker, in no fixed order, and may leave some workers out.
class ThreadExecutor final : public Executor {
  public:
    ThreadExecutor(int concurrency, int lent) : concurrency_(concurrency), lent_(lent) {}
    [[nodiscard]] int concurrency() const override { return concurrency_; }
    void run(int workers, Job job) override
    {
        std::vector<std::thread> threads;
        for (int worker = workers - 1; worker >= 1; --worker) {
            if (worker <= lent_) threads.emplace_back([&job, worker] { job(worker); });
        }
        job(0);
        for (std::thread& thread : threads) thread.join();
        ++runs;
    }
    int runs = 0;

  private:
    int concurrency_, lent_;
};

}  // namespace motley::testing
