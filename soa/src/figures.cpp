// Components by union-find, shapes by what their joints look like in the order of their colours.
#include "figures.h"

#include <algorithm>
#include <limits>
#include <map>

#include "disjoint_sets.h"

namespace motley {
namespace {

/// Fewer copies than this in a block's lanes are swept faster among others. A constant, so that blocks do not depend
/// on the instruction set.
constexpr std::size_t fewest_copies = 8;
/// Bodies of a figure whose lanes still fit a second level cache with its joints.
constexpr std::size_t most_bodies = 64;

bool is_rigid(BodyRow body)
{
    return body.kind() == BodyKind::rigid;
}

std::uint32_t rigid_row_of(const Placement& joint)
{
    return is_rigid(joint.a) ? joint.a.row() : joint.b.row();
}

/// Joints of one component, in the order of their colours, and its bodies in the order in which these name them.
struct Member {
    std::vector<const Figures::Candidate*> joints;
    std::vector<BodyRow> bodies;
    bool is_refused = false;  ///< what light_between_heavy() finds keeps it from being solved exactly
};

/// A body with two locks or more, in a figure without a fixed body and with one more than 2,000 times as heavy; {} if there is none.
/// The mass that its joints see is made of both and keeps too few digits of the light one: the joints hold, but their impulses do not
/// cancel. Momentum changes by 3e-6 a second at 1 : 1,000 and by 3e-5 at 1 : 10,000 (light_between_heavy_test.cpp).
BodyId light_between_heavy(const Member& member, const BodyStore& bodies)
{
    constexpr double most_mass_ratio = 2000;
    std::map<std::uint32_t, int> locks_on;  // by slot
    for (const Figures::Candidate* joint : member.joints) {
        if (joint->equalities == 0) continue;
        for (const BodyRow body : {joint->placement.a, joint->placement.b}) {
            if (!is_rigid(body)) return {};
            ++locks_on[bodies.rows(BodyKind::rigid).slot[body.row()]];
        }
    }
    const auto inverse_mass = [&](std::uint32_t slot) { return double{bodies.inverse_masses[slot]}; };
    double of_heaviest = std::numeric_limits<double>::infinity();
    for (const auto& [slot, locks] : locks_on) of_heaviest = std::min(of_heaviest, inverse_mass(slot));
    for (const auto& [slot, locks] : locks_on) {
        if (locks > 1 && inverse_mass(slot) > most_mass_ratio * of_heaviest) return bodies.id_of_slot(slot);
    }
    return {};
}

/// The shape of a component as numbers: equal ones are copies.
std::vector<std::uint32_t> signature_of(Member& member)
{
    std::map<std::uint32_t, std::uint32_t> index;
    const auto name = [&](BodyRow body) {
        const auto [entry, is_new] =
            index.try_emplace(body.bits, static_cast<std::uint32_t>(member.bodies.size()));
        if (is_new) member.bodies.push_back(body);
        return entry->second;
    };
    std::vector<std::uint32_t> signature;
    signature.reserve(4 * member.joints.size() + 1);
    for (const Figures::Candidate* joint : member.joints) {
        const Placement& p = joint->placement;
        signature.push_back(p.colour | std::uint32_t{p.type} << 8 |
                            static_cast<std::uint32_t>(p.a.kind()) << 16 |
                            static_cast<std::uint32_t>(p.b.kind()) << 18 |
                            static_cast<std::uint32_t>(joint->equalities) << 20 |
                            static_cast<std::uint32_t>(joint->locks_point) << 24);
        signature.push_back(name(p.a));
        signature.push_back(name(p.b));
    }
    signature.push_back(static_cast<std::uint32_t>(member.is_refused));
    return signature;
}

std::unique_ptr<FigureShape> shape_of(const Member& member, std::span<const std::uint32_t> signature)
{
    auto shape = std::make_unique<FigureShape>();
    for (const BodyRow body : member.bodies) shape->bodies.push_back(body.kind());
    for (std::size_t i = 0; i < member.joints.size(); ++i) {
        const Placement& p = member.joints[i]->placement;
        shape->joints.push_back({p.type, p.a.kind(), p.b.kind(), p.colour,
                                 static_cast<int>(signature[3 * i + 1]),
                                 static_cast<int>(signature[3 * i + 2]), member.joints[i]->equalities,
                                 member.joints[i]->locks_point});
    }
    return shape;
}

bool can_be_in_lanes(const Placement& joint, const KernelTable& kernels)
{
    return joint.colour != overflow_colour &&
           kernels.constraints[class_of(joint.type, joint.a.kind(), joint.b.kind())].solve_copies != nullptr;
}

/// The components of at most so many moving bodies that may be figures.
std::vector<Member> members_of(std::span<const Figures::Candidate> joints, std::size_t rigid_rows,
                               const KernelTable& kernels, std::size_t largest)
{
    DisjointSets components;
    components.reset(rigid_rows);
    for (const auto& [joint, equalities, locks_point] : joints) {
        if (is_rigid(joint.a) && is_rigid(joint.b))
            components.tie(static_cast<std::int32_t>(joint.a.row()),
                           static_cast<std::int32_t>(joint.b.row()));
    }
    components.flatten();
    std::vector<std::size_t> size(rigid_rows, 0);
    for (std::size_t row = 0; row < rigid_rows; ++row) ++size[static_cast<std::size_t>(components.root(row))];
    std::vector<std::uint8_t> excluded(rigid_rows, 0);
    for (const auto& [joint, equalities, locks_point] : joints) {
        if (can_be_in_lanes(joint, kernels)) continue;
        for (const BodyRow body : {joint.a, joint.b})
            if (is_rigid(body)) excluded[static_cast<std::size_t>(components.root(body.row()))] = 1;
    }
    std::vector<std::int32_t> member_of_root(rigid_rows, -1);
    std::vector<Member> members;
    for (const Figures::Candidate& joint : joints) {
        if (!can_be_in_lanes(joint.placement, kernels)) continue;
        const auto root = static_cast<std::size_t>(components.root(rigid_row_of(joint.placement)));
        if (excluded[root] != 0 || size[root] > largest) continue;
        if (member_of_root[root] < 0) {
            member_of_root[root] = static_cast<std::int32_t>(members.size());
            members.emplace_back();
        }
        members[static_cast<std::size_t>(member_of_root[root])].joints.push_back(&joint);
    }
    for (Member& member : members) {
        std::stable_sort(member.joints.begin(), member.joints.end(), [](const auto* x, const auto* y) {
            return x->placement.colour < y->placement.colour;
        });
    }
    return members;
}

/// A lane without a constraint, in the block of this one.
Placement gap_beside(Placement placement)
{
    placement.constraint = ~placement.constraint;
    return placement;
}

}  // namespace

void Figures::find(std::span<const Candidate> joints, const BodyStore& bodies, const KernelTable& kernels,
                   bool exact, std::vector<Placement>& placed)
{
    const std::size_t rigid_rows = bodies.rows(BodyKind::rigid).size();
    refused_ = {};
    shapes_.clear();
    blocks_.clear();
    lone_.clear();
    touched_trees_.clear();
    std::vector<Member> members = members_of(joints, rigid_rows, kernels, exact ? rigid_rows : most_bodies);
    for (Member& member : members) {
        const BodyId light = exact ? light_between_heavy(member, bodies) : BodyId{};
        if (light == BodyId{}) continue;
        member.is_refused = true;
        refused_.joints += std::count_if(member.joints.begin(), member.joints.end(),
                                         [](const Candidate* joint) { return joint->equalities > 0; });
        refused_.light_body = light;
    }
    std::map<std::vector<std::uint32_t>, std::vector<std::size_t>> groups;
    for (std::size_t i = 0; i < members.size(); ++i) groups[signature_of(members[i])].push_back(i);

    placed.clear();
    block_of_row_.assign(rigid_rows, -1);
    std::vector<std::int32_t> offsets;
    std::int64_t memory = 0;
    std::vector<std::int64_t> first_float;
    for (const auto& [signature, copies] : groups) {
        std::unique_ptr<FigureShape> shape = shape_of(members[copies.front()], signature);
        const bool has_tree = exact && !members[copies.front()].is_refused && shape->plant_tree();
        if (!has_tree && shape->bodies.size() > most_bodies) continue;
        for (std::size_t first = 0; first < copies.size(); first += block_lanes) {
            const std::size_t count = std::min<std::size_t>(block_lanes, copies.size() - first);
            if (!has_tree && count < fewest_copies) break;
            const auto block = static_cast<std::int32_t>(blocks_.size());
            blocks_.push_back({.shape = shape.get(), .count = static_cast<int>(count)});
            first_float.push_back(memory);
            if (has_tree)
                memory +=
                    static_cast<std::int64_t>(shape->bodies.size()) * CopyBody::floats + shape->system_floats;
            for (std::size_t body = 0; body < shape->bodies.size(); ++body) {
                for (std::size_t lane = 0; lane < block_lanes; ++lane) {
                    const bool pads = lane >= count;
                    const BodyRow row = pads ? BodyRow{} : members[copies[first + lane]].bodies[body];
                    offsets.push_back(offset_of(row));
                    if (!pads && is_rigid(row)) block_of_row_[row.row()] = block;
                }
            }
            for (std::size_t joint = 0; joint < shape->joints.size(); ++joint) {
                for (std::size_t lane = 0; lane < block_lanes; ++lane) {
                    const std::size_t copy = copies[first + std::min(lane, count - 1)];
                    const Placement& placement = members[copy].joints[joint]->placement;
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
    for (const Candidate& joint : joints) {
        if (!can_be_in_lanes(joint.placement, kernels) || block_of_row_[rigid_row_of(joint.placement)] < 0)
            placed.push_back(joint.placement);
    }
}

void Figures::bind(BatchSet& batches, const KernelTable& kernels)
{
    joints_.assign(blocks_.size(), {});
    skipped_.assign(blocks_.size(), {});
    std::map<std::pair<int, int>, std::int32_t> used;  // blocks, by class and colour
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
    // Which of them are alone changes from step to step, and shall not allocate.
    alone_.reserve(blocks_.size());
    lone_.reserve(blocks_.size());
    touched_trees_.reserve(blocks_.size());
}

void Figures::find_lone_blocks(std::span<const Placement> contacts, bool may_be_alone)
{
    alone_.assign(blocks_.size(), may_be_alone ? 1 : 0);
    for (const Placement& contact : contacts) {
        for (const BodyRow body : {contact.a, contact.b}) {
            if (!is_rigid(body)) continue;
            const std::int32_t block = block_of(body.row());
            if (block >= 0) alone_[static_cast<std::size_t>(block)] = 0;
        }
    }
    lone_.clear();
    touched_trees_.clear();
    lone_joints_ = 0;
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
        const FigureShape& shape = *blocks_[i].shape;
        const bool alone = alone_[i] != 0;
        if (alone) {
            lone_.push_back(static_cast<std::int32_t>(i));
            lone_joints_ += blocks_[i].count * static_cast<std::int64_t>(shape.joints.size());
        } else if (shape.has_tree()) {
            touched_trees_.push_back(static_cast<std::int32_t>(i));
        }
        for (std::size_t joint = 0; joint < shape.joints.size(); ++joint)
            *skipped_[i][joint] = alone                         ? BatchSet::skip_altogether
                                  : shape.joints[joint].in_tree ? BatchSet::skip_sweeps
                                                                : BatchSet::skip_nothing;
    }
}

}  // namespace motley
