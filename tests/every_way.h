// Settings for tests in which two scenes must step alike in every way.
#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "motley/motley.h"

namespace motley::testing {

/// Every way to solve a step that treats bodies in its own way.
inline std::vector<SolverSettings> every_way()
{
    std::vector<SolverSettings> ways(8);
    for (SolverSettings& settings : ways) settings.gravity = {0, -9.81F, 0};
    ways[1].exact_joints = true;
    ways[2].method = Method::sequential_impulse;
    ways[3].method = Method::direct;
    ways[4].measures = true;
    ways[5].tolerance = 1e-4F;
    ways[6].exact_contacts = true;
    ways[7].exact_joints = ways[7].exact_limits = true;
    return ways;
}

/// run(options) must return the same, such as hashes, for every instruction set and for one to three threads. Returns what it
/// returns in scalar lanes.
template <class Run>
auto expect_same_bits(const Run& run)
{
    const auto scalar = run(SolverOptions{.isa = Isa::scalar});
    for (const Isa isa : available_isas()) EXPECT_EQ(run(SolverOptions{.isa = isa}), scalar) << isa_name(isa);
    for (const int threads : {2, 3})
        EXPECT_EQ(run(SolverOptions{.threads = threads, .alone_below = 0}), scalar) << threads << " threads";
    return scalar;
}

/// The same settings, but nothing is solved in lockstep: a step that measures itself sweeps everything by colour.
inline SolverSettings swept(SolverSettings settings)
{
    settings.measures = true;
    return settings;
}

}  // namespace motley::testing
