// Takes in the joints of a scene when they have changed: which of them are solved, in which colours, and which bodies they
// connect. What is made of them (figures, free groups, blocks) starts from here.
#pragma once

#include <array>
#include <span>

#include "layout/batches.h"
#include "layout/body_sets.h"
#include "maths/equality_row.h"
#include "scene/scene_core.h"
#include "stores/array.h"

namespace motley {

/// A joint that is solved, with its colour.
struct JointCandidate {
    Placement placement;
    int equalities = 0;        ///< rows that may be solved exactly, or 0
    bool locks_point = false;  ///< the first three of them hold a point on a point
    ActiveRow active_row = ActiveRow::none;
    /// If one body is fixed, the joint keeps the other from moving along some direction.
    bool locks_place = false;
    float rotor_load = 0;  ///< see ConstraintTraits
    [[nodiscard]] bool has_rotor() const { return rotor_load > 0; }
    /// The moving body that the joint holds in place, with a fixed one; a fixed one if there is none.
    [[nodiscard]] BodyRow holds() const
    {
        const bool a_is_fixed = placement.a.kind() == BodyKind::fixed;
        const bool b_is_fixed = placement.b.kind() == BodyKind::fixed;
        if (!locks_place || a_is_fixed == b_is_fixed) return {BodyKind::fixed, 0};
        return a_is_fixed ? placement.b : placement.a;
    }
};

/// The handles and the colours of joints in their stores, by type of constraint, and how new joints get colours.
class JointColumns {
  public:
    JointColumns() = default;
    /// Valid until joints are added or removed.
    explicit JointColumns(JointStores& stores);
    [[nodiscard]] std::uint32_t slot_of(int type, std::int32_t constraint) const
    {
        return slots_[static_cast<std::size_t>(type)][constraint];
    }
    [[nodiscard]] std::uint8_t colour_of(int type, std::int32_t constraint) const
    {
        return colours_[static_cast<std::size_t>(type)][constraint];
    }
    /// New joints get colours in the order of this: see JointStores::colouring_order().
    [[nodiscard]] std::uint64_t order_of(const Placement& joint) const;
    /// The first colour that is free on both bodies of the joint.
    void give_colour(Placement& joint, ColourMasks& masks) const;

  private:
    const JointStores* stores_ = nullptr;
    std::array<const std::uint32_t*, constraint_type_count> slots_{};
    std::array<std::uint8_t*, constraint_type_count> colours_{};
};

class JointIntake {
  public:
    /// Starts over with the joints of the scene. Gives a colour to those that have none, and takes the colours of all in
    /// `masks`, which must be clear. Joints on contained bodies lose their impulses and are left out; those of sleepers
    /// keep what they bore and are left out. `limits_exactly`: see FigureUse.
    void take(SceneCore& scene, bool limits_exactly, ColourMasks& masks);
    /// Bodies that were added since have no joints.
    void grow(const BodyStore& bodies);
    /// Whether a body has joints, when some have come or gone.
    void note(BodyRow body, bool is_jointed)
    {
        is_jointed_[static_cast<std::size_t>(body.kind())][body.row()] = is_jointed ? 1 : 0;
    }

    /// The joints, and what they connect, as of the last take(): they do not follow joints that come and go.
    [[nodiscard]] std::span<const JointCandidate> joints() const { return joints_; }
    [[nodiscard]] const BodySets& sets() const { return sets_; }
    /// One for each row that has such a joint, else 0.
    [[nodiscard]] std::span<const std::uint8_t> is_jointed(BodyKind kind) const
    {
        return is_jointed_[static_cast<std::size_t>(kind)];
    }
    /// The joint of this type (from 0 on) and index.
    [[nodiscard]] static JointCandidate candidate(const SceneCore& scene, int type, std::size_t index);
    /// start_rows_bit (block.h) if joints of this type have rows that are made once a step; else 0. Types are numbered with
    /// those of contacts before them.
    [[nodiscard]] static std::uint32_t start_rows_bit_of(std::size_t type);

  private:
    Array<JointCandidate> joints_;
    Array<std::uint32_t> uncoloured_;  ///< indices of joints
    BodySets sets_;
    std::array<Array<std::uint8_t>, body_kind_count> is_jointed_;  ///< by kind and row

    void colour(JointStores& stores, ColourMasks& masks);
};

}  // namespace motley
