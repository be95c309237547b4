// Labels the bodies of a figure, walks over them, and sorts the joints by the walk.
#include "figures/joint_order.h"

#include <algorithm>
#include <numeric>

#include "maths/hash.h"

namespace motley {
namespace {

/// Joints away from a body that its label tells of. Mirrored limbs differ by the colours where they join.
constexpr int rounds = 4;

}  // namespace

void JointOrder::sort(std::span<const JointCandidate*> joints, const Array<std::uint32_t>& slots,
                      BodyNames& names)
{
    name_bodies(joints, names);
    refine_labels(joints);
    list_neighbours();
    walk_from(find_start(slots));
    numbered_.clear();
    for (std::size_t i = 0; i < joints.size(); ++i) {
        const Placement& p = joints[i]->placement;
        const std::uint32_t place = std::min(places_[ends_[i].a], places_[ends_[i].b]);
        numbered_.push_back({std::uint64_t{p.colour} << 40 | std::uint64_t{p.type} << 32 | place, joints[i]});
    }
    std::sort(numbered_.begin(), numbered_.end(),
              [](const Numbered& x, const Numbered& y) { return x.number < y.number; });
    std::transform(numbered_.begin(), numbered_.end(), joints.begin(),
                   [](const Numbered& numbered) { return numbered.joint; });
}

void JointOrder::name_bodies(std::span<const JointCandidate* const> joints, BodyNames& names)
{
    names.start_figure();
    bodies_.assign(1, {});
    ends_.clear();
    const auto index_of = [&](BodyRow body) {
        return body.kind() == BodyKind::fixed ? 0U : names.name(body, bodies_, 0);
    };
    for (const JointCandidate* joint : joints)
        ends_.push_back({index_of(joint->placement.a), index_of(joint->placement.b)});
}

void JointOrder::refine_labels(std::span<const JointCandidate* const> joints)
{
    labels_.assign(bodies_.size(), 1);
    for (int round = 0; round < rounds; ++round) {
        labels_[0] = 0;
        next_labels_.assign(bodies_.size(), 0);
        for (std::size_t i = 0; i < joints.size(); ++i) {
            const std::uint64_t kind = kind_number_of(*joints[i]);
            // A sum, because it does not depend on the order of the joints.
            next_labels_[ends_[i].a] += mix(kind, labels_[ends_[i].b]);
            next_labels_[ends_[i].b] += mix(~kind, labels_[ends_[i].a]);
        }
        labels_.swap(next_labels_);
    }
}

std::uint32_t JointOrder::find_start(const Array<std::uint32_t>& slots)
{
    Array<std::uint64_t>& sorted = next_labels_;
    sorted.assign(labels_.begin() + 1, labels_.end());
    std::sort(sorted.begin(), sorted.end());
    std::uint64_t label = sorted.front();
    for (auto one = sorted.begin(), end = one; one != sorted.end(); one = end) {
        end = std::upper_bound(one, sorted.end(), *one);
        if (end - one > 1) continue;
        label = *one;
        break;
    }
    std::uint32_t start = 0;
    for (std::uint32_t body = 1; body < bodies_.size(); ++body) {
        if (labels_[body] != label) continue;
        if (start == 0 || slots[bodies_[body].row()] < slots[bodies_[start].row()]) start = body;
    }
    return start;
}

void JointOrder::list_neighbours()
{
    first_neighbour_.assign(bodies_.size() + 1, 0);
    const auto for_each_pair = [&](const auto& visit) {
        for (const auto& [a, b] : ends_) {
            if (a == 0 || b == 0) continue;
            visit(a, b);
            visit(b, a);
        }
    };
    for_each_pair([&](std::uint32_t body, std::uint32_t) { ++first_neighbour_[body]; });
    std::partial_sum(first_neighbour_.begin(), first_neighbour_.end(), first_neighbour_.begin());
    neighbours_.resize(first_neighbour_.back());
    // Each body's list is filled from its end, so the joints are taken from the last colour on.
    std::reverse(ends_.begin(), ends_.end());
    for_each_pair(
        [&](std::uint32_t body, std::uint32_t other) { neighbours_[--first_neighbour_[body]] = other; });
    std::reverse(ends_.begin(), ends_.end());
}

/// Breadth first.
void JointOrder::walk_from(std::uint32_t body)
{
    constexpr std::uint32_t nowhere = ~0U;
    places_.assign(bodies_.size(), nowhere);
    walk_.clear();
    const auto reach = [&](std::uint32_t reached) {
        if (places_[reached] != nowhere) return;
        places_[reached] = static_cast<std::uint32_t>(walk_.size());
        walk_.push_back(reached);
    };
    reach(body);
    for (std::size_t i = 0; i < walk_.size(); ++i) {
        const std::uint32_t from = walk_[i];
        for (std::uint32_t next = first_neighbour_[from]; next < first_neighbour_[from + 1]; ++next)
            reach(neighbours_[next]);
    }
}

}  // namespace motley
