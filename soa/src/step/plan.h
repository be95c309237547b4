// The plan of a step: what is done, in which order, in which substeps, where and how often.
//
// It is made once, from the settings and from what the constraints of the step need, and read by three runners: over
// the colours of the whole scene (parallel/src/plan_runner.h), over one patch of a large crowd
// (Sweeper::visit_patches), and over sixteen copies of a figure (figure_step.h). What makes a step faster without
// changing a bit of the result is a rewrite of the plan.
#pragma once

#include <cstdint>
#include <string>

#include "motley/core/settings.h"
#include "motley/core/step_report.h"
#include "stores/array.h"

namespace motley {

/// What a stage does. In the order in which they first occur in a step.
enum class Operation : std::uint8_t {
    find_islands,  ///< sets of constraints whose sweeps may end at different times
    note_momenta,  ///< of groups of bodies that joints connect: see FreeGroups
    prepare,       ///< definitions and last impulses -> rows and impulses
    stiffen,       ///< increases inertias of bodies under more load than a substep can follow: see tension.h
    list_bodies_beside_patches,  ///< bodies in no patch, for `integrate_positions`
    step_figures,                ///< runs this plan over figures that touch no other moving body
    solve_directly,              ///< Method::direct: the whole step by core/reference
    add_up_impulses,             ///< adds the impulses of the last substep to the sums
    integrate_velocities,        ///< v += h a
    factor_trees,                ///< of exact joints, at the present poses
    begin_trees,                 ///< impulses of exact joints start from zero; much more tension is followed
    warm_start,                  ///< applies the impulses of the last substep
    lengthen_steps,              ///< of limits and motors beside exact joints: see locked_point.h
    solve_trees,                 ///< exact joints, once
    solve,                       ///< one sweep over all constraints, and what is solved exactly after it
    measure,                     ///< residuals, with nothing changed
    visit_patches,               ///< the stages of Plan::visit over one patch after another
    integrate_positions,         ///< x += h v
    integrate_on,                ///< positions, and the velocities of the next substep in the same pass
    project,                     ///< moves bodies along J^T until no position error is left
    relax,        ///< a sweep without bias: takes away the speed that correcting positions needed
    restitute,    ///< gives back the speed that restitution asks for
    store,        ///< impulses -> joints and contacts
    land,         ///< moves what flew freely onto its parabola: see FreeGroups
    move_bodies,  ///< displacements -> positions; contains bodies whose state is not finite
};
/// "find islands", "note momenta", ...
const char* name_of(Operation operation);
/// Where StepReport::seconds counts the time of an operation.
Stage stage_of(Operation operation);

/// In which substeps a stage runs.
enum class Substeps : std::uint8_t { every, first, all_but_first, last, all_but_last };
/// Over which constraints or bodies: all of them, or those in no patch.
enum class Where : std::uint8_t { everywhere, beside_patches };

struct PlanStage {
    Operation operation;
    Substeps substeps = Substeps::every;
    Where where = Where::everywhere;
    int times = 1;  ///< of `solve` and `relax`: the most, where a tolerance may end them sooner

    [[nodiscard]] bool runs_in(int substep, int substep_count) const
    {
        const bool is_first = substep == 0, is_last = substep + 1 == substep_count;
        switch (substeps) {
            case Substeps::every:
                return true;
            case Substeps::first:
                return is_first;
            case Substeps::all_but_first:
                return !is_first;
            case Substeps::last:
                return is_last;
            case Substeps::all_but_last:
                return !is_last;
        }
        return true;
    }
};

/// What a plan depends on in addition to the settings.
struct StepNeeds {
    bool solves_trees = false;   ///< exact joints
    bool bounces = false;        ///< some constraint has restitution
    bool picks_islands = false;  ///< some islands want more sweeps than others
    bool measures = false;       ///< residuals are wanted
};

struct Plan {
    int substeps = 1;
    Array<PlanStage> before, substep,
        after;                         ///< what is done before, in each of, and after the substeps
    Array<PlanStage> visit;            ///< what Operation::visit_patches does at one visit of a patch
    bool replays_warm_starts = false;  ///< see replay_warm_starts()
};

/// Makes the plan of a step. `settings` are resolved. Keeps the capacity of the plan's lists.
void make_plan(const SolverSettings& settings, const StepNeeds& needs, Plan& plan);

// Rewrites of a plan. They change no bit of the result.
/// If a substep ends with integrating positions and the next one begins with velocities, does both in one pass over
/// the bodies.
void fuse_integrations(Plan& plan);
/// Where M^-1 J^T is constant through a step (M: mass matrix, J: Jacobian), the velocity kernels replay what the last
/// substep did to each body, so that only the first substep sweeps for its warm start.
void replay_warm_starts(Plan& plan);
/// Does the last sweep of `solve`, the integration of positions and the first sweep of `relax` of a patch in one
/// visit, while it is in a core's cache. For plans with `relax`, and without trees, measures and tolerance.
void visit_patches_once(Plan& plan);

/// Calls run(stage, substep) for each stage in turn; substep is 0 for the stages before, and the last for those after.
template <class Run>
void for_each_stage(const Plan& plan, const Run& run)
{
    for (const PlanStage& stage : plan.before) run(stage, 0);
    for (int substep = 0; substep < plan.substeps; ++substep) {
        for (const PlanStage& stage : plan.substep) {
            if (stage.runs_in(substep, plan.substeps)) run(stage, substep);
        }
    }
    for (const PlanStage& stage : plan.after) run(stage, plan.substeps - 1);
}

/// One line per stage.
std::string text_of(const Plan& plan);

}  // namespace motley
