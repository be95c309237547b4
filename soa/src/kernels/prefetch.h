// Prefetching what blocks are about to read, the same for every constraint type and instruction set.
#pragma once

#include "layout/block.h"

namespace motley {

/// Prefetches the rows of the bodies of a block, with or without their displacements. They are scattered in memory; the streams
/// of blocks are consecutive, so that the hardware prefetches them. Fixed bodies are few and stay in cache.
void prefetch_bodies(const KernelContext& context, const BlockStreams& streams, std::int64_t block,
                     bool with_delta);

/// Prefetches what `prepare` reads of the constraints of a block in the stores of the scene, or what `store` writes there. Copies of a
/// figure were added one after the other, so that the constraints of a block lie far apart.
void prefetch_to_prepare(const BlockStreams& streams, const ConstraintData& data, std::int64_t block);
void prefetch_to_store(const BlockStreams& streams, const ConstraintData& data, std::int64_t block);

}  // namespace motley
