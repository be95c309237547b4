// The parts of a substep, each over all that the layout has cut, in chunks that do not depend on the number of threads.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "figure_step.h"
#include "figure_workspace.h"
#include "layout.h"
#include "stage_runner.h"

namespace motley {

class Sweeper {
  public:
    Sweeper(StageRunner& runner, Layout& layout);

    /// Once the layout is cut: room to solve its figures in. Allocates only when one is larger than all before.
    void make_room();
    /// Between the scene and the blocks: prepare or store.
    void transfer(ConstraintKernels::Transfer ConstraintKernels::*kernel);
    /// v += h a or x += h v, by the kernel of each kind of body that has it.
    void integrate(BodyKernels::Move BodyKernels::*kernel);
    static constexpr int every_block = -1;
    /// Runs a kernel over every block; or over those that are not finished and want at least so many sweeps.
    void sweep(ConstraintKernels::Sweep ConstraintKernels::*kernel, int at_least = every_block);
    /// Runs a kernel over every block that is in no patch.
    void sweep_beside_patches(ConstraintKernels::Sweep ConstraintKernels::*kernel,
                              int at_least = every_block);
    /// Adds what constraints did in a substep to what they did in those before it.
    void add_up();
    /// Runs these stages over one patch after another: `solve`, `integrate_positions` and `relax`. See visit_patches_once().
    void visit_patches(std::span<const PlanStage> stages);
    /// x += h v of all bodies that no patch lists, which are looked for once a step.
    void list_beside_patches();
    void move_beside_patches();
    /// The whole plan over the figures that nothing else touches.
    void step_lone_figures(const Plan& plan);
    /// What is left to do for figures that something touches, where they have trees: prepare_tree(), begin_tree() and solve_tree().
    void prepare_touched_trees();
    void begin_touched_trees();
    void solve_touched_trees(float rate);
    /// Adds what a step has moved to where the bodies are. Returns how many bodies it had to contain, and sets the first
    /// one's slot.
    std::int64_t commit(BodyStore& bodies, std::uint32_t& first_slot);
    /// Before anything moves, and before the commit: see FreeGroups.
    void begin_free_groups();
    void land_free_groups();

  private:
    StageRunner& runner_;
    Layout& layout_;
    std::vector<FigureWorkspace> workspaces_;  ///< one a worker

    void sweep_patches(ConstraintKernels::Sweep ConstraintKernels::*kernel, int at_least);
    void move_patch(const KernelContext& context, std::int64_t patch);
    void relax_patch(const KernelContext& context, std::int64_t patch);
    template <class Work>
    void for_each_free_group(const Work& work);
    template <class Work>
    void for_each_touched_tree(const Work& work);
};

}  // namespace motley
