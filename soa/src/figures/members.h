// Components of joints that may be figures.
#pragma once

#include <memory>
#include <span>

#include "figures/figures.h"

namespace motley {

[[nodiscard]] inline bool is_rigid(BodyRow body)
{
    return body.kind() == BodyKind::rigid;
}
[[nodiscard]] inline std::uint32_t rigid_row_of(const Placement& joint)
{
    return is_rigid(joint.a) ? joint.a.row() : joint.b.row();
}
/// Whether there are kernels that solve this joint in the lanes of copies. One of its bodies is rigid then.
[[nodiscard]] inline bool can_be_in_lanes(const Placement& joint, const KernelTable& kernels)
{
    return joint.colour != overflow_colour &&
           kernels.constraints[class_of(joint.type, joint.a.kind(), joint.b.kind())].solve_copies != nullptr;
}

/// Components that may be figures, in flat lists: the joints of member m are those from first_joint[m] to
/// first_joint[m + 1], and likewise its bodies and its signature.
struct Members {
    Array<const JointCandidate*> joints;  ///< see JointOrder
    Array<BodyRow> bodies;                ///< in the order in which the joints name them
    Array<std::uint32_t> signatures;      ///< the shapes, in numbers: members with equal ones are copies
    Array<std::size_t> first_joint{0}, first_body{0}, first_number{0};
    Array<std::uint8_t> is_exact;  ///< its locks are to be solved exactly, if it has a tree

    /// Finds the components. `exact`: see Figures::find(); such figures may have any number of bodies. With ExactFigures::all
    /// `refused` is told of those in which light_between_heavy() has found a body.
    Members(std::span<const JointCandidate> candidates, const BodySets& sets, const BodyStore& store,
            const KernelTable& kernels, const ExactFigures& exact, BodyNames& names,
            Figures::Refused& refused);
    /// A component whose joints can all be in lanes. `exact`: likewise.
    Members(std::span<const JointCandidate> component, const BodyStore& store, const ExactFigures& exact,
            BodyNames& names);
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
    /// Without a tree.
    [[nodiscard]] std::unique_ptr<FigureShape> shape_of(std::size_t member) const;
    /// FNV-1a of the signature.
    [[nodiscard]] std::uint64_t hash_of(std::size_t member) const
    {
        std::uint64_t hash = 14695981039346656037ULL;
        for (const std::uint32_t number : signature_of(member)) hash = (hash ^ number) * 1099511628211ULL;
        return hash;
    }
};

}  // namespace motley
