// oneTBB behind the executor interface.
#include "tbb_executor.h"

#include <tbb/global_control.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

namespace motley {
namespace {

class InlineExecutor final : public Executor {
  public:
    [[nodiscard]] int concurrency() const override { return 1; }
    void run(int, const std::function<void(int)>& job) override { job(0); }
};

class TbbExecutor final : public Executor {
  public:
    explicit TbbExecutor(int threads)
        : threads_(threads),
          // More threads than cores must still be real threads: the tests of equal bits count on it.
          limit_(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads)),
          arena_(threads, 1)
    {
    }
    [[nodiscard]] int concurrency() const override { return threads_; }
    void run(int workers, const std::function<void(int)>& job) override
    {
        arena_.execute([&] {
            tbb::task_group group;
            for (int worker = 1; worker < workers; ++worker) {
                group.run([&job, worker] { job(worker); });
            }
            job(0);
            group.wait();
        });
    }

  private:
    int threads_;
    tbb::global_control limit_;
    tbb::task_arena arena_;
};

}  // namespace

std::unique_ptr<Executor> make_executor(int threads)
{
    if (threads == 1) return std::make_unique<InlineExecutor>();
    return std::make_unique<TbbExecutor>(threads);
}

}  // namespace motley
