// oneTBB behind the executor interface.
#include "own_executor.h"

#include <tbb/global_control.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <new>
#include <optional>

namespace motley {
namespace {

class TbbExecutor final : public Executor {
  public:
    explicit TbbExecutor(int threads) : threads_(threads), arena_(threads, 1)
    {
        // oneTBB starts more threads than cores only if it is told so, and that setting is process-wide: it is left
        // alone unless the host asks for such a number.
        if (threads > tbb::this_task_arena::max_concurrency()) {
            limit_.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
        }
    }
    [[nodiscard]] int concurrency() const override { return threads_; }
    void run(int workers, Job job) override
    {
        arena_.execute([&] {
            tbb::task_group group;
            try {
                for (int worker = 1; worker < workers; ++worker) group.run([job, worker] { job(worker); });
            } catch (const std::bad_alloc&) {
                // The step finishes with the workers that have started.
            }
            job(0);
            group.wait();
        });
    }

  private:
    int threads_;
    std::optional<tbb::global_control> limit_;
    tbb::task_arena arena_;
};

}  // namespace

std::unique_ptr<Executor> make_tbb_executor(int threads)
{
    return std::make_unique<TbbExecutor>(threads);
}

}  // namespace motley
