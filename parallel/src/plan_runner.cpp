// See plan_runner.h.
#include "plan_runner.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "motley/reference/scene_step.h"
#include "stores/joint_store.h"

namespace motley {

namespace {

#ifdef MOTLEY_WITHOUT_DIRECT
constexpr bool direct_is_built = false;
#else
constexpr bool direct_is_built = true;
#endif

}  // namespace

void PlanRunner::run(const Plan& plan, const Plan& figure_plan, const Step& step, StepClock& clock)
{
    layout_.context.replay = plan.replays_warm_starts ? Replay::next_time : Replay::nothing;
    layout_.context.discs_are_measured =
        step.settings.method == Method::soft_step && step.settings.relaxations > 0;
    sweeper_.leave_out_contacts(step.settings.exact_contacts && exact_contacts_.left_out() == 0);
    int of_substep = -1;
    for_each_stage(plan, [&](const PlanStage& stage, int substep) {
        if (substep != of_substep) solves_in_substep_ = 0;
        of_substep = substep;
        clock.enter(stage_of(stage.operation));
        run_stage(stage, substep, plan, figure_plan, step);
    });
    // Each substep has a warm start, replayed or swept.
    step.report.sweeps += plan.substeps;
}

void PlanRunner::run_stage(const PlanStage& stage, int substep, const Plan& plan, const Plan& figure_plan,
                           const Step& step)
{
    switch (stage.operation) {
        case Operation::find_islands:
            convergence_.find_islands(layout_.context, layout_.joint_placements(),
                                      layout_.contact_placements(), layout_.swept());
            convergence_.take_wishes(step.scene, layout_.swept());
            break;
        case Operation::note_momenta:
            sweeper_.begin_free_groups();
            break;
        case Operation::prepare:
            sweeper_.transfer(&ConstraintKernels::prepare);
            discs_.prepare(step.scene);
            if (step.settings.exact_contacts) begin_exact_contacts(step);
            break;
        case Operation::stiffen:
            if (layout_.is_overloaded()) sweeper_.sweep(&ConstraintKernels::stiffen);
            break;
        case Operation::list_bodies_beside_patches:
            sweeper_.list_beside_patches();
            break;
        case Operation::step_figures:
            sweeper_.step_lone_figures(figure_plan);
            break;
        case Operation::solve_directly:
            // Without it settings that ask for it are refused.
            if constexpr (direct_is_built) {
                discs_.prepare(step.scene);
                const reference::DirectResult result = reference::step_directly(
                    step.scene, step.dt, step.settings, step.contacts, layout_.intake.surfaces);
                step.report.direct_violation = result.violation;
                step.report.direct_unsolved = result.unsolved;
            }
            break;
        case Operation::add_up_impulses:
            sweeper_.add_up();
            break;
        case Operation::integrate_velocities:
            sweeper_.integrate(substep == 0 ? &BodyKernels::begin_velocities
                                            : &BodyKernels::integrate_velocities);
            break;
        case Operation::factor_trees:
            sweeper_.prepare_touched_trees();
            break;
        case Operation::begin_trees:
            sweeper_.begin_touched_trees();
            break;
        case Operation::warm_start:
            sweeper_.sweep(&ConstraintKernels::warm_start);
            if (plan.replays_warm_starts) layout_.context.replay = Replay::last_substep;
            break;
        case Operation::lengthen_steps:
            sweeper_.lengthen_steps_beside_touched_trees();
            break;
        case Operation::solve_trees:
            sweeper_.solve_touched_trees(layout_.context.step.exact_rate);
            break;
        case Operation::solve:
            sweep(&ConstraintKernels::solve, stage, step);
            break;
        case Operation::measure:
            measure_residual(step);
            break;
        case Operation::visit_patches:
            sweeper_.visit_patches(plan.visit);
            break;
        case Operation::integrate_positions:
            if (stage.where == Where::beside_patches) {
                sweeper_.move_beside_patches();
            } else {
                sweeper_.integrate(&BodyKernels::integrate_positions);
            }
            break;
        case Operation::integrate_on:
            sweeper_.integrate(&BodyKernels::integrate_on);
            break;
        case Operation::project:
            for (int i = 0; i < stage.times; ++i) sweeper_.sweep(&ConstraintKernels::project);
            step.report.sweeps += stage.times;
            break;
        case Operation::relax:
            sweep(&ConstraintKernels::relax, stage, step);
            break;
        case Operation::restitute:
            sweeper_.sweep(&ConstraintKernels::restitute);
            break;
        case Operation::store:
            sweeper_.transfer(&ConstraintKernels::store);
            break;
        case Operation::land:
            sweeper_.land_free_groups();
            break;
        case Operation::move_bodies:
            move_bodies(step);
            break;
    }
}

/// Sweeps as often as a stage says, and counts the sweeps.
void PlanRunner::sweep(ConstraintKernels::Sweep ConstraintKernels::*kernel, const PlanStage& stage,
                       const Step& step)
{
    int sweeps = stage.times;
    if (stage.where == Where::beside_patches) {
        sweeper_.sweep_beside_patches(kernel);  // the visit of the patches is the rest of the same sweep
    } else {
        sweeps = step.picks_islands ? iterate_by_island(kernel, stage.times, step)
                                    : iterate(kernel, stage.times, step);
    }
    step.report.sweeps += sweeps;
    if (kernel != &ConstraintKernels::solve) return;
    solves_in_substep_ += sweeps;
    step.report.iterations = std::max(step.report.iterations, solves_in_substep_);
}

/// Whether velocities are computed anew between sweeps. Not with trees of touched figures, because a warm start does
/// not apply their impulses.
bool PlanRunner::renews(const SolverSettings& settings) const
{
    return sweeps_long(settings) && layout_.figures.touched_trees().empty();
}

void PlanRunner::renew_after(int done, int most)
{
    if (done % Renewal::sweeps == 0 || done == most) renewal_.renew();
}

int PlanRunner::iterate(ConstraintKernels::Sweep ConstraintKernels::*kernel, int times, const Step& step)
{
    const bool renewing = renews(step.settings);
    if (renewing) renewal_.begin();
    for (int done = 1; done <= times; ++done) {
        sweeper_.sweep(kernel);
        solve_exactly(kernel, step);
        if (renewing) renew_after(done, times);
    }
    return times;
}

/// Sweeps until every island is within the tolerance, at most `times` times, or more often where the host asked for
/// it. Returns how often.
int PlanRunner::iterate_by_island(ConstraintKernels::Sweep ConstraintKernels::*kernel, int times,
                                  const Step& step)
{
    const float tolerance = step.settings.tolerance;
    const bool renewing = renews(step.settings);
    if (renewing) renewal_.begin();
    convergence_.start_over(layout_.swept());
    // The host asks for sweeps of `solve`, not of `relax`.
    const int most =
        kernel == &ConstraintKernels::solve ? std::max(times, convergence_.most_wanted()) : times;
    int done = 0;
    while (done < most && convergence_.unfinished() > 0) {
        ++done;
        // Measuring costs about a sweep. It is done early, for islands that are nearly solved, then every fourth sweep.
        const bool measured = tolerance > 0 && (done == 2 || done % 4 == 0 || done == most);
        layout_.context.measure = measured ? Measure::while_solving : Measure::nothing;
        sweeper_.sweep(kernel, done <= times ? 0 : done);
        solve_exactly(kernel, step);
        if (measured) convergence_.judge(layout_.swept(), tolerance);
        if (renewing) renew_after(done, most);
    }
    layout_.context.measure = Measure::nothing;
    return done;
}

/// Exact joints correct positions while they solve, and not while they relax.
float PlanRunner::exact_rate(ConstraintKernels::Sweep ConstraintKernels::*kernel) const
{
    return kernel == &ConstraintKernels::solve ? layout_.context.step.exact_rate : 0;
}

void PlanRunner::find_contact_islands(const SceneCore& scene, float dt)
{
    exact_contacts_.find_islands(scene.bodies, layout_.sweeps(), layout_.discs(), dt);
}

void PlanRunner::begin_exact_contacts(const Step& step)
{
    sweeper_.begin_islands(exact_contacts_);
    step.report.exact_contacts_refused = exact_contacts_.left_out();
    step.report.exact_contact_islands = exact_contacts_.islands() - exact_contacts_.left_out();
}

/// What is solved at once after a sweep: the trees of exact joints, then the islands of exact contacts.
void PlanRunner::solve_exactly(ConstraintKernels::Sweep ConstraintKernels::*kernel, const Step& step)
{
    sweeper_.solve_touched_trees(exact_rate(kernel));
    if (!step.settings.exact_contacts) return;
    sweeper_.solve_islands(exact_contacts_, kernel == &ConstraintKernels::relax);
    step.report.exact_contacts_residual =
        std::max(step.report.exact_contacts_residual, exact_contacts_.residual());
}

/// Measures the residuals of the constraints for the present state of the bodies.
void PlanRunner::measure_residual(const Step& step)
{
    StepReport& report = step.report;
    if (step.settings.tolerance > 0) {
        report.islands = convergence_.islands();
        report.islands_above_tolerance = convergence_.unfinished();
    }
    if (!step.settings.measures && step.settings.budget_ms == 0) return;
    convergence_.start_over(layout_.swept());
    layout_.context.measure = Measure::without_solving;
    sweeper_.sweep(&ConstraintKernels::solve);
    layout_.context.measure = Measure::nothing;
    const ResidualSum sum = sum_residuals(layout_.swept());
    const auto constraints = static_cast<double>(std::max<std::int64_t>(1, sum.constraints));
    report.measures.residual_norm = std::sqrt(sum.energy);
    report.measures.residual_rms = std::sqrt(sum.squares / constraints);
    report.measures.residual_max = sum.largest;
}

void PlanRunner::move_bodies(const Step& step)
{
    SceneCore& scene = step.scene;
    std::uint32_t first_slot = 0;
    step.report.bodies_contained = sweeper_.commit(scene.bodies, first_slot);
    if (layout_.is_overloaded()) scene.bodies.restore_planar_inertia();
    if (step.report.bodies_contained == 0) return;
    step.report.first_contained = scene.bodies.id_of_slot(first_slot);
    scene.bodies.contained_count += static_cast<std::size_t>(step.report.bodies_contained);
    scene.joints->change_altogether();  // joints of contained bodies are left out from now on
    scene.discs.is_stale = true;        // and so are their discs
    scene.wake_contained();
}

bool PlanRunner::sweeps_long(const SolverSettings& settings)
{
    return std::max(settings.iterations, settings.relaxations) > Renewal::sweeps;
}

}  // namespace motley
