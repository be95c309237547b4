// An order of a figure's joints that follows from what they connect, so that it is the same in every copy, whatever bodies and
// joints were added and removed before.
#pragma once

#include <cstdint>
#include <span>

#include "figures/body_names.h"
#include "layout/joint_intake.h"
#include "stores/array.h"

namespace motley {

/// What the lanes of copies must have in common: types, colours and kinds of bodies. Without the bodies themselves.
[[nodiscard]] inline std::uint32_t kind_number_of(const JointCandidate& joint)
{
    const Placement& p = joint.placement;
    return p.colour | std::uint32_t{p.type} << 8 | static_cast<std::uint32_t>(p.a.kind()) << 16 |
           static_cast<std::uint32_t>(p.b.kind()) << 18 | static_cast<std::uint32_t>(joint.equalities) << 20 |
           static_cast<std::uint32_t>(joint.locks_point) << 24 |
           static_cast<std::uint32_t>(joint.has_rotor()) << 25;
}

/// The joints on a moving body have different colours. So a walk over a figure that takes the joints of each body by colour
/// is the same in every copy, if only it begins at the same body. That one is found by colour refinement (B. Weisfeiler, A.
/// Leman, The reduction of a graph to canonical form, 1968): the label of a body is a hash of its joints and of the labels
/// at their other ends. After a few rounds bodies have equal labels only if all is alike around them, and the walk begins
/// at the least label that one body alone has.
class JointOrder {
  public:
    /// Sorts the joints of one figure, which must be sorted by colour, by colour, type and the places of their bodies in the
    /// walk. `slots`: of the rigid rows, for a figure in which no body has a label of its own: there the walk begins at the
    /// least slot of a label, and copies may differ. `names` must have room for the bodies.
    void sort(std::span<const JointCandidate*> joints, const Array<std::uint32_t>& slots, BodyNames& names);

  private:
    Array<BodyRow> bodies_;  ///< the moving ones, from 1 on; 0 stands for every fixed one
    struct Ends {
        std::uint32_t a, b;  ///< indices in bodies_
    };
    Array<Ends> ends_;                           ///< by joint
    Array<std::uint64_t> labels_, next_labels_;  ///< by body
    Array<std::uint32_t> first_neighbour_;       ///< likewise, and where those of the last body end
    Array<std::uint32_t> neighbours_;  ///< of one body after another, by the colour of the joint between them
    Array<std::uint32_t> places_;      ///< in the walk, by body
    Array<std::uint32_t> walk_;        ///< bodies, by place
    struct Numbered {
        std::uint64_t number;
        const JointCandidate* joint;
    };
    Array<Numbered> numbered_;

    void name_bodies(std::span<const JointCandidate* const> joints, BodyNames& names);
    void refine_labels(std::span<const JointCandidate* const> joints);
    [[nodiscard]] std::uint32_t find_start(const Array<std::uint32_t>& slots);
    void list_neighbours();
    void walk_from(std::uint32_t body);
};

}  // namespace motley
