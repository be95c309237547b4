// How a scene is laid out for lanes in one step: coloured, in blocks, with pointers to everything a kernel
// needs.
#pragma once

#include <array>
#include <atomic>
#include <memory>
#include <optional>
#include <span>

#include "figures/figure_workspace.h"
#include "figures/figures.h"
#include "layout/batches.h"
#include "layout/contact_intake.h"
#include "layout/free_groups.h"
#include "layout/joint_intake.h"
#include "layout/joint_lanes.h"
#include "motley/core/step_report.h"
#include "scene/scene_core.h"
#include "stores/array.h"

namespace motley {

/// Rows of bodies begin ... end - 1: the unit of work of an integration.
struct RowRange {
    std::int32_t begin, end;
    std::int32_t beside = 0;  ///< how many of them are in no patch
};

/// How joints may be solved in this step.
struct FigureUse {
    bool in_lockstep = false;     ///< figures that touch no other moving body are solved on their own
    ExactFigures exact;           ///< whose locks are solved at once, by a tree
    bool limits_exactly = false;  ///< and with them limits and motors
    /// Whether trees are those of `other`.
    [[nodiscard]] bool has_trees_of(const FigureUse& other) const
    {
        return exact == other.exact && limits_exactly == other.limits_exactly;
    }
};

/// Lives as long as its solver; buffers are kept from step to step. What persists of a result (colours,
/// impulses) lives in the scene.
class Layout {
  public:
    explicit Layout(const KernelTable& kernels) : kernels_(kernels) {}

    /// What the impulses of sleepers are multiplied with, so that they stay the same forces: the length of this step and
    /// of its substeps over those of the last one.
    struct Kept {
        float step = 1, substep = 1;
    } kept;

    /// First the host's contacts are taken in...
    ContactIntake intake;
    /// ...then space is made, and the joints are coloured and placed if they have changed...
    void begin(SceneCore& scene, std::size_t contact_count, const FigureUse& use);
    /// ...then every contact gets a colour, in order, by one thread, without allocating...
    void colour_contacts(const BodyStore& bodies, ContactCache& cache);
    /// ...then the contacts are sorted into blocks (count_contacts, and its own open and fill)...
    void count_contacts(std::int64_t chunk);
    BatchSet contacts{0, contact_type_count};
    /// ...and the blocks are cut into work.
    void cut(SceneCore& scene, std::span<const Contact> list, bool tells_apart);

    /// The step's constants and the rows of the bodies.
    KernelContext context;
    void point_at(SceneCore& scene, const StepConstants& step);
    /// After the joints are prepared: whether one of them pulls harder than a substep can follow (tension.h).
    [[nodiscard]] bool is_overloaded() const { return overloaded_; }

    [[nodiscard]] const SweepLists& sweeps() const { return sweeps_; }
    /// The joints that are solved, with gaps among them (Placement::is_gap). Listed anew where joints have come or gone.
    [[nodiscard]] std::span<const Placement> joint_placements();
    [[nodiscard]] std::span<const Placement> contact_placements() const { return contacts.placements(); }
    /// The figures of the scene, and which of them are solved on their own.
    Figures figures;
    /// Groups of bodies that joints connect: see FreeGroups.
    FreeGroups groups;
    /// The bodies of a kind, except those of figures that are alone.
    [[nodiscard]] const Array<RowRange>& rows(int kind) const
    {
        return rows_[static_cast<std::size_t>(kind)];
    }
    /// Lists the bodies of range `i` of a kind that are in no patch...
    void list_beside_patches(BodyKind kind, std::int64_t i);
    /// ...and returns them.
    [[nodiscard]] std::span<const BodyRow> beside_patches(BodyKind kind, std::int64_t i) const;
    /// The contacts of discs in bands; bands of even number are independent of each other, and those of odd number:
    /// see DiscStore. `tells_apart`: as of BatchSet::cut.
    void list_discs(SceneCore& scene, bool tells_apart);
    [[nodiscard]] std::int64_t disc_bands() const { return static_cast<std::int64_t>(disc_bands_.size()); }
    [[nodiscard]] std::span<const SweepChunk> discs_of_band(std::int64_t band) const
    {
        const PatchChunks& range = disc_bands_[static_cast<std::size_t>(band)];
        return {disc_chunks_.data() + range.first, disc_chunks_.data() + range.last};
    }
    [[nodiscard]] std::span<const SweepChunk> discs() const { return disc_chunks_; }
    [[nodiscard]] SweptChunks swept() const { return {sweeps_, disc_chunks_}; }
    [[nodiscard]] const TransferList& transfers() const { return transfers_; }
    [[nodiscard]] const ConstraintData& data(int type) const { return data_[static_cast<std::size_t>(type)]; }
    [[nodiscard]] std::span<const ConstraintData> data() const { return data_; }
    [[nodiscard]] const KernelTable& kernels() const { return kernels_; }
    /// True when M^-1 J^T of every constraint is constant through the step (M: mass matrix, J: Jacobian): there are
    /// contacts only, and no rigid bodies, whose inertia rotates with them.
    [[nodiscard]] bool has_constant_responses() const
    {
        return !joints_.has_blocks() &&
               context.bodies[static_cast<int>(BodyKind::rigid)].size == 1;  // the null row
    }
    /// What figures read of the contacts that they solve.
    [[nodiscard]] ContactTables contact_tables() const
    {
        return {contact_placements(), kernels_.constraints, contacts.adds_up()};
    }
    /// Fills the counts of a report. `in_lockstep`: of the contacts that figures solved on their own.
    void report(StepReport& report, const BatchSet::Count& in_lockstep) const;

  private:
    const KernelTable& kernels_;
    BatchSet joints_{contact_type_count, constraint_type_count};
    JointIntake joint_intake_;
    Array<Placement> joint_placements_;
    bool has_placements_ = false;  ///< these are of the present joints
    JointLanes joint_lanes_{joints_, figures, joint_intake_, groups, kernels_};
    Array<std::uint32_t> uncoloured_;
    std::shared_ptr<const char> joint_version_;
    FigureUse use_;
    /// What the chunks of a step without blocks of contacts depend on in addition to the joints and lone figures.
    struct Cut {
        std::array<std::uint32_t, body_kind_count> rows;
        bool in_lockstep, tells_apart;
        friend bool operator==(const Cut&, const Cut&) = default;
    };
    std::optional<Cut> cut_;  ///< what sweeps_ and transfers_ were cut for; empty if they must be cut again
    std::array<AlignedVector<float>, body_kind_count> start_along_;  ///< see Flight
    std::array<AlignedVector<float>, body_kind_count> decay_;        ///< see BodyArrays
    std::atomic<bool> overloaded_ = false, turned_far_ = false;
    std::array<Array<std::uint16_t>, body_kind_count>
        awake_;                   ///< BodyRows::awake, or all where nobody sleeps
    Array<std::uint16_t> swept_;  ///< of `awake_` of rigid bodies, those that are in no lone figure
    std::array<Array<RowRange>, body_kind_count> rows_;
    std::array<AlignedVector<BodyRow>, body_kind_count> beside_;  ///< in no patch; at the range's first row
    ColourMasks joint_masks_, masks_;
    SweepLists sweeps_;
    TransferList transfers_;
    Array<SweepChunk> disc_chunks_;  ///< of each band and class
    Array<PatchChunks> disc_bands_;
    BlockMarks disc_marks_;
    std::array<ConstraintData, constraint_type_count> data_;

    void place_joints(SceneCore& scene);
    void keep_impulses(ContactCache& cache, std::uint32_t i);
    bool find_decay(const BodyStore& bodies, BodyKind kind, float h);
    bool note_awake(const BodyStore& bodies);
    void list_rows(const SceneCore& scene);
    void point_at_data(SceneCore& scene, std::span<const Contact> contacts);
};

}  // namespace motley
