// Soak: a small town that is never at rest, stepped for as long as asked by two solvers that must agree.
#pragma once

#include <cstdint>
#include <string>

namespace motley::bench {

struct SoakOptions {
    double seconds = 60;         ///< of the clock, > 0
    std::int64_t steps = 0;      ///< > 0: so many, whatever the clock says
    std::int64_t people = 1000;  ///< about how many, >= 10
    std::uint64_t seed = 12345;
    bool progress = true;  ///< a line on stderr that is written over
};

struct SoakResult {
    std::int64_t steps = 0;
    std::int64_t joined = 0, left = 0;   ///< people
    std::int64_t fallen = 0, risen = 0;  ///< planar people who became figures of rigid bodies, and back
    std::int64_t broken = 0;             ///< joints that bore too much
    std::int64_t restored = 0;  ///< times that the second solver went on from a file of the first's scene
    std::int64_t most_bodies = 0, most_contacts = 0;
    double memory_before = 0, memory_after = 0;  ///< MB resident, most in the second and in the last quarter
    std::string failure;                         ///< what was wrong, in which step; empty: nothing
};

/// Runs the soak: people walk, join and leave; some fall and become figures with joints and limits, whose joints
/// blows may break, and rise again. After every step the scenes on one thread and on two must have the same hash,
/// every handle must be alive or dead as the host knows it, and every body must be finite, in place and slow enough.
/// Ends at the first failure. Memory that grows from the second to the last quarter by more than 1 % and 2 MB is a
/// failure.
SoakResult soak(const SoakOptions& options);

/// As a table.
std::string table_of(const SoakResult& result, double seconds);

}  // namespace motley::bench
