// Visits the lanes of blocks one by one, for tests of what is in them.
#pragma once

#include <rapidcheck.h>

#include "layout/batches.h"

namespace motley::testing {

/// Calls visit(chunk, block, lane) for every lane with a constraint. All other lanes must refer to the null rows, to
/// which nothing may write.
template <class Visit>
void for_each_lane(const SweepLists& sweeps, const Visit& visit)
{
    for (const auto& chunks : sweeps.lists) {
        for (const SweepChunk& chunk : chunks) {
            for (std::int32_t block = chunk.begin; block < chunk.end; ++block) {
                const int count = chunk.streams.counts[block];
                for (int lane = 0; lane < count; ++lane) visit(chunk, block, lane);
                for (int lane = count; lane < block_lanes; ++lane) {
                    RC_ASSERT(chunk.streams.bodies[block].a[lane] == 0);
                    RC_ASSERT(chunk.streams.bodies[block].b[lane] == 0);
                }
            }
        }
    }
}

}  // namespace motley::testing
