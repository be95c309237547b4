// Finds components by union-find, and their shapes by comparing their joints in the order of their colours.
#include "figures/figures.h"

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

#include "stores/array.h"

namespace motley {
namespace {

/// A block with fewer copies than this is swept faster by colour, with all other joints. A constant, so that blocks
/// do not depend on the instruction set.
constexpr std::size_t fewest_copies = 8;
/// The most bodies of a figure whose lanes, with those of its joints, still fit a second level cache.
constexpr std::size_t most_bodies = 64;

bool is_rigid(BodyRow body)
{
    return body.kind() == BodyKind::rigid;
}

std::uint32_t rigid_row_of(const Placement& joint)
{
    return is_rigid(joint.a) ? joint.a.row() : joint.b.row();
}

/// Components that may be figures, in flat lists: the joints of member m are those from first_joint[m] to
/// first_joint[m + 1], and likewise its bodies and its signature.
struct Members {
    Array<const JointCandidate*> joints;  ///< by colour, type and body
    Array<BodyRow> bodies;                ///< in the order in which the joints name them
    Array<std::uint32_t> signatures;      ///< the shapes, in numbers: members with equal ones are copies
    Array<std::size_t> first_joint{0}, first_body{0}, first_number{0};
    Array<std::uint8_t>
        is_refused;  ///< light_between_heavy() has found a body, so its locks are not solved exactly

    [[nodiscard]] std::size_t count() const { return first_joint.size() - 1; }
    [[nodiscard]] std::span<const JointCandidate* const> joints_of(std::size_t member) const
    {
        return std::span(joints).subspan(first_joint[member], first_joint[member + 1] - first_joint[member]);
    }
    [[nodiscard]] std::span<const BodyRow> bodies_of(std::size_t member) const
    {
        return std::span(bodies).subspan(first_body[member], first_body[member + 1] - first_body[member]);
    }
    [[nodiscard]] std::span<const std::uint32_t> signature_of(std::size_t member) const
    {
        return std::span(signatures)
            .subspan(first_number[member], first_number[member + 1] - first_number[member]);
    }
};

/// A body with two locks or more, in a figure without a fixed body and with a body more than 2,000 times as heavy;
/// {} if there is none. The mass that its joints see is made of both and keeps too few digits of the light one: the
/// joints hold, but their impulses do not cancel. Momentum changes by 3e-6 per second at 1 : 1,000 and by 3e-5 at
/// 1 : 10,000 (light_between_heavy_test.cpp).
BodyId light_between_heavy(std::span<const JointCandidate* const> joints, const BodyStore& bodies)
{
    constexpr double most_mass_ratio = 2000;
    std::map<std::uint32_t, int> locks_on;  // by slot
    for (const JointCandidate* joint : joints) {
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

/// Numbers the bodies of a figure from 0 on.
class BodyNames {
  public:
    explicit BodyNames(const BodyStore& bodies)
        : rigid_(bodies.rows(BodyKind::rigid).size()), fixed_(bodies.rows(BodyKind::fixed).size())
    {
    }
    /// Begins to number the next figure. A rigid body is in one figure only; a fixed one may be in many.
    void start_figure() { ++figure_; }
    /// The number of a body. One that this figure has not numbered yet is added to the end of `bodies`, in which the
    /// figure begins at `first`.
    std::uint32_t name(BodyRow body, Array<BodyRow>& bodies, std::size_t first)
    {
        Name& name = (is_rigid(body) ? rigid_ : fixed_)[body.row()];
        if (name.figure != figure_) {
            name = {figure_, static_cast<std::uint32_t>(bodies.size() - first)};
            bodies.push_back(body);
        }
        return name.number;
    }

  private:
    struct Name {
        std::uint32_t figure = 0, number = 0;
    };
    Array<Name> rigid_, fixed_;
    std::uint32_t figure_ = 0;
};

/// Adds a member whose joints end at `end`: numbers its bodies and writes its signature.
void add_member(Members& members, std::size_t end, BodyNames& names, bool is_refused)
{
    const std::size_t first_body = members.bodies.size();
    names.start_figure();
    for (std::size_t i = members.first_joint.back(); i < end; ++i) {
        const JointCandidate& joint = *members.joints[i];
        const Placement& p = joint.placement;
        members.signatures.push_back(p.colour | std::uint32_t{p.type} << 8 |
                                     static_cast<std::uint32_t>(p.a.kind()) << 16 |
                                     static_cast<std::uint32_t>(p.b.kind()) << 18 |
                                     static_cast<std::uint32_t>(joint.equalities) << 20 |
                                     static_cast<std::uint32_t>(joint.locks_point) << 24);
        members.signatures.push_back(names.name(p.a, members.bodies, first_body));
        members.signatures.push_back(names.name(p.b, members.bodies, first_body));
    }
    members.signatures.push_back(is_refused ? 1 : 0);
    members.is_refused.push_back(is_refused ? 1 : 0);
    members.first_joint.push_back(end);
    members.first_body.push_back(members.bodies.size());
    members.first_number.push_back(members.signatures.size());
}

std::unique_ptr<FigureShape> shape_of(const Members& members, std::size_t member)
{
    auto shape = std::make_unique<FigureShape>();
    for (const BodyRow body : members.bodies_of(member)) shape->bodies.push_back(body.kind());
    const std::span<const JointCandidate* const> joints = members.joints_of(member);
    const std::span<const std::uint32_t> signature = members.signature_of(member);
    for (std::size_t i = 0; i < joints.size(); ++i) {
        const Placement& p = joints[i]->placement;
        shape->joints.push_back({p.type, p.a.kind(), p.b.kind(), p.colour,
                                 static_cast<int>(signature[3 * i + 1]),
                                 static_cast<int>(signature[3 * i + 2]), joints[i]->equalities,
                                 joints[i]->locks_point, joints[i]->active_row});
    }
    return shape;
}

bool can_be_in_lanes(const Placement& joint, const KernelTable& kernels)
{
    return joint.colour != overflow_colour &&
           kernels.constraints[class_of(joint.type, joint.a.kind(), joint.b.kind())].solve_copies != nullptr;
}

/// Sorts the joints of all components that may be figures and have at most `largest` moving bodies, component after
/// component. Returns where the joints of each end, by its root. No two joints of a colour share a moving body, so those
/// of a component, by colour, type and slot of a rigid body, are in the same order in every copy, whatever was added
/// and removed before: the slots of a figure's bodies are in the order in which these were added.
Array<std::uint32_t> sort_by_component(std::span<const JointCandidate> joints, const BodySets& sets,
                                       const BodyStore& bodies, const KernelTable& kernels,
                                       std::size_t largest, Array<const JointCandidate*>& sorted)
{
    const BodyRows& rigid = bodies.rows(BodyKind::rigid);
    const auto root_of = [&](BodyRow body) { return static_cast<std::size_t>(sets.root(body)); };
    constexpr std::uint32_t excluded = std::numeric_limits<std::uint32_t>::max();
    Array<std::uint32_t> members(sets.size(), 0);  // by root
    for (std::uint32_t row = 0; row < rigid.size(); ++row) ++members[root_of({BodyKind::rigid, row})];
    for (const JointCandidate& joint : joints) {
        if (can_be_in_lanes(joint.placement, kernels)) continue;
        for (const BodyRow body : {joint.placement.a, joint.placement.b})
            if (is_rigid(body)) members[root_of(body)] = excluded;
    }
    // Joints are counted by colour and by component. Then they are sorted by colour, and from there put into their
    // components, in which little is left to be sorted.
    constexpr std::uint32_t no_root = excluded;
    Array<std::uint32_t> roots(joints.size());  // by joint
    Array<std::uint32_t> ends(sets.size(), 0);
    std::array<std::uint32_t, parallel_colours> places{};
    for (std::size_t i = 0; i < joints.size(); ++i) {
        const Placement& joint = joints[i].placement;
        const std::size_t root =
            can_be_in_lanes(joint, kernels) ? root_of({BodyKind::rigid, rigid_row_of(joint)}) : 0;
        const bool fits = can_be_in_lanes(joint, kernels) && members[root] <= largest;
        roots[i] = fits ? static_cast<std::uint32_t>(root) : no_root;
        if (!fits) continue;
        ++ends[root];
        ++places[joint.colour];
    }
    const std::size_t count = std::accumulate(places.begin(), places.end(), std::size_t{0});
    sorted.resize(count);
    if (count == 0) return ends;
    std::exclusive_scan(places.begin(), places.end(), places.begin(), 0U);
    std::exclusive_scan(ends.begin(), ends.end(), ends.begin(), 0U);
    Array<std::uint32_t> by_colour(count);
    for (std::uint32_t i = 0; i < joints.size(); ++i)
        if (roots[i] != no_root) by_colour[places[joints[i].placement.colour]++] = i;
    for (const std::uint32_t i : by_colour) sorted[ends[roots[i]]++] = &joints[i];
    const auto order_of = [&](const JointCandidate* joint) {
        const Placement& p = joint->placement;
        return std::uint64_t{p.colour} << 40 | std::uint64_t{p.type} << 32 | rigid.slot[rigid_row_of(p)];
    };
    auto begin = sorted.begin();
    for (const std::uint32_t end : ends) {
        const auto own_end = sorted.begin() + static_cast<std::ptrdiff_t>(end);
        std::sort(begin, own_end, [&](const JointCandidate* x, const JointCandidate* y) {
            return order_of(x) < order_of(y);
        });
        begin = own_end;
    }
    return ends;
}

Members members_of(std::span<const JointCandidate> joints, const BodySets& sets, const BodyStore& bodies,
                   const KernelTable& kernels, bool exact, Figures::Refused& refused)
{
    Members members;
    const Array<std::uint32_t> ends =
        sort_by_component(joints, sets, bodies, kernels,
                          exact ? bodies.rows(BodyKind::rigid).size() : most_bodies, members.joints);
    members.signatures.reserve(4 * members.joints.size());
    members.bodies.reserve(2 * members.joints.size());
    BodyNames names(bodies);
    for (const std::uint32_t end : ends) {
        const std::size_t begin = members.first_joint.back();
        if (begin == end) continue;
        const auto own = std::span<const JointCandidate* const>(members.joints).subspan(begin, end - begin);
        const BodyId light = exact ? light_between_heavy(own, bodies) : BodyId{};
        if (light != BodyId{}) {
            refused.joints += std::count_if(
                own.begin(), own.end(), [](const JointCandidate* joint) { return joint->equalities > 0; });
            refused.light_body = light;
        }
        add_member(members, end, names, light != BodyId{});
    }
    return members;
}

/// The members in an order in which copies follow each other. (If two shapes had the same hash, fewer copies would be
/// found at once.)
Array<std::size_t> sorted_by_signature(const Members& members)
{
    Array<std::pair<std::uint64_t, std::size_t>> hashed(members.count());
    for (std::size_t i = 0; i < hashed.size(); ++i) {
        std::uint64_t hash = 14695981039346656037ULL;  // FNV-1a
        for (const std::uint32_t number : members.signature_of(i)) hash = (hash ^ number) * 1099511628211ULL;
        hashed[i] = {hash, i};
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
                   const KernelTable& kernels, bool exact, Array<Placement>& placed)
{
    const std::size_t rigid_rows = bodies.rows(BodyKind::rigid).size();
    refused_ = {};
    shapes_.clear();
    blocks_.clear();
    lone_.clear();
    touched_trees_.clear();
    const Members members = members_of(joints, sets, bodies, kernels, exact, refused_);
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
        // Too few copies, and nothing to be solved exactly.
        if (!exact && copies.size() < fewest_copies) continue;
        std::unique_ptr<FigureShape> shape = shape_of(members, copies.front());
        const bool has_tree = exact && members.is_refused[copies.front()] == 0 && build_tree(*shape);
        if (!has_tree && shape->bodies.size() > most_bodies) continue;
        for (std::size_t first = 0; first < copies.size(); first += block_lanes) {
            const std::size_t count = std::min<std::size_t>(block_lanes, copies.size() - first);
            if (!has_tree && count < fewest_copies) break;
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
