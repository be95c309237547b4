// Finds the figures of a scene: sets of rigid bodies that joints connect, and all copies of the same shape. The host
// declares nothing: sets that it builds alike are recognised as copies. A copy that loses a joint is a shape of its
// own from then on, and one that touches something that moves is swept by colour like everything else.
#pragma once

#include <algorithm>
#include <limits>
#include <memory>
#include <span>

#include "figures/body_names.h"
#include "figures/figure.h"
#include "layout/joint_intake.h"
#include "stores/array.h"

namespace motley {

class JointLanes;

/// Which figures have their locks solved exactly, by trees: all, or those that bear heavy loads.
struct ExactFigures {
    bool all = false;
    float above_ratio = std::numeric_limits<float>::infinity();  ///< see bears_heavy_load()
    [[nodiscard]] bool any() const { return all || above_ratio < std::numeric_limits<float>::infinity(); }
    /// Figures that are exact because they bear heavy loads would rather be swept.
    [[nodiscard]] RotorsBesideTree rotors_beside_trees() const
    {
        return all ? RotorsBesideTree::allowed : RotorsBesideTree::refused;
    }
    friend bool operator==(const ExactFigures&, const ExactFigures&) = default;
};

class Figures {
  public:
    static constexpr std::int32_t none = -1;
    /// The most moving bodies of a figure without a tree: their lanes, with those of its joints, still fit a second level
    /// cache.
    static constexpr std::size_t most_bodies = 64;
    /// A block with fewer copies than this is swept faster by colour, with all other joints. A constant, so that blocks
    /// do not depend on the instruction set.
    static constexpr int fewest_copies = 8;
    /// Sorts the joints into `placed`. Those of figures come first, sixteen consecutive copies of each joint, with
    /// gaps where a block has fewer copies, so that each joint of a block of copies has a block of its own. The rest
    /// follow in their old order. `exact`: whose locks are solved by trees, however few copies there are, except those
    /// between light bodies and heavy ones: see light_between_heavy() and refused(). `sets`: what the joints connect.
    void find(std::span<const JointCandidate> joints, const BodySets& sets, const BodyStore& bodies,
              const KernelTable& kernels, const ExactFigures& exact, Array<Placement>& placed);
    /// With ExactFigures::all: locks that are not solved exactly, because their figure has no fixed body and has a body too
    /// light for the other bodies; see StepReport::exact_joints_refused.
    struct Refused {
        std::int64_t joints = 0;
        BodyId light_body{};  ///< one such body
    };
    [[nodiscard]] const Refused& refused() const { return refused_; }
    /// After `placed` has been filled into its blocks: looks up the blocks of the joints.
    void bind(BatchSet& batches, const KernelTable& kernels);

    // What follows, up to are_full_enough(), is for JointLanes, when a few joints come or go.

    /// A copy in its block, or {none} for a body of no figure.
    struct Copy {
        std::int32_t block = none, lane = 0;
    };
    [[nodiscard]] Copy copy_of(BodyRow body) const
    {
        const std::int32_t block = body.kind() == BodyKind::rigid ? block_of(body.row()) : none;
        return block == none ? Copy{} : Copy{block, place_of_row_[body.row()] % block_lanes};
    }
    /// Takes a copy out of its block: its joints are swept by colour from now on. Returns false when there is no room for
    /// them, or it has so many bodies that put_together() does not look for its like; then all must be laid out anew.
    [[nodiscard]] bool take_apart(const Copy& copy, JointLanes& lanes);
    /// A component that is swept by colour becomes a copy in a block of its shape, if there is one with a free lane: in the
    /// one with the fewest copies. Returns false when all should be laid out anew: there has been none for as many copies of
    /// a shape as are worth a block, or for many shapes, or the component is to be solved exactly.
    [[nodiscard]] bool put_together(std::span<const JointCandidate> component, const BodyStore& bodies,
                                    const KernelTable& kernels, JointLanes& lanes);
    /// Counts a loop as lost, because a joint of a component that has more than most_bodies and no tree has come or gone.
    /// Returns false if the component may have a tree now.
    [[nodiscard]] bool lose_a_loop() { return !exact_.any() || --spare_loops_ >= 0; }
    /// Whether copies that have left leave no block so empty that its shape would better have fewer blocks, or none.
    [[nodiscard]] bool are_full_enough() const;

    /// Makes room for as many contacts in a step.
    void make_room(std::size_t contacts);
    /// Finds the blocks that are alone in a step, so that they are solved on their own: their bodies touch nothing but
    /// fixed bodies. Takes these contacts (Placement::in_figure). Returns whether other blocks are alone than in the
    /// last step. Does not allocate.
    bool take_contacts(std::span<Placement> contacts, bool may_be_alone);
    /// The block of the figure that touches a fixed body in this contact; else none.
    [[nodiscard]] std::int32_t stands_on(const Placement& contact) const
    {
        const bool a_is_fixed = contact.a.kind() == BodyKind::fixed;
        const BodyRow body = a_is_fixed ? contact.b : contact.a;
        const bool one_is_fixed = a_is_fixed || contact.b.kind() == BodyKind::fixed;
        return one_is_fixed && body.kind() == BodyKind::rigid ? block_of(body.row()) : none;
    }
    /// The indices of the contacts that a block has taken.
    [[nodiscard]] std::span<const std::uint32_t> contacts_of(std::size_t block) const
    {
        const std::uint32_t begin = block == 0 ? 0 : end_of_contacts_[block - 1];
        return std::span(contacts_).subspan(begin, end_of_contacts_[block] - begin);
    }
    /// The most contacts that one block has taken in this step.
    [[nodiscard]] std::size_t most_contacts() const { return is_empty() ? 0 : most_contacts_; }
    /// Where a rigid row is in its block of copies: its body of the figure times block_lanes, plus its lane.
    [[nodiscard]] std::span<const std::int32_t> places() const { return place_of_row_; }

    [[nodiscard]] bool is_empty() const { return blocks_.empty(); }
    /// Whether any locks are solved exactly.
    [[nodiscard]] bool have_trees() const
    {
        return std::any_of(shapes_.begin(), shapes_.end(),
                           [](const std::unique_ptr<FigureShape>& shape) { return shape->has_tree(); });
    }
    [[nodiscard]] std::span<const FigureBlock> blocks() const { return blocks_; }
    /// Blocks that are alone in this step, and those with a tree that are not.
    [[nodiscard]] std::span<const std::int32_t> lone() const { return lone_; }
    [[nodiscard]] std::span<const std::int32_t> touched_trees() const { return touched_trees_; }
    /// Which of sixteen consecutive rigid rows (BodyRows::rows_per_group) belong to blocks that are alone, a bit each.
    [[nodiscard]] std::uint16_t alone_in(std::size_t group) const
    {
        const std::size_t first = group * BodyRows::rows_per_group;
        unsigned rows = 0;
        for (std::size_t i = 0; i < BodyRows::rows_per_group; ++i) {
            const std::int32_t block = block_of(first + i);
            if (block >= 0 && alone_[static_cast<std::size_t>(block)] != 0) rows |= 1U << i;
        }
        return static_cast<std::uint16_t>(rows);
    }
    /// The number of joints in blocks that are alone.
    [[nodiscard]] std::int64_t lone_joints() const { return is_empty() ? 0 : lone_joints_; }

  private:
    ExactFigures exact_;  ///< see find()
    Refused refused_;
    /// How many loops of any component that has more than most_bodies may go before it can have a tree.
    std::int64_t spare_loops_ = 0;
    BodyNames names_;
    struct Waiting {
        std::uint64_t shape;  ///< hash of the signature
        std::size_t times;
    };
    Array<Waiting> waiting_;  ///< shapes that put_together() has found no lane for, since find()
    static constexpr std::size_t most_waiting = 64;  ///< so many that a search takes as long as the rest
    Array<std::unique_ptr<FigureShape>> shapes_;
    Array<FigureBlock> blocks_;
    Array<Array<FigureBlock::Joint>> joints_;  ///< of each block
    Array<Array<std::uint8_t*>> skipped_;      ///< of each block and joint: BatchSet::Block::skipped
    AlignedVector<std::int32_t> offsets_;      ///< of all blocks, one after another
    AlignedVector<float> memory_;              ///< likewise
    Array<std::int32_t> block_of_row_;         ///< one entry per rigid row that existed at find()
    Array<std::int32_t> place_of_row_;         ///< likewise; see places()
    /// none for a body of no figure. Bodies added since find() have no joints.
    [[nodiscard]] std::int32_t block_of(std::size_t row) const
    {
        return row < block_of_row_.size() ? block_of_row_[row] : none;
    }
    Array<std::uint8_t> alone_, was_alone_;  ///< by block, in this step and in the last
    Array<std::uint32_t> contacts_;          ///< block after block
    Array<std::uint32_t> end_of_contacts_;   ///< by block
    std::size_t most_contacts_ = 0;
    Array<std::int32_t> lone_, touched_trees_;
    std::int64_t lone_joints_ = 0;

    void list_lone_blocks();
    [[nodiscard]] BatchSet::Lane lane_of(const Copy& copy, std::size_t joint) const;
    void place(const Copy& copy, std::size_t body, BodyRow row);
};

}  // namespace motley
