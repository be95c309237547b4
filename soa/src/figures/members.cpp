// Finds components by union-find, and writes down their shapes in the order of the colours of their joints.
#include "figures/members.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

#include "figures/joint_order.h"
#include "figures/light_bodies.h"

namespace motley {
namespace {

/// Adds a member whose joints end at `end`: numbers its bodies and writes its signature.
void add_member(Members& members, std::size_t end, BodyNames& names, bool is_exact)
{
    const std::size_t first_body = members.bodies.size();
    names.start_figure();
    for (std::size_t i = members.first_joint.back(); i < end; ++i) {
        const JointCandidate& joint = *members.joints[i];
        const Placement& p = joint.placement;
        members.signatures.push_back(kind_number_of(joint));
        members.signatures.push_back(names.name(p.a, members.bodies, first_body));
        members.signatures.push_back(names.name(p.b, members.bodies, first_body));
    }
    members.signatures.push_back(is_exact ? 1 : 0);
    members.is_exact.push_back(is_exact ? 1 : 0);
    members.first_joint.push_back(end);
    members.first_body.push_back(members.bodies.size());
    members.first_number.push_back(members.signatures.size());
}

/// By root of a component: whether it may be solved exactly although it has more than Figures::most_bodies moving bodies.
Array<std::uint8_t> find_large_exact(std::span<const JointCandidate> joints, const BodySets& sets,
                                     const BodyStore& bodies, const ExactFigures& exact)
{
    Array<std::uint8_t> may_be_exact(sets.size(), exact.all ? 1 : 0);
    if (exact.all || !exact.any()) return may_be_exact;
    // Where it turns a heavy rotor, or meets a necessary condition of bears_heavy_load().
    Array<MassSpan> spans(sets.size());
    for (const JointCandidate& joint : joints) {
        for (const BodyRow body : {joint.placement.a, joint.placement.b}) {
            if (!is_rigid(body)) continue;
            const auto root = static_cast<std::size_t>(sets.root(body));
            spans[root].note(bodies.rigid_mass_of(body).inverse_mass);
            if (joint.rotor_load > exact.above_ratio) may_be_exact[root] = 1;
        }
    }
    for (std::size_t root = 0; root < spans.size(); ++root)
        if (spans[root].is_wider_than(exact.above_ratio)) may_be_exact[root] = 1;
    return may_be_exact;
}

/// Sorts the joints of all components that may be figures, component after component. Returns where the joints of each
/// end, by its root.
Array<std::uint32_t> sort_by_component(std::span<const JointCandidate> joints, const BodySets& sets,
                                       const BodyStore& bodies, const KernelTable& kernels,
                                       const ExactFigures& exact, BodyNames& names,
                                       Array<const JointCandidate*>& sorted)
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
    const Array<std::uint8_t> may_be_large = find_large_exact(joints, sets, bodies, exact);
    // Joints are counted by colour and by component. Then they are sorted by colour, and from there put into their
    // components, in which little is left to be sorted.
    constexpr std::uint32_t no_root = excluded;
    Array<std::uint32_t> roots(joints.size());  // by joint
    Array<std::uint32_t> ends(sets.size(), 0);
    std::array<std::uint32_t, parallel_colours> places{};
    for (std::size_t i = 0; i < joints.size(); ++i) {
        const Placement& joint = joints[i].placement;
        roots[i] = no_root;
        if (!can_be_in_lanes(joint, kernels)) continue;
        const std::size_t root = root_of({BodyKind::rigid, rigid_row_of(joint)});
        if (members[root] == excluded) continue;
        if (members[root] > Figures::most_bodies && may_be_large[root] == 0) continue;
        roots[i] = static_cast<std::uint32_t>(root);
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
    JointOrder order;
    std::size_t begin = 0;
    for (const std::uint32_t end : ends) {
        if (end - begin > 1) order.sort(std::span(sorted).subspan(begin, end - begin), rigid.slot, names);
        begin = end;
    }
    return ends;
}

bool is_wanted_exact(std::span<const JointCandidate* const> joints, const BodyStore& bodies,
                     const ExactFigures& exact)
{
    return exact.all || (exact.any() && (turns_heavy_rotor(joints, exact.above_ratio) ||
                                         bears_heavy_load(joints, bodies, exact.above_ratio)));
}

}  // namespace

Members::Members(std::span<const JointCandidate> component, const BodyStore& store, const ExactFigures& exact,
                 BodyNames& names)
{
    for (const JointCandidate& joint : component) joints.push_back(&joint);
    std::sort(joints.begin(), joints.end(), [](const JointCandidate* x, const JointCandidate* y) {
        return x->placement.colour < y->placement.colour;
    });
    names.make_room(store);
    JointOrder().sort(joints, store.rows(BodyKind::rigid).slot, names);
    const bool is_wanted = is_wanted_exact(joints, store, exact);
    add_member(*this, joints.size(), names, is_wanted && light_between_heavy(joints, store) == BodyId{});
}

Members::Members(std::span<const JointCandidate> candidates, const BodySets& sets, const BodyStore& store,
                 const KernelTable& kernels, const ExactFigures& exact, BodyNames& names,
                 Figures::Refused& refused)
{
    names.make_room(store);
    const Array<std::uint32_t> ends =
        sort_by_component(candidates, sets, store, kernels, exact, names, joints);
    signatures.reserve(4 * joints.size());
    bodies.reserve(2 * joints.size());
    for (const std::uint32_t end : ends) {
        const std::size_t begin = first_joint.back();
        if (begin == end) continue;
        const auto own = std::span<const JointCandidate* const>(joints).subspan(begin, end - begin);
        const bool is_wanted = is_wanted_exact(own, store, exact);
        const BodyId light = is_wanted ? light_between_heavy(own, store) : BodyId{};
        if (exact.all && light != BodyId{}) {
            refused.joints += std::count_if(
                own.begin(), own.end(), [](const JointCandidate* joint) { return joint->equalities > 0; });
            refused.light_body = light;
        }
        add_member(*this, end, names, is_wanted && light == BodyId{});
    }
}

std::unique_ptr<FigureShape> Members::shape_of(std::size_t member) const
{
    auto shape = std::make_unique<FigureShape>();
    for (const BodyRow body : bodies_of(member)) shape->bodies.push_back(body.kind());
    const std::span<const JointCandidate* const> own = joints_of(member);
    const std::span<const std::uint32_t> signature = signature_of(member);
    for (std::size_t i = 0; i < own.size(); ++i) {
        const Placement& p = own[i]->placement;
        shape->joints.push_back({p.type, p.a.kind(), p.b.kind(), p.colour,
                                 static_cast<int>(signature[3 * i + 1]),
                                 static_cast<int>(signature[3 * i + 2]), own[i]->equalities,
                                 own[i]->locks_point, own[i]->active_row, own[i]->has_rotor()});
    }
    shape->signature.assign(signature.begin(), signature.end());
    return shape;
}

}  // namespace motley
