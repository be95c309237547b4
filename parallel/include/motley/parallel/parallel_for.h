// A loop over an executor, for a host's own work between steps (steering, neighbour search).
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>

#include "motley/parallel/executor.h"

namespace motley {

/// Calls body(begin, end) for consecutive chunks of at most `grain` elements that cover [0, count), on
/// whichever thread comes; returns when all are done. The chunks do not depend on the number of threads.
template <class Body>
void parallel_for(Executor& executor, std::int64_t count, std::int64_t grain, const Body& body)
{
    std::atomic<std::int64_t> next{0};
    const auto work = [&](int) {
        for (std::int64_t begin = next.fetch_add(grain); begin < count; begin = next.fetch_add(grain)) {
            body(begin, begin + grain < count ? begin + grain : count);
        }
    };
    if (executor.concurrency() == 1 || count <= grain) {
        work(0);
    } else {
        executor.run(executor.concurrency(), std::ref(work));  // a reference: std::function need not allocate
    }
}

}  // namespace motley
