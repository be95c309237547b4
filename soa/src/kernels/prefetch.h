// Prefetching what kernels are about to read or write, the same for every constraint type and instruction set.
#pragma once

#include "layout/block.h"

namespace motley {

/// Prefetches the rows of the bodies of a block, with or without their displacements. They are scattered in memory; the streams
/// of blocks are consecutive, so that the hardware prefetches them. Fixed bodies are few and stay in cache.
void prefetch_bodies(const KernelContext& context, const BlockStreams& streams, std::int64_t block,
                     bool with_delta);

/// Prefetches what `kernel`, which is prepare or store, reads or writes of the constraints of a block in the stores of the scene.
/// They lie far apart there: a block has those of one colour, or of copies of a figure, which were added one after the other.
void prefetch_constraints(ConstraintKernels::Transfer ConstraintKernels::*kernel, const BlockStreams& streams,
                          const ConstraintData& data, std::int64_t block);

}  // namespace motley
