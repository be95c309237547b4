// How a step gets its threads: a host may pass its own pool, or let oneTBB do it.
#pragma once

#include "motley/parallel/job.h"

#pragma GCC visibility push(default)
namespace motley {

/// Lends threads to a step. Implement it to run motley on a job system of your own.
class Executor {
  public:
    virtual ~Executor() = default;
    /// Threads that may run a job at once, including the caller; 1 to 1024, constant.
    [[nodiscard]] virtual int concurrency() const = 0;
    /// Calls job(0) on the calling thread, and may call job(1) ... job(workers - 1) each once on other threads at any
    /// time meanwhile, or not at all: the step finishes with any number of them. Returns when every call that began
    /// has returned and no further one will begin; `job` is valid until then. A `job` of a step never throws, and one that
    /// has waited 0.1 s for job(0) returns without work: run may join its threads wherever it fails. When run
    /// throws before it has called job(0), the step is refused; when it throws afterwards, the step is done, and its
    /// report tells what was thrown. A solver calls it from the thread that called step(): from several at the same
    /// time only if the host steps several solvers on this executor at once (see Solver).
    virtual void run(int workers, Job job) = 0;
};

}  // namespace motley
#pragma GCC visibility pop
