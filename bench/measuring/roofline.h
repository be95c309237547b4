// How close kernels come to what the machine can do: bandwidth and arithmetic measured in the same run.
#pragma once

#include <string>
#include <vector>

#include "motley/motley.h"

namespace motley::bench {

/// What the machine does at best.
struct MachineLimits {
    double memory_bytes_per_second = 0;      ///< triad over arrays far larger than the caches, one thread
    double memory_bytes_per_second_two = 0;  ///< the same on two threads
    double cache_bytes_per_second = 0;       ///< triad over arrays that fit a second level cache
    double flops_per_second = 0;  ///< multiplications and additions, not fused: what equal bits allow
};
MachineLimits measure_machine(Isa isa);
/// Best rate of x = y + s z over arrays far larger than the caches, B/s, counting three streams.
double memory_triad(int threads);

/// One kernel's sweep of `solve`.
struct KernelFigure {
    std::string name;  ///< as in every_tie()
    bool in_cache = true;
    Isa isa = Isa::scalar;
    double constraints = 0;
    double seconds = 0;  ///< a constraint and sweep
    double bytes = 0;    ///< streamed a constraint and sweep: rows, impulses, indices; bodies not counted
    double flops = 0;    ///< a constraint and sweep, counted; 0 where it has not been
};
/// The kernels whose operations are counted, each in cache and streaming.
std::vector<KernelFigure> measure_kernels(Isa isa);
/// One sweep of one kind of constraint in nanoseconds; the median of some steps.
KernelFigure measure_kernel(const std::string& tie, Isa isa, bool in_cache);

}  // namespace motley::bench
