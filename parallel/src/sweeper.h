// The parts of a substep, each over everything that the layout has cut, in chunks that do not depend on the number of
// threads.
#pragma once

#include <cstdint>
#include <span>

#include "contacts/exact_contacts.h"
#include "figures/figure_step.h"
#include "figures/figure_workspace.h"
#include "layout/layout.h"
#include "region_link.h"
#include "stage_runner.h"
#include "stores/array.h"

namespace motley {

class Sweeper {
  public:
    Sweeper(StageRunner& runner, Layout& layout);

    RegionLink* region = nullptr;  ///< as DiscPipeline::region

    /// After the layout is cut: makes space to solve its figures. Allocates only when one is larger than all before.
    void make_room();
    /// Moves data between the scene and the blocks: kernel prepare or store.
    void transfer(ConstraintKernels::Transfer ConstraintKernels::*kernel);
    /// v += h a or x += h v, by the kernel of each kind of body that has one.
    void integrate(BodyKernels::Move BodyKernels::*kernel);
    static constexpr int every_block = -1;
    /// Runs a kernel over every block; or, given `at_least`, over those that are not finished and want at least that
    /// many sweeps.
    void sweep(ConstraintKernels::Sweep ConstraintKernels::*kernel, int at_least = every_block);
    /// Runs a kernel over every block that is in no patch.
    void sweep_beside_patches(ConstraintKernels::Sweep ConstraintKernels::*kernel,
                              int at_least = every_block);
    /// Adds the impulses of a substep to the sums over those before it.
    void add_up();
    /// Runs these stages over one patch after another: `solve`, `integrate_positions` and `relax`. See
    /// visit_patches_once().
    void visit_patches(std::span<const PlanStage> stages);
    /// Lists all bodies that are in no patch, once a step. move_beside_patches() then does x += h v for them.
    void list_beside_patches();
    void move_beside_patches();
    /// Runs the whole plan over the figures that touch no other moving body.
    void step_lone_figures(const Plan& plan);
    /// The contacts that they had in this step.
    [[nodiscard]] BatchSet::Count contacts_in_lockstep() const;
    /// For the trees of figures that touch another moving body: prepare_tree(), begin_tree(), lengthen_steps() and
    /// solve_tree() of each.
    void prepare_touched_trees();
    void begin_touched_trees();
    void lengthen_steps_beside_touched_trees();
    void solve_touched_trees(float rate);
    /// ExactContacts::begin and solve of every island.
    void begin_islands(ExactContacts& contacts);
    void solve_islands(ExactContacts& contacts, bool relaxes);
    /// Whether sweeps of solve and relax leave out the contacts of the list and of capsules from now on.
    void leave_out_contacts(bool leave_out) { leaves_out_contacts_ = leave_out; }
    /// Adds the displacements of a step to the poses. Returns how many bodies had to be contained because their state
    /// is not finite, and sets the lowest slot among them.
    std::int64_t commit(BodyStore& bodies, std::uint32_t& first_slot);
    /// FreeGroups::begin before anything moves, and FreeGroups::land before the commit.
    void begin_free_groups();
    void land_free_groups();

  private:
    StageRunner& runner_;
    Layout& layout_;
    Array<FigureWorkspace> workspaces_;  ///< one per worker
    bool leaves_out_contacts_ = false;

    [[nodiscard]] bool is_left_out(const SweepChunk& chunk,
                                   ConstraintKernels::Sweep ConstraintKernels::*kernel) const;
    void run_unless_left_out(std::span<const SweepChunk> chunks,
                             ConstraintKernels::Sweep ConstraintKernels::*kernel, int at_least);

    void sweep_discs(ConstraintKernels::Sweep ConstraintKernels::*kernel, int at_least);
    template <class Run>
    void sweep_region(const Run& run);
    void sweep_patches(ConstraintKernels::Sweep ConstraintKernels::*kernel, int at_least);
    void move_patch(const KernelContext& context, std::int64_t patch);
    void relax_patch(const KernelContext& context, std::int64_t patch);
    template <class Work>
    void for_each_free_group(const Work& work);
    template <class Work>
    void for_each_touched_tree(const Work& work);
};

}  // namespace motley
