// The executor that a solver makes for itself when the host passes none.
#pragma once

#include <memory>

#include "motley/parallel/executor.h"

namespace motley {

/// An arena of oneTBB with `threads` >= 1 threads. With 1, and where the library is built without oneTBB (MOTLEY_TBB=OFF), no thread
/// is ever started and the job runs on the caller.
std::unique_ptr<Executor> make_executor(int threads);

/// The one of oneTBB: in tbb_executor.cpp.
std::unique_ptr<Executor> make_tbb_executor(int threads);

}  // namespace motley
