// The main job: one command that shows what the library does and what it costs here.
#pragma once

namespace motley::bench {

struct DemoOptions {
    double seconds = 1;  ///< of each crowd run
    int rounds = 3;
};

/// Runs the bottleneck, then the crowd at 10,000, 100,000 and a million people: every instruction set, two threads,
/// and a list of contacts that a host searched, interleaved. Returns 1 if any two ways end in different bits, else 0.
int run_demo(const DemoOptions& options);

}  // namespace motley::bench
