// Bodies that joints tie together and nothing else pushes: their centre of mass flies freely.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "block.h"
#include "body_sets.h"
#include "motley/core/body_store.h"

namespace motley {

class FreeGroups {
  public:
    /// A joint between two bodies.
    struct Tie {
        BodyRow a, b;
        /// If one body is fixed, the other cannot move along some direction, whatever forces do.
        bool locks_place;
    };
    /// Finds the groups of a scene but those that a lock ties to a fixed body.
    void find(std::span<const Tie> ties, const BodyStore& bodies);
    [[nodiscard]] std::int64_t size() const { return static_cast<std::int64_t>(end_of_members_.size()); }

    /// At the beginning of a step: notes the momentum of a group.
    void begin(const KernelContext& context, std::int64_t group);
    /// At its end: takes a group, if forces alone made its momentum, back by what v += h a, x += h v took its centre
    /// of mass too far (see Flight). The same bits whatever the order of groups.
    void land(const KernelContext& context, std::int64_t group) const;

  private:
    [[nodiscard]] std::span<const BodyRow> members(std::int64_t group) const;
    struct Sums {
        double mass = 0;
        Vec3<double> momentum{}, force{};  ///< N s; N, without gravity
        bool in_plane = false;             ///< some of it: across the plane it is not free
    };
    [[nodiscard]] Sums sums_of(const KernelContext& context, std::int64_t group) const;
    std::vector<std::uint32_t> end_of_members_;  ///< by group
    std::vector<BodyRow> members_;               ///< of all groups in line
    std::vector<Vec3<double>> start_momenta_;    ///< by group
    BodySets sets_;
};

}  // namespace motley
