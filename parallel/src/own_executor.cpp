// See own_executor.h.
#include "own_executor.h"

namespace motley {
namespace {

class InlineExecutor final : public Executor {
  public:
    [[nodiscard]] int concurrency() const override { return 1; }
    void run(int, Job job) override { job(0); }
};

}  // namespace

std::unique_ptr<Executor> make_executor([[maybe_unused]] int threads)
{
#ifndef MOTLEY_WITHOUT_TBB
    if (threads > 1) return make_tbb_executor(threads);
#endif
    return std::make_unique<InlineExecutor>();
}

}  // namespace motley
