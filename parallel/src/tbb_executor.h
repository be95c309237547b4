// The executor that a solver makes for itself: an arena of oneTBB.
#pragma once

#include <memory>

#include "motley/parallel/executor.h"

namespace motley {

/// `threads` >= 1; with 1 no thread is ever started and the job runs on the calling thread.
std::unique_ptr<Executor> make_executor(int threads);

}  // namespace motley
