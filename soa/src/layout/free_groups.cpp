// Groups are found when joints change, and used at the beginning and the end of each step.
#include "layout/free_groups.h"

#include <algorithm>
#include <utility>

#include "stores/growth.h"

namespace motley {
namespace {

constexpr BodyKind moving_kinds[] = {BodyKind::particle, BodyKind::planar, BodyKind::rigid};

/// Where the floats of a body begin.
std::size_t row_offset(BodyRow body)
{
    return std::size_t{4} * static_cast<std::size_t>(quads_of(body.kind())) * body.row();
}

}  // namespace

void FreeGroups::find(const JointIntake& intake)
{
    const BodySets& sets = intake.sets();
    // Groups are numbered in the order of their first bodies; then their members are counted, and stored group by group, by
    // kind and row.
    group_of_root_.assign(sets.size(), none);
    constexpr std::int32_t held = -2;
    for (const JointCandidate& joint : intake.joints()) {
        const BodyRow body = joint.holds();
        if (body.kind() != BodyKind::fixed) group_of_root_[static_cast<std::size_t>(sets.root(body))] = held;
    }
    groups_.clear();
    in_groups_ = 0;
    for (const BodyKind kind : moving_kinds) {
        const std::span<const std::uint8_t> is_jointed = intake.is_jointed(kind);
        group_of_body_[static_cast<std::size_t>(kind)].assign(is_jointed.size(), none);
        for (std::uint32_t row = 0; row < is_jointed.size(); ++row) {
            if (is_jointed[row] == 0) continue;
            std::int32_t& group = group_of_root_[static_cast<std::size_t>(sets.root({kind, row}))];
            if (group == held) continue;
            if (group == none) {
                group = static_cast<std::int32_t>(groups_.size());
                groups_.emplace_back();
            }
            group_of({kind, row}) = group;
            ++groups_[static_cast<std::size_t>(group)].end;
            ++in_groups_;
        }
    }
    std::uint32_t members = 0;
    for (Group& group : groups_) {
        group.begin = members;
        members += std::exchange(group.end, members);
    }
    members_.resize(members);
    start_.resize(groups_.size());
    for (const BodyKind kind : moving_kinds) {
        const Array<std::int32_t>& group_of_row = group_of_body_[static_cast<std::size_t>(kind)];
        for (std::uint32_t row = 0; row < group_of_row.size(); ++row) {
            if (group_of_row[row] != none)
                members_[groups_[static_cast<std::size_t>(group_of_row[row])].end++] = {kind, row};
        }
    }
}

void FreeGroups::dissolve(BodyRow body)
{
    Array<std::int32_t>& group_of_row = group_of_body_[static_cast<std::size_t>(body.kind())];
    if (body.row() >= group_of_row.size() || group_of_row[body.row()] == none) return;
    const std::int32_t group = group_of_row[body.row()];
    for (const BodyRow member : members(group)) group_of(member) = none;
    in_groups_ -= members(group).size();
    groups_[static_cast<std::size_t>(group)] = groups_.back();
    groups_.pop_back();
    // The last one has its number now.
    if (group < size())
        for (const BodyRow member : members(group)) group_of(member) = group;
}

void FreeGroups::add(std::span<BodyRow> members, std::span<const JointCandidate> joints)
{
    if (joints.empty() || std::any_of(joints.begin(), joints.end(), [](const JointCandidate& joint) {
            return joint.holds().kind() != BodyKind::fixed;
        }))
        return;
    std::sort(members.begin(), members.end(), [](BodyRow x, BodyRow y) { return x.bits < y.bits; });
    if (members_.size() > 2 * in_groups_ + 1024) close_gaps();
    const auto begin = static_cast<std::uint32_t>(members_.size());
    members_.insert(members_.end(), members.begin(), members.end());
    for (const BodyRow member : members) {
        Array<std::int32_t>& group_of_row = group_of_body_[static_cast<std::size_t>(member.kind())];
        grow_to(group_of_row, std::size_t{member.row()} + 1, none);
        group_of_row[member.row()] = static_cast<std::int32_t>(groups_.size());
    }
    groups_.push_back({begin, static_cast<std::uint32_t>(members_.size())});
    in_groups_ += members.size();
    start_.resize(groups_.size());
}

void FreeGroups::close_gaps()
{
    Array<BodyRow> together;
    together.reserve(in_groups_);
    for (std::int64_t group = 0; group < size(); ++group) {
        const std::span<const BodyRow> own = members(group);
        const auto begin = static_cast<std::uint32_t>(together.size());
        together.insert(together.end(), own.begin(), own.end());
        groups_[static_cast<std::size_t>(group)] = {begin, static_cast<std::uint32_t>(together.size())};
    }
    members_ = std::move(together);
}

std::span<const BodyRow> FreeGroups::members(std::int64_t group) const
{
    const Group& range = groups_[static_cast<std::size_t>(group)];
    return std::span(members_).subspan(range.begin, range.end - range.begin);
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

Vec3<double> FreeGroups::momentum_of(const KernelContext& context, std::int64_t group) const
{
    Vec3<double> momentum{};
    for (const BodyRow body : members(group)) {
        const float* v = context.bodies[static_cast<int>(body.kind())].velocity + row_offset(body);
        momentum = momentum + 1 / double{v[3]} * Vec3<double>{v[0], v[1], v[2]};
    }
    return momentum;
}

void FreeGroups::begin(const KernelContext& context, std::int64_t group)
{
    start_[static_cast<std::size_t>(group)] = sums_of(context, group);
}

void FreeGroups::land(const KernelContext& context, std::int64_t group) const
{
    const StepConstants& step = context.step;
    const Sums& start = start_[static_cast<std::size_t>(group)];
    if (start.is_damped) return;  // it does not fly on a parabola
    Vec3<double> a = 1 / start.mass * start.force + convert<double>(step.gravity);
    if (start.in_plane) a.z = 0;
    const auto along = [&](const Vec3<double>& momentum) { return dot(1 / start.mass * momentum, a); };
    Vec3<double> momentum = momentum_of(context, group);
    if (start.in_plane) momentum.z = 0;
    if (!flew_freely(along(start.momentum), along(momentum), double{step.seconds} * dot(a, a))) return;
    const Vec3<float> back = convert<float>(double{step.flight_excess} * a);
    for (const BodyRow body : members(group)) {
        float* delta = context.bodies[static_cast<int>(body.kind())].delta + row_offset(body);
        delta[0] -= back.x;
        delta[1] -= back.y;
        if (!start.in_plane) delta[2] -= back.z;  // of a planar body this is its yaw
    }
}

}  // namespace motley
