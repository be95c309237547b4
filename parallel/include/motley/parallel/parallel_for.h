// A loop over an executor, for a host's own work between steps (steering, neighbour search).
#pragma once

#include <cstdint>

#include "motley/parallel/executor.h"

#pragma GCC visibility push(default)
namespace motley {

/// parallel_for() below without its template: calls call(body, begin, end).
void run_in_chunks(Executor& executor, std::int64_t count, std::int64_t grain, const void* body,
                   void (*call)(const void* body, std::int64_t begin, std::int64_t end));

/// Calls body(begin, end) for consecutive chunks of at most `grain` elements that cover [0, count), on the executor's
/// threads; returns when all are done. The chunks do not depend on the number of threads. The caller starts at the
/// front and the others at the back, so that of two loops in a row over the same data each thread finds about the
/// same part in its cache. When a call throws, chunks that have not begun are left out, and what was thrown first is
/// thrown here once all threads are done. `body` is a function object that may be called when const.
template <class Body>
void parallel_for(Executor& executor, std::int64_t count, std::int64_t grain, const Body& body)
{
    run_in_chunks(executor, count, grain, &body, [](const void* of, std::int64_t begin, std::int64_t end) {
        (*static_cast<const Body*>(of))(begin, end);
    });
}

}  // namespace motley
#pragma GCC visibility pop
