// Finds the figures of a scene: sets of rigid bodies that hang together by joints, as many of one shape as there are.
// Nobody has to say that a figure is one: what the host adds alike is found alike, a copy that loses a joint is a shape
// of its own from then on, and one that touches something is swept by colour like everything else.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "batches.h"
#include "figure.h"

namespace motley {

class Figures {
  public:
    /// A joint as it comes from its store, with a colour.
    struct Candidate {
        Placement placement;
        int equalities;    ///< rows that may be solved exactly, or 0
        bool locks_point;  ///< the first three of them are those of a point on a point
    };
    /// Sorts the joints into `placed`: those of figures first, sixteen copies of a joint in line with gaps where a block has
    /// fewer copies, so that each has a block of its own; then the rest as they were. `exact`: figures whose locks
    /// form trees get one, and are figures however few they are; but those that refused() counts.
    void find(std::span<const Candidate> joints, const BodyStore& bodies, const KernelTable& kernels,
              bool exact, std::vector<Placement>& placed);
    /// Locks of figures without a fixed body in which a body is too light for what it joins; see StepReport::exact_joints_refused.
    struct Refused {
        std::int64_t joints = 0;
        BodyId light_body{};  ///< one such body
    };
    [[nodiscard]] const Refused& refused() const { return refused_; }
    /// Once `placed` has been filled into its blocks.
    void bind(BatchSet& batches, const KernelTable& kernels);

    /// A block is alone in a step when no contact touches it; then it needs no sweeps but its own.
    void find_lone_blocks(std::span<const Placement> contacts, bool may_be_alone);

    [[nodiscard]] bool is_empty() const { return blocks_.empty(); }
    [[nodiscard]] std::span<const FigureBlock> blocks() const { return blocks_; }
    /// Blocks that are alone in this step, and those with a tree that are not.
    [[nodiscard]] std::span<const std::int32_t> lone() const { return lone_; }
    [[nodiscard]] std::span<const std::int32_t> touched_trees() const { return touched_trees_; }
    /// Whether a rigid row belongs to a block that is alone.
    [[nodiscard]] bool is_alone(std::size_t row) const
    {
        const std::int32_t block = block_of(row);
        return block >= 0 && alone_[static_cast<std::size_t>(block)] != 0;
    }
    /// Joints of blocks that are alone.
    [[nodiscard]] std::int64_t lone_joints() const { return is_empty() ? 0 : lone_joints_; }

  private:
    Refused refused_;
    std::vector<std::unique_ptr<FigureShape>> shapes_;
    std::vector<FigureBlock> blocks_;
    std::vector<std::vector<FigureBlock::Joint>> joints_;  ///< of each block
    std::vector<std::vector<std::uint8_t*>> skipped_;  ///< of each block and joint: BatchSet::Block::skipped
    AlignedVector<std::int32_t> offsets_;              ///< of all blocks in line
    AlignedVector<float> memory_;                      ///< likewise
    std::vector<std::int32_t> block_of_row_;  ///< as long as the rows were when figures were looked for
    /// Negative for a body of no figure; those that came since have no joints.
    [[nodiscard]] std::int32_t block_of(std::size_t row) const
    {
        return row < block_of_row_.size() ? block_of_row_[row] : -1;
    }
    std::vector<std::uint8_t> alone_;
    std::vector<std::int32_t> lone_, touched_trees_;
    std::int64_t lone_joints_ = 0;
};

}  // namespace motley
