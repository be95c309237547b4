// Groups are found when joints change, and used at the beginning and the end of each step.
#include "layout/free_groups.h"

#include <utility>

namespace motley {
namespace {

bool is_fixed(BodyRow body)
{
    return body.kind() == BodyKind::fixed;
}

/// Where the floats of a body begin.
std::size_t row_offset(BodyRow body)
{
    return std::size_t{4} * static_cast<std::size_t>(quads_of(body.kind())) * body.row();
}

}  // namespace

void FreeGroups::find(const JointIntake& intake)
{
    const BodySets& sets = intake.sets();
    // Groups are numbered in the order of their first bodies; then their members are counted, and stored group by group.
    constexpr std::int32_t none = -1, held = -2;
    group_of_root_.assign(sets.size(), none);
    const auto group_of = [&](BodyRow body) -> std::int32_t& {
        return group_of_root_[static_cast<std::size_t>(sets.root(body))];
    };
    for (const JointCandidate& joint : intake.joints()) {
        const BodyRow a = joint.placement.a, b = joint.placement.b;
        if (joint.locks_place && is_fixed(a) != is_fixed(b)) group_of(is_fixed(a) ? b : a) = held;
    }
    end_of_members_.clear();
    for (const BodyRow body : intake.bodies()) {
        std::int32_t& group = group_of(body);
        if (group == held) continue;
        if (group == none) {
            group = static_cast<std::int32_t>(end_of_members_.size());
            end_of_members_.push_back(0);
        }
        ++end_of_members_[static_cast<std::size_t>(group)];
    }
    std::uint32_t members = 0;
    for (std::uint32_t& end : end_of_members_)
        members += std::exchange(end, members);  // where the group begins, until its members are stored
    members_.resize(members);
    start_momenta_.resize(end_of_members_.size());
    for (const BodyRow body : intake.bodies()) {
        const std::int32_t group = group_of(body);
        if (group != held) members_[end_of_members_[static_cast<std::size_t>(group)]++] = body;
    }
}

std::span<const BodyRow> FreeGroups::members(std::int64_t group) const
{
    const auto i = static_cast<std::size_t>(group);
    const std::uint32_t begin = i == 0 ? 0 : end_of_members_[i - 1];
    return std::span(members_).subspan(begin, end_of_members_[i] - begin);
}

/// The sums are not finite when a member is not: then land() finds no free flight.
FreeGroups::Sums FreeGroups::sums_of(const KernelContext& context, std::int64_t group) const
{
    Sums sums;
    for (const BodyRow body : members(group)) {
        const BodyArrays& rows = context.bodies[static_cast<int>(body.kind())];
        const float* v = rows.velocity + row_offset(body);
        const float* a = rows.acceleration + row_offset(body);
        const double m = 1 / double{v[3]};
        sums.mass += m;
        sums.momentum = sums.momentum + m * Vec3<double>{v[0], v[1], v[2]};
        sums.force = sums.force + m * Vec3<double>{a[0], a[1], a[2]};
        sums.in_plane = sums.in_plane || body.kind() == BodyKind::planar;
        sums.is_damped = sums.is_damped || (rows.decay != nullptr && rows.decay[row_offset(body) + 3] == 0);
    }
    if (sums.in_plane) sums.momentum.z = sums.force.z = 0;
    return sums;
}

void FreeGroups::begin(const KernelContext& context, std::int64_t group)
{
    start_momenta_[static_cast<std::size_t>(group)] = sums_of(context, group).momentum;
}

void FreeGroups::land(const KernelContext& context, std::int64_t group) const
{
    const StepConstants& step = context.step;
    const Sums sums = sums_of(context, group);
    if (sums.is_damped) return;  // it does not fly on a parabola
    Vec3<double> a = 1 / sums.mass * sums.force + convert<double>(step.gravity);
    if (sums.in_plane) a.z = 0;
    const auto along = [&](const Vec3<double>& momentum) { return dot(1 / sums.mass * momentum, a); };
    if (!flew_freely(along(start_momenta_[static_cast<std::size_t>(group)]), along(sums.momentum),
                     double{step.seconds} * dot(a, a)))
        return;
    const Vec3<float> back = convert<float>(double{step.flight_excess} * a);
    for (const BodyRow body : members(group)) {
        float* delta = context.bodies[static_cast<int>(body.kind())].delta + row_offset(body);
        delta[0] -= back.x;
        delta[1] -= back.y;
        if (!sums.in_plane) delta[2] -= back.z;  // of a planar body this is its yaw
    }
}

}  // namespace motley
