// Batches: coloured constraints sorted into blocks of sixteen lanes, and cut into chunks for whoever runs
// them.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "block.h"
#include "colouring.h"
#include "motley/core/aligned_vector.h"

namespace motley {

/// Some blocks of one class and colour: the unit of work of a sweep.
struct SweepChunk {
    const ConstraintKernels* kernels;
    BlockStreams streams;
    const std::int32_t* order;
    std::int32_t begin, end;
};

/// Some blocks of one class, of any colour: the unit of work of prepare and store.
struct TransferChunk {
    const ConstraintKernels* kernels;
    BlockStreams streams;
    int type;
    std::int32_t begin, end;
};

/// The blocks of one class: a pool in order of opening, and for each colour the list of its blocks.
class BlockPool {
  public:
    BlockPool();
    void clear();
    /// Puts a constraint into the open block of its colour. Constraints keep the order in which they come,
    /// and so the locality that the host's order has.
    void place(BodyRow a, BodyRow b, std::int32_t constraint, std::uint8_t colour);
    /// Streams long enough for every block; pointers stay good until the pool next grows.
    BlockStreams streams(const ConstraintKernels& kernels);

    [[nodiscard]] std::int32_t block_count() const { return block_count_; }
    [[nodiscard]] std::int64_t constraint_count() const { return constraint_count_; }
    [[nodiscard]] std::int32_t lanes_used(std::int32_t block) const
    {
        return index_[static_cast<std::size_t>(block)].count;
    }
    [[nodiscard]] const std::vector<std::int32_t>& order(int colour) const
    {
        return orders_[static_cast<std::size_t>(colour)];
    }

  private:
    BlockIndex& open_block(std::uint8_t colour, std::int32_t constraint);
    BlockIndex& open_overflow_block(BodyRow a, BodyRow b, std::int32_t constraint);

    AlignedVector<BlockIndex> index_;
    AlignedVector<float> rows_, substep_rows_, impulses_;
    std::array<std::vector<std::int32_t>, parallel_colours + 1> orders_;
    std::array<std::int32_t, parallel_colours>
        open_{};  ///< the block of each colour that still has lanes, or none
    std::int32_t block_count_ = 0;
    std::int64_t constraint_count_ = 0;
};

/// The blocks of a set of constraints, by class.
class BatchSet {
  public:
    void clear();
    void place(int type, BodyRow a, BodyRow b, std::int32_t constraint, std::uint8_t colour)
    {
        pools_[static_cast<std::size_t>(class_of(type, a.kind(), b.kind()))].place(a, b, constraint, colour);
    }
    /// Appends this set's chunks to the lists, by colour.
    void cut(const KernelTable& kernels, std::array<std::vector<SweepChunk>, parallel_colours + 1>& sweeps,
             std::vector<TransferChunk>& transfers);

    /// Blocks, constraints, overflow and streamed floats, for the report.
    struct Count {
        std::int64_t blocks = 0, constraints = 0, overflow = 0;
        double streamed_bytes = 0;  ///< by one sweep of solve
    };
    [[nodiscard]] Count count(const KernelTable& kernels) const;
    [[nodiscard]] bool is_empty() const;

  private:
    std::array<BlockPool, class_count> pools_;
};

}  // namespace motley
