// Where each joint is in the blocks, so that the blocks stay as they are when a few joints come and go: those that go give
// their lanes back, and those that come get free ones.
//
// The bits of a step depend on the colours of joints, and not on which lane a joint is in, nor on whether a figure is solved
// in lockstep. Colours are given as JointIntake::take() gives them, so the bits are those of a layout that is made anew.
#pragma once

#include <optional>

#include "figures/figures.h"
#include "layout/batches.h"
#include "layout/free_groups.h"
#include "layout/joint_intake.h"
#include "scene/scene_core.h"
#include "stores/array.h"

namespace motley {

class JointLanes {
  public:
    JointLanes(BatchSet& batches, Figures& figures, JointIntake& intake, FreeGroups& groups,
               const KernelTable& kernels)
        : batches_(batches), figures_(figures), intake_(intake), groups_(groups), kernels_(kernels)
    {
    }
    /// The blocks have been made anew.
    void start_over(JointStores& joints);
    /// Follows JointStores::changes. Returns false if it cannot; then all must be laid out anew. It cannot when colours do
    /// not suffice, when there are no free lanes left, when a component too large for a figure may have lost or won bodies,
    /// when bodies are contained, or when what is solved exactly has to be found anew (see Figures).
    [[nodiscard]] bool follow(SceneCore& scene, ColourMasks& masks);

    /// For Figures. The joint in this lane of a copy gets a lane among those that are swept by colour. Returns false when
    /// there is none.
    [[nodiscard]] bool sweep(const BatchSet::Lane& lane);
    /// A joint that is swept by colour is put into this lane of a copy.
    void solve_in_copy(const Placement& joint, const BatchSet::Lane& lane);
    void move(const BatchSet::Lane& from, const BatchSet::Lane& to);
    void end_block_at(const BatchSet::Lane& lane) { batches_.end_block_at(lane); }

  private:
    BatchSet& batches_;
    Figures& figures_;
    JointIntake& intake_;
    FreeGroups& groups_;
    const KernelTable& kernels_;
    JointStores* joints_ = nullptr;  ///< of the scene that follow() is called for

    /// Which joint is where, by slot.
    struct Place {
        std::uint32_t generation = 0;
        BatchSet::Lane lane;
        bool is_new = false;  ///< it has come with these changes
        [[nodiscard]] bool is_in_lane() const { return lane.constraint_class >= 0; }
    };
    Array<Place> places_;
    Array<std::uint32_t> gone_;  ///< slots
    Array<Placement> come_;      ///< with a colour only if they slept
    struct Change {
        BodyRow a, b;
        friend bool operator==(const Change&, const Change&) = default;
    };
    Array<Change> changes_;  ///< the bodies of joints that have come or gone
    enum class Size : std::uint8_t {
        unknown,
        small,  ///< the body's component has been listed, for these changes
        large   ///< it is too large for a figure; it does not change until all is laid out anew
    };
    std::array<Array<Size>, body_kind_count> sizes_;  ///< by row
    Array<BodyRow> small_;                            ///< the bodies whose size is small
    struct Component {
        Array<BodyRow> bodies;
        Array<JointCandidate> joints;
    } component_;
    std::array<Array<BodyRow>, 2> reached_;  ///< by are_connected(), from each end
    JointColumns columns_;                   ///< of joints_

    void look_at(JointStores& joints);
    void note_changes(const SceneCore& scene);
    bool take_figures_apart();
    void drop_gone();
    void renew_mask(const BodyStore& bodies, BodyRow body, ColourMasks& masks);
    bool place_new(ColourMasks& masks);
    [[nodiscard]] bool are_connected(const BodyStore& bodies, BodyRow from, BodyRow to);
    [[nodiscard]] bool find_components(const SceneCore& scene);
    [[nodiscard]] Size& size_of(BodyRow body)
    {
        return sizes_[static_cast<std::size_t>(body.kind())][body.row()];
    }
    [[nodiscard]] bool gather(const SceneCore& scene, BodyRow from);
    [[nodiscard]] Place& place_of(int type, std::int32_t constraint);
    /// Of a JointStores::Slot.
    template <class Slot>
    [[nodiscard]] Place& place_of(const Slot& joint)
    {
        return place_of(contact_type_count + joint.type, static_cast<std::int32_t>(joint.index));
    }
    [[nodiscard]] bool add(const Placement& joint);
    void leave(const BatchSet::Lane& lane);
    void touch(const Placement& joint);
};

}  // namespace motley
