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
};

class JointIntake {
  public:
    /// Starts over with the joints of the scene. Gives a colour to those that have none, and takes the colours of all in
    /// `masks`, which must be clear. Joints on contained bodies lose their impulses and are left out; those of sleepers
    /// keep what they bore and are left out. `limits_exactly`: see FigureUse.
    void take(SceneCore& scene, bool limits_exactly, ColourMasks& masks);
    /// Bodies that were added since have no joints.
    void grow(const BodyStore& bodies);

    [[nodiscard]] std::span<const JointCandidate> joints() const { return joints_; }
    /// The moving bodies that have one of these joints, in the order in which the joints name them first.
    [[nodiscard]] std::span<const BodyRow> bodies() const { return bodies_; }
    /// What the joints connect.
    [[nodiscard]] const BodySets& sets() const { return sets_; }
    /// One for each row of a moving kind that has such a joint, else 0.
    [[nodiscard]] const std::uint8_t* is_jointed(BodyKind kind) const
    {
        return is_jointed_[static_cast<std::size_t>(kind)].data();
    }

  private:
    Array<JointCandidate> joints_;
    Array<std::uint32_t> uncoloured_;  ///< indices of joints
    Array<BodyRow> bodies_;
    BodySets sets_;
    std::array<Array<std::uint8_t>, body_kind_count> is_jointed_;  ///< by kind and row

    void note(BodyRow body);
    void colour(JointStores& stores, ColourMasks& masks);
};

}  // namespace motley
