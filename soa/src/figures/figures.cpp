// Sorts figures by shape, into blocks of copies.
#include "figures/figures.h"

#include <algorithm>
#include <limits>
#include <map>
#include <utility>

#include "figures/members.h"

namespace motley {
namespace {

/// The members in an order in which copies follow each other. (If two shapes had the same hash, fewer copies would be
/// found at once.)
Array<std::size_t> sorted_by_signature(const Members& members)
{
    Array<std::pair<std::uint64_t, std::size_t>> hashed(members.count());
    for (std::size_t i = 0; i < hashed.size(); ++i) {
        hashed[i] = {members.hash_of(i), i};
    }
    std::sort(hashed.begin(), hashed.end());
    Array<std::size_t> order(hashed.size());
    std::transform(hashed.begin(), hashed.end(), order.begin(),
                   [](const auto& member) { return member.second; });
    return order;
}

bool are_copies(const Members& members, std::size_t x, std::size_t y)
{
    const auto of_x = members.signature_of(x), of_y = members.signature_of(y);
    return std::equal(of_x.begin(), of_x.end(), of_y.begin(), of_y.end());
}

/// A padding lane in the block of this constraint: see Placement::is_gap.
Placement gap_beside(Placement placement)
{
    placement.constraint = ~placement.constraint;
    return placement;
}

}  // namespace

void Figures::find(std::span<const JointCandidate> joints, const BodySets& sets, const BodyStore& bodies,
                   const KernelTable& kernels, const ExactFigures& exact, Array<Placement>& placed)
{
    const std::size_t rigid_rows = bodies.rows(BodyKind::rigid).size();
    exact_ = exact;
    refused_ = {};
    spare_loops_ = std::numeric_limits<std::int64_t>::max();
    shapes_.clear();
    blocks_.clear();
    waiting_.clear();
    lone_.clear();
    touched_trees_.clear();
    const Members members(joints, sets, bodies, kernels, exact, names_, refused_);
    const Array<std::size_t> order = sorted_by_signature(members);

    placed.clear();
    block_of_row_.assign(rigid_rows, none);
    place_of_row_.assign(rigid_rows, 0);
    Array<std::int32_t> offsets;
    std::int64_t memory = 0;
    Array<std::int64_t> first_float;
    std::span<const std::size_t> copies;
    for (std::size_t next = 0; next < order.size(); next += copies.size()) {
        std::size_t end = next + 1;
        while (end < order.size() && are_copies(members, order[next], order[end])) ++end;
        copies = std::span(order).subspan(next, end - next);
        const bool is_exact = members.is_exact[copies.front()] != 0;
        const bool is_large = members.bodies_of(copies.front()).size() > most_bodies;
        // A change of a joint may make a large figure bear a heavy load.
        if (!is_exact && is_large) spare_loops_ = 0;
        // Too few copies, and nothing to be solved exactly.
        if (!is_exact && (is_large || copies.size() < std::size_t{fewest_copies})) continue;
        std::unique_ptr<FigureShape> shape = members.shape_of(copies.front());
        const bool has_tree = is_exact && build_tree(*shape, exact_.rotors_beside_trees());
        if (!has_tree && is_large) {
            spare_loops_ = std::min(spare_loops_, spare_loops_of(*shape));
            continue;
        }
        for (std::size_t first = 0; first < copies.size(); first += block_lanes) {
            const std::size_t count = std::min<std::size_t>(block_lanes, copies.size() - first);
            if (!has_tree && count < std::size_t{fewest_copies}) break;
            const auto block = static_cast<std::int32_t>(blocks_.size());
            FigureBlock& added = blocks_.emplace_back();
            added.shape = shape.get();
            added.count = static_cast<int>(count);
            first_float.push_back(memory);
            if (has_tree)
                memory +=
                    static_cast<std::int64_t>(shape->bodies.size()) * CopyBody::floats + shape->system_floats;
            for (std::size_t body = 0; body < shape->bodies.size(); ++body) {
                for (std::size_t lane = 0; lane < block_lanes; ++lane) {
                    const bool pads = lane >= count;
                    const BodyRow row = pads ? BodyRow{} : members.bodies_of(copies[first + lane])[body];
                    offsets.push_back(offset_of(row));
                    if (pads || !is_rigid(row)) continue;
                    block_of_row_[row.row()] = block;
                    place_of_row_[row.row()] = static_cast<std::int32_t>(body * block_lanes + lane);
                }
            }
            for (std::size_t joint = 0; joint < shape->joints.size(); ++joint) {
                for (std::size_t lane = 0; lane < block_lanes; ++lane) {
                    const std::size_t copy = copies[first + std::min(lane, count - 1)];
                    const Placement& placement = members.joints_of(copy)[joint]->placement;
                    placed.push_back(lane < count ? placement : gap_beside(placement));
                }
            }
        }
        shapes_.push_back(std::move(shape));
    }

    offsets_.assign(offsets.begin(), offsets.end());
    memory_.assign(static_cast<std::size_t>(memory), 0.0F);
    std::size_t first_offset = 0;
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
        FigureBlock& block = blocks_[i];
        block.offsets = offsets_.data() + first_offset;
        if (block.shape->has_tree()) {
            block.bodies = memory_.data() + first_float[i];
            block.system = block.body(static_cast<int>(block.shape->bodies.size()));
        }
        first_offset += block.shape->bodies.size() * block_lanes;
    }
    for (const JointCandidate& joint : joints) {
        if (!can_be_in_lanes(joint.placement, kernels) || block_of_row_[rigid_row_of(joint.placement)] < 0)
            placed.push_back(joint.placement);
    }
}

void Figures::bind(BatchSet& batches, const KernelTable& kernels)
{
    joints_.assign(blocks_.size(), {});
    skipped_.assign(blocks_.size(), {});
    std::map<std::pair<int, int>, std::int32_t> used;  // blocks used so far, by class and colour
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
        for (const FigureShape::Joint& joint : blocks_[i].shape->joints) {
            const int constraint_class = class_of(joint.type, joint.kind_a, joint.kind_b);
            const BatchSet::Block block =
                batches.block(constraint_class, joint.colour, used[{constraint_class, int{joint.colour}}]++);
            joints_[i].push_back({&kernels.constraints[constraint_class], block.streams, block.index});
            skipped_[i].push_back(block.skipped);
        }
    }
    for (std::size_t i = 0; i < blocks_.size(); ++i) blocks_[i].joints = joints_[i].data();
    // Which blocks are alone changes from step to step, and finding them must not allocate.
    alone_.reserve(blocks_.size());
    was_alone_.reserve(blocks_.size());
    lone_.reserve(blocks_.size());
    touched_trees_.reserve(blocks_.size());
    end_of_contacts_.resize(blocks_.size());
    alone_.clear();  // none is known yet
}

}  // namespace motley
