// Copies leave their blocks and come into them when a few joints come and go.
#include <algorithm>
#include <utility>

#include "figures/figures.h"
#include "figures/members.h"
#include "layout/joint_lanes.h"
#include "stores/growth.h"

namespace motley {

BatchSet::Lane Figures::lane_of(const Copy& copy, std::size_t joint) const
{
    const auto block = static_cast<std::size_t>(copy.block);
    const FigureShape::Joint& of_shape = blocks_[block].shape->joints[joint];
    return {class_of(of_shape.type, of_shape.kind_a, of_shape.kind_b), joints_[block][joint].block,
            static_cast<std::uint8_t>(copy.lane), of_shape.colour};
}

/// Body `body` of a copy is in this row.
void Figures::place(const Copy& copy, std::size_t body, BodyRow row)
{
    const std::size_t place = body * block_lanes + static_cast<std::size_t>(copy.lane);
    // The offsets of a block lie in those of all blocks.
    const auto first = blocks_[static_cast<std::size_t>(copy.block)].offsets - offsets_.data();
    offsets_[static_cast<std::size_t>(first) + place] = offset_of(row);
    if (!is_rigid(row)) return;
    block_of_row_[row.row()] = copy.block;
    place_of_row_[row.row()] = static_cast<std::int32_t>(place);
}

bool Figures::take_apart(const Copy& copy, JointLanes& lanes)
{
    FigureBlock& block = blocks_[static_cast<std::size_t>(copy.block)];
    const FigureShape& shape = *block.shape;
    if (shape.bodies.size() > most_bodies) return false;
    const Copy last{copy.block, --block.count};
    alone_.clear();
    for (std::size_t joint = 0; joint < shape.joints.size(); ++joint) {
        const BatchSet::Lane lane = lane_of(copy, joint), last_lane = lane_of(last, joint);
        if (!lanes.sweep(lane)) return false;
        if (last.lane != copy.lane) lanes.move(last_lane, lane);
        lanes.end_block_at(last_lane);
    }
    const auto row_of = [&](const Copy& which, std::size_t body) {
        return row_at(shape.bodies[body],
                      block.offsets[body * block_lanes + static_cast<std::size_t>(which.lane)]);
    };
    for (std::size_t body = 0; body < shape.bodies.size(); ++body) {
        const BodyRow gone = row_of(copy, body), moved = row_of(last, body);
        if (is_rigid(gone)) block_of_row_[gone.row()] = none;
        place(last, body, {});
        if (last.lane != copy.lane) place(copy, body, moved);
    }
    return true;
}

bool Figures::put_together(std::span<const JointCandidate> component, const BodyStore& bodies,
                           const KernelTable& kernels, JointLanes& lanes)
{
    if (!std::all_of(component.begin(), component.end(),
                     [&](const JointCandidate& joint) { return can_be_in_lanes(joint.placement, kernels); }))
        return true;
    const Members members(component, bodies, exact_, names_);
    if (exact_.all && members.is_exact[0] == 0)
        return false;  // refused() counts them when all are laid out anew
    const std::span<const std::uint32_t> signature = members.signature_of(0);
    const auto fits = [&](const FigureBlock& block) {
        const Array<std::uint32_t>& of_shape = block.shape->signature;
        return block.count < block_lanes &&
               std::equal(signature.begin(), signature.end(), of_shape.begin(), of_shape.end());
    };
    auto block = blocks_.end();
    for (auto other = blocks_.begin(); other != blocks_.end(); ++other) {
        if ((block == blocks_.end() || other->count < block->count) && fits(*other)) block = other;
    }
    if (block == blocks_.end()) {
        if (members.is_exact[0] != 0 && build_tree(*members.shape_of(0), exact_.rotors_beside_trees()))
            return false;
        const std::uint64_t shape = members.hash_of(0);
        const auto waiting = std::find_if(waiting_.begin(), waiting_.end(),
                                          [&](const Waiting& other) { return other.shape == shape; });
        if (waiting != waiting_.end()) return ++waiting->times < std::size_t{fewest_copies};
        waiting_.push_back({shape, 1});
        return waiting_.size() < most_waiting;
    }
    const std::size_t rows = bodies.rows(BodyKind::rigid).size();
    grow_to(block_of_row_, rows, none);
    grow_to(place_of_row_, rows);
    const Copy copy{static_cast<std::int32_t>(block - blocks_.begin()), block->count++};
    alone_.clear();
    for (std::size_t body = 0; body < members.bodies.size(); ++body) place(copy, body, members.bodies[body]);
    // The last first: where take_apart() has just put them behind all others, nothing has to be moved into their lanes.
    for (std::size_t joint = members.joints.size(); joint-- > 0;)
        lanes.solve_in_copy(members.joints[joint]->placement, lane_of(copy, joint));
    return true;
}

bool Figures::are_full_enough() const
{
    const FigureShape* has_few = nullptr;
    return std::all_of(blocks_.begin(), blocks_.end(), [&](const FigureBlock& block) {
        if (block.count >= fewest_copies) return true;
        // What is solved exactly has a block, however few copies there are, but one such block is enough.
        return block.shape->has_tree() && block.count > 0 &&
               std::exchange(has_few, block.shape) != block.shape;
    });
}

}  // namespace motley
