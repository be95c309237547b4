// The main job: one command that shows what the library does and what it costs here.
#pragma once

namespace motley::bench {

struct DemoOptions {
    double seconds = 1;  ///< of each crowd run
    int rounds = 3;
};

/// Runs the bottleneck, then the crowd at 10,000 and 100,000 people: scalar, the widest instruction set, and that
/// on two threads, interleaved. Returns 1 if any two ways end in different bits, else 0.
int run_demo(const DemoOptions& options);

}  // namespace motley::bench
