// Prefetching the bodies of blocks, the same for every constraint type and instruction set.
#pragma once

#include "layout/block.h"

namespace motley {

/// Prefetches the rows of the bodies of a block, with or without their displacements. They are scattered in memory; the streams
/// of blocks are consecutive, so that the hardware prefetches them. Fixed bodies are few and stay in cache.
void prefetch_bodies(const KernelContext& context, const BlockStreams& streams, std::int64_t block,
                     bool with_delta);

}  // namespace motley
