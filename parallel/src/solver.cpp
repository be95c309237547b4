// Solver::Impl::step shows one step on one screen: it names the stages in their order, and does nothing else.
#include "motley/parallel/solver.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <new>
#include <utility>

#include "budget.h"
#include "contact_pipeline.h"
#include "disc_pipeline.h"
#include "layout/layout.h"
#include "maths/step_constants.h"
#include "motley/core/invalid_input.h"
#include "own_executor.h"
#include "penetrations.h"
#include "plan_runner.h"
#include "scene/scene_core.h"
#include "shape_pipeline.h"
#include "sleep_pipeline.h"
#include "solver_access.h"
#include "stage_runner.h"
#include "step/plan.h"
#include "step_clock.h"
#include "stores/joint_store.h"
#include "sweeper.h"

namespace motley {
namespace {

/// The size of a step, counted in contacts: see SolverOptions::alone_below.
std::size_t size_of(const Scene& scene, std::span<const Contact> contacts)
{
    return contacts.size() + 4 * scene.joint_count() + scene.body_count() / 2 +
           2 * core_of(scene).discs.count + 2 * core_of(scene).shapes.capsules.size();
}

Isa checked_isa(const std::optional<Isa>& wanted)
{
    if (!wanted) return default_isa();
    for (const Isa isa : available_isas()) {
        if (isa == *wanted) return isa;
    }
    refuse("SolverOptions.isa", isa_name(*wanted), "an instruction set of available_isas()");
}

/// The text of the exception that is being handled; a short one where there is no memory for more.
std::string text_of_exception() noexcept
{
    try {
        throw;
    } catch (const std::bad_alloc&) {
        return "out of memory";  // short enough to need no allocation
    } catch (const std::exception& error) {
        try {
            return error.what();
        } catch (...) {
            return "out of memory";
        }
    } catch (...) {
        return "unknown throw";  // likewise
    }
}

std::string text_of(const std::exception_ptr& thrown) noexcept
{
    try {
        if (thrown) std::rethrow_exception(thrown);
    } catch (...) {
        return text_of_exception();
    }
    return {};
}

}  // namespace

struct Solver::Impl {
    SolverSettings asked;     ///< by the host
    SolverSettings settings;  ///< of this step
    Budget budget;
    Isa isa;
    std::size_t alone_below;
    std::unique_ptr<Executor> own_executor;
    StageRunner runner;
    Layout layout;
    ShapePipeline shapes;
    ContactPipeline pipeline;
    DiscPipeline discs;
    SleepPipeline sleep;
    Sweeper sweeper;
    PlanRunner plan_runner;
    Plan plan;         ///< of this step
    Plan figure_plan;  ///< the same without the rewrites, which are for the whole scene
    BusyFlag busy;

    Impl(const SolverSettings& s, Isa i, const SolverOptions& options)
        : asked(s),
          settings(s),
          isa(i),
          alone_below(options.alone_below),
          own_executor(options.executor ? nullptr : make_executor(options.threads)),
          runner(options.executor ? options.executor : own_executor.get()),
          layout(kernel_table(i)),
          shapes(runner),
          pipeline(runner, layout),
          discs(runner, layout),
          sleep(runner, layout),
          sweeper(runner, layout),
          plan_runner(sweeper, discs, layout)
    {
    }

    void step(Scene& host_scene, float dt, std::span<const Contact> hosts, StepReport& report);
    [[nodiscard]] bool runs_alone(const Scene& scene, std::span<const Contact> contacts) const;
    void pick_settings();
    void take_in(SceneCore& scene, std::span<const Contact> contacts, StepReport& report);
    void lay_out(SceneCore& scene, std::span<const Contact> contacts, StepReport& report);
    void plan_step(const SceneCore& scene);
    void finish(SceneCore& scene, std::span<const Contact> contacts, float dt, StepReport& report);
    void learn_times(const StepReport& report);
    // What the settings and the scene ask of a step:
    [[nodiscard]] bool picks_islands(const SceneCore& scene) const;
    [[nodiscard]] bool tells_blocks_apart(const SceneCore& scene) const;
    [[nodiscard]] FigureUse use_of_figures(const SceneCore& scene) const;
    [[nodiscard]] bool can_visit_patches_once(const SceneCore& scene) const;
    [[nodiscard]] bool anything_bounces(const SceneCore& scene) const;
};

Solver::Solver(const SolverSettings& settings, const SolverOptions& options)
{
    settings.validate();
    if (options.threads < 1 || options.threads > StageRunner::most_workers)
        refuse("SolverOptions.threads", options.threads, "1 to 1024");
    impl_ = std::make_unique<Impl>(settings, checked_isa(options.isa), options);
}

void SolverAccess::set_region(Solver& solver, RegionLink* region)
{
    solver.impl().discs.region = solver.impl().sleep.region = solver.impl().sweeper.region = region;
}

Solver::~Solver() = default;
Solver::Solver(Solver&&) noexcept = default;
Solver& Solver::operator=(Solver&&) noexcept = default;

Solver::Impl& Solver::impl() const
{
    if (!impl_) refuse("Solver", "moved from", "a solver that nobody has moved from");
    return *impl_;
}
const SolverSettings& Solver::settings() const
{
    return impl().asked;
}
void Solver::set_settings(const SolverSettings& settings)
{
    settings.validate();
    impl().asked = settings;
}
Isa Solver::isa() const
{
    return impl().isa;
}
int Solver::threads() const
{
    return impl().runner.workers();
}
Executor& Solver::executor()
{
    return *impl().runner.executor();
}

StepReport Solver::step(Scene& scene, float dt, std::span<const Contact> contacts) noexcept
{
    StepReport report;
    try {
        impl().step(scene, dt, contacts, report);
    } catch (...) {
        report.status = StepStatus::refused;
        report.error = text_of_exception();
    }
    return report;
}

void Solver::Impl::step(Scene& host_scene, float dt, std::span<const Contact> hosts, StepReport& report)
{
    SceneCore& scene = core_of(host_scene);
    const BusyFlag::Hold own(busy), scenes(scene.busy);
    if (!own.holds()) refuse("step", "called while the solver is in a step", "one step at a time");
    if (!scenes.holds()) refuse("step.scene", "in another step", "one step at a time");
    if (!(dt >= 0 && dt <= 1)) refuse("step.dt", dt, "0 to 1 (s)");
    if (hosts.size() > INT32_MAX)
        refuse("step.contacts.size()", static_cast<double>(hosts.size()), "at most 2^31 - 1");
    const auto began = std::chrono::steady_clock::now();
    pick_settings();
    const std::exception_ptr late = runner.with_workers(runs_alone(host_scene, hosts), [&] {
        StepClock clock(report);
        clock.enter(Stage::intake);
        if (scene.discs.wants_sorting) scene.sort_disc_rows();
        const std::span<const Contact> contacts = shapes.join(scene, hosts, dt);
        layout.intake.surfaces = shapes.surfaces();
        take_in(scene, contacts, report);
        if (report.error.empty()) report.error = ShapePipeline::wrong_key(scene, hosts);
        if (dt == 0 && report.error.empty()) report.error = ContactIntake::repeated_key(contacts);
        if (dt == 0 || !report.error.empty()) return clock.leave();
        clock.enter(Stage::colour);
        if (discs.region != nullptr) discs.region->renew_copies(scene);
        sleep.wake({scene, contacts, dt, settings});
        // Before the layout is cut, because people of other regions may come: see RegionLink.
        discs.find(scene, dt);
        lay_out(scene, contacts, report);
        if (!report.error.empty()) return clock.leave();
        discs.divide(scene);
        layout.list_discs(scene, tells_blocks_apart(scene));
        if (settings.exact_contacts) plan_runner.find_contact_islands(scene, dt);
        layout.point_at(scene, step_constants(settings, dt, scene.last_substep));
        plan_step(scene);
        clock.leave();
        if (settings.measures) report.measures.before = host_scene.errors();
        plan_runner.run(plan, figure_plan, {scene, contacts, dt, settings, picks_islands(scene), report},
                        clock);
        if (settings.measures) note_penetrations(scene, contacts, report.measures);
        finish(scene, contacts, dt, report);
        clock.leave();
        if (settings.measures) report.measures.after = host_scene.errors();
        learn_times(report);
    });
    if (!report.error.empty()) {
        report.status = StepStatus::refused;
        return;
    }
    report.error = text_of(late);
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - began;
    report.over_budget = asked.budget_ms > 0 && took.count() > static_cast<double>(asked.budget_ms);
}

/// Whether the caller runs the step alone: a small step, or the direct method, which runs on one thread for far
/// longer than other threads should spin.
bool Solver::Impl::runs_alone(const Scene& scene, std::span<const Contact> contacts) const
{
    return settings.method == Method::direct || size_of(scene, contacts) < alone_below;
}

/// The host's settings, with as much work as fits its time budget.
void Solver::Impl::pick_settings()
{
    settings = asked.resolved();
    if (asked.budget_ms == 0) return;
    int& work = asked.method == Method::soft_step ? settings.substeps : settings.iterations;
    work = budget.units_within(static_cast<double>(asked.budget_ms) * 1e-3, work);
}

void Solver::Impl::learn_times(const StepReport& report)
{
    if (asked.budget_ms == 0 || asked.method == Method::direct) return;
    double work = 0;
    // What is done once a step, whatever the settings, does not count as work.
    for (const Stage stage : {Stage::integrate_velocities, Stage::warm_start, Stage::solve,
                              Stage::integrate_positions, Stage::relax})
        work += report.seconds[static_cast<std::size_t>(stage)];
    budget.learn(report.total_seconds() - work, work,
                 asked.method == Method::soft_step ? settings.substeps : settings.iterations);
}

void Solver::Impl::take_in(SceneCore& scene, std::span<const Contact> contacts, StepReport& report)
{
    std::string error = pipeline.take_in(scene, contacts, settings.bad_contacts);
    if (settings.bad_contacts == BadContacts::refuse) {
        report.error = std::move(error);
    } else {
        report.contacts_skipped = layout.intake.bad_contacts();
        report.skipped_error = std::move(error);
    }
}

void Solver::Impl::lay_out(SceneCore& scene, std::span<const Contact> contacts, StepReport& report)
{
    scene.make_room_for_break_events();
    report.error = pipeline.lay_out(scene, contacts,
                                    {.figures = use_of_figures(scene),
                                     .tells_apart = tells_blocks_apart(scene),
                                     .adds_up = settings.substeps > 1});
    if (report.error.empty()) sweeper.make_room();
}

/// Plans what this step does, in which order, and what of it is fused.
void Solver::Impl::plan_step(const SceneCore& scene)
{
    const StepNeeds needs{.solves_trees = layout.figures.have_trees(),
                          .bounces = anything_bounces(scene),
                          .picks_islands = picks_islands(scene),
                          .measures = settings.tolerance > 0 || settings.measures || settings.budget_ms > 0};
    make_plan(settings, needs, plan);
    figure_plan = plan;
    if (settings.method == Method::direct) return;
    fuse_integrations(plan);
    if (layout.has_constant_responses()) replay_warm_starts(plan);
    if (can_visit_patches_once(scene)) visit_patches_once(plan);
}

/// After the bodies have moved: updates the scene and fills in the report.
void Solver::Impl::finish(SceneCore& scene, std::span<const Contact> contacts, float dt, StepReport& report)
{
    sleep.keep_loads(scene);
    scene.contacts.accept_staged();
    shapes.remember(scene);
    scene.last_substep = layout.context.step.substep;
    scene.last_step = dt;
    scene.find_break_events();
    sleep.fall_asleep({scene, contacts, dt, settings});
    report.bodies_asleep = static_cast<std::int64_t>(scene.bodies.sleepers);
    layout.report(report, sweeper.contacts_in_lockstep());
    report.shape_contacts = static_cast<std::int64_t>(shapes.found());
    report.substeps = settings.substeps;
}

bool Solver::Impl::anything_bounces(const SceneCore& scene) const
{
    bool any = layout.intake.bounces();
    scene.joints->for_each([&](const auto& store, int) {
        using Type = typename std::remove_cvref_t<decltype(store)>::Type;
        if constexpr (Type::has_restitution) any = any || store.size() > 0;
    });
    return any;
}

bool Solver::Impl::picks_islands(const SceneCore& scene) const
{
    return settings.tolerance > 0 || scene.asks_for_iterations();
}

/// Whether blocks have space for residuals and for the number of sweeps that their islands asked for.
bool Solver::Impl::tells_blocks_apart(const SceneCore& scene) const
{
    return picks_islands(scene) || settings.measures || settings.budget_ms > 0;
}

/// How this step may use figures: not at all with the direct method or where positions are projected, and not in
/// lockstep where blocks are told apart.
FigureUse Solver::Impl::use_of_figures(const SceneCore& scene) const
{
    const bool projects = settings.method == Method::sequential_impulse &&
                          settings.drift_correction == DriftCorrection::projection;
    const bool possible = settings.method != Method::direct && !projects;
    // Nor in lockstep with many sweeps: velocities of copies are not computed anew (Renewal).
    const bool in_lockstep = !tells_blocks_apart(scene) && !settings.exact_contacts &&
                             (settings.exact_joints || !PlanRunner::sweeps_long(settings));
    ExactFigures exact{.all = possible && settings.exact_joints};
    if (settings.method == Method::soft_step && !exact.all) exact.above_ratio = settings.exact_above_ratio;
    return {possible && in_lockstep, exact, exact.any() && holds_limits(settings)};
}

/// Whether visit_patches_once() may rewrite the plan. Not where residuals are measured, by island or of the whole
/// scene, nor with trees: both need all bodies solved before the first one is relaxed.
bool Solver::Impl::can_visit_patches_once(const SceneCore& scene) const
{
    return layout.intake.patches.are_wanted() && settings.method == Method::soft_step &&
           settings.relaxations > 0 && !settings.exact_contacts && !PlanRunner::sweeps_long(settings) &&
           !tells_blocks_apart(scene) && layout.figures.touched_trees().empty() && layout.disc_bands() == 0;
}

}  // namespace motley
