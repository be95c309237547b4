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
    [[nodiscard]] std::int64_t size() const { return static_cast<std::int64_t>(end_of_members_.size()); }

    /// At the beginning of a step: stores the momentum of a group.
    void begin(const KernelContext& context, std::int64_t group);
    /// At the end of a step: if forces alone changed the momentum of a group, moves it back by the distance that
    /// v += h a, x += h v has moved its centre of mass too far (v: velocity, a: acceleration, x: position, h:
    /// substep; see Flight). The bits do not depend on the order of groups.
    void land(const KernelContext& context, std::int64_t group) const;

  private:
    [[nodiscard]] std::span<const BodyRow> members(std::int64_t group) const;
    struct Sums {
        double mass = 0;
        Vec3<double> momentum{}, force{};  ///< N s; N, without gravity
        bool in_plane = false;             ///< some body is planar, so the group is not free along z
        bool is_damped = false;            ///< some body is, so the group does not fly on a parabola
    };
    [[nodiscard]] Sums sums_of(const KernelContext& context, std::int64_t group) const;
    Array<std::int32_t> group_of_root_;    ///< while groups are found: by root in JointIntake::sets()
    Array<std::uint32_t> end_of_members_;  ///< by group
    Array<BodyRow> members_;               ///< of all groups, one after another
    Array<Vec3<double>> start_momenta_;    ///< by group
};

}  // namespace motley
