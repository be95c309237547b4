// Groups of bodies that joints connect and nothing else touches: their centre of mass is in free flight.
#pragma once

#include <cstdint>
#include <span>

#include "layout/block.h"
#include "layout/joint_intake.h"
#include "stores/array.h"
#include "stores/body_store.h"

namespace motley {

class FreeGroups {
  public:
    /// Finds the groups of a scene, except those that a lock ties to a fixed body.
    void find(const JointIntake& intake);
    /// The group of this body, if it has one, is no longer a group.
    void dissolve(BodyRow body);
    /// Bodies whose groups have been dissolved, and which these joints connect, are a group now, unless a lock ties one to a
    /// fixed body.
    void add(std::span<BodyRow> members, std::span<const JointCandidate> joints);
    [[nodiscard]] std::int64_t size() const { return static_cast<std::int64_t>(groups_.size()); }

    /// At the beginning of a step: stores the momentum of a group, its mass, and the force on it.
    void begin(const KernelContext& context, std::int64_t group);
    /// At the end of a step: if forces alone changed the momentum of a group, moves it back by the distance that
    /// v += h a, x += h v has moved its centre of mass too far (v: velocity, a: acceleration, x: position, h:
    /// substep; see Flight). The bits do not depend on the order of groups.
    void land(const KernelContext& context, std::int64_t group) const;

  private:
    void close_gaps();
    [[nodiscard]] std::span<const BodyRow> members(std::int64_t group) const;
    struct Sums {
        double mass = 0;
        Vec3<double> momentum{}, force{};  ///< N s; N, without gravity
        bool in_plane = false;             ///< some body is planar, so the group is not free along z
        bool is_damped = false;            ///< some body is, so the group does not fly on a parabola
    };
    [[nodiscard]] std::int32_t& group_of(BodyRow body)
    {
        return group_of_body_[static_cast<std::size_t>(body.kind())][body.row()];
    }
    [[nodiscard]] Sums sums_of(const KernelContext& context, std::int64_t group) const;
    [[nodiscard]] Vec3<double> momentum_of(const KernelContext& context, std::int64_t group) const;
    static constexpr std::int32_t none = -1;
    Array<std::int32_t> group_of_root_;  ///< while groups are found: by root in JointIntake::sets()
    struct Group {
        std::uint32_t begin = 0, end = 0;  ///< in members_
    };
    Array<Group> groups_;
    Array<BodyRow> members_;  ///< by kind and row within a group, with gaps where groups were dissolved
    std::size_t in_groups_ = 0;
    std::array<Array<std::int32_t>, body_kind_count> group_of_body_;  ///< by kind and row: its index, or none
    Array<Sums> start_;                                               ///< by group
};

}  // namespace motley
