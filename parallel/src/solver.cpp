// One step, on one screen: Solver::Impl::step names the stages in their order, and does nothing else.
#include "motley/parallel/solver.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <new>
#include <utility>

#include "budget.h"
#include "convergence.h"
#include "layout.h"
#include "motley/core/invalid_input.h"
#include "motley/core/joint_store.h"
#include "motley/core/step_constants.h"
#include "motley/reference/scene_step.h"
#include "renewal.h"
#include "stage_runner.h"
#include "sweeper.h"
#include "tbb_executor.h"

namespace motley {
namespace {

/// What there is to do, in contacts: see SolverOptions::alone_below.
std::size_t size_of(const Scene& scene, std::span<const Contact> contacts)
{
    return contacts.size() + 4 * scene.joint_count() + scene.body_count() / 2;
}

Isa checked_isa(const std::optional<Isa>& wanted)
{
    if (!wanted) return default_isa();
    for (const Isa isa : available_isas()) {
        if (isa == *wanted) return isa;
    }
    refuse("SolverOptions.isa", isa_name(*wanted), "an instruction set of available_isas()");
}

/// What is being caught, in words; in few of them where there is no memory for more.
std::string text_of_exception() noexcept
{
    try {
        throw;
    } catch (const std::bad_alloc&) {
        return "out of memory";  // short enough to need none
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

/// Adds the time since the last call to a stage.
class StageClock {
  public:
    explicit StageClock(StepReport& report) : report_(report) {}
    void charge(Stage stage)
    {
        const auto now = std::chrono::steady_clock::now();
        report_.seconds[static_cast<std::size_t>(stage)] +=
            std::chrono::duration<double>(now - last_).count();
        last_ = now;
    }

  private:
    StepReport& report_;
    std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

void measure_start(const Scene& scene, std::span<const Contact> contacts, StepMeasures& measures)
{
    measures.before = scene.errors();
    double squares = 0;
    std::int64_t overlapping = 0;
    const ContactList& list = scene.contact_cache().staged();
    for (std::size_t i = 0; i < contacts.size(); ++i) {
        const Contact& contact = contacts[i];
        if (list.colours[i] == no_colour || contact.separation >= 0) continue;  // left out, or apart
        const auto depth = -static_cast<double>(contact.separation);
        squares += depth * depth;
        measures.penetration_max = std::max(measures.penetration_max, depth);
        ++overlapping;
    }
    if (overlapping > 0) measures.penetration_rms = std::sqrt(squares / static_cast<double>(overlapping));
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
    Sweeper sweeper;
    Convergence convergence;
    Renewal renewal;
    BusyFlag busy;

    Impl(const SolverSettings& s, Isa i, const SolverOptions& options)
        : asked(s),
          settings(s),
          isa(i),
          alone_below(options.alone_below),
          own_executor(options.executor ? nullptr : make_executor(options.threads)),
          runner(options.executor ? options.executor : own_executor.get()),
          layout(kernel_table(i)),
          sweeper(runner, layout),
          renewal(sweeper, layout)
    {
    }

    void step(Scene& scene, float dt, std::span<const Contact> contacts, StepReport& report);
    [[nodiscard]] bool runs_alone(const Scene& scene, std::span<const Contact> contacts) const;
    std::string take_in(Scene& scene, std::span<const Contact> contacts, StepReport& report);
    std::string lay_out(Scene& scene, std::span<const Contact> contacts);
    int iterate(ConstraintKernels::Sweep ConstraintKernels::*kernel, int iterations);
    [[nodiscard]] bool sweeps_long() const;
    void measure_residual(StepReport& report);
    [[nodiscard]] FigureSteps figure_steps() const;
    [[nodiscard]] FigureUse use_of_figures() const;
    [[nodiscard]] bool visits_patches_once() const;
    [[nodiscard]] bool anything_bounces(const Scene& scene) const;
    void move_bodies(Scene& scene, StepReport& report);
    void solve_substeps(Scene& scene, float dt, StepReport& report);
    void solve_directly(Scene& scene, float dt, std::span<const Contact> contacts, StepReport& report);
    void finish(Scene& scene, float dt, StepReport& report);
    void pick_settings();
    void learn_times(const StepReport& report);
    /// Whether blocks have room for residuals and wishes; and whether some of them are swept and others not.
    bool tells_blocks_apart = false, picks_blocks = false;
    void decide_on_blocks(const Scene& scene);
};

Solver::Solver(const SolverSettings& settings, const SolverOptions& options)
{
    settings.validate();
    if (options.threads < 1 || options.threads > StageRunner::most_workers)
        refuse("SolverOptions.threads", options.threads, "1 to 1024");
    impl_ = std::make_unique<Impl>(settings, checked_isa(options.isa), options);
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

void Solver::Impl::step(Scene& scene, float dt, std::span<const Contact> contacts, StepReport& report)
{
    const BusyFlag::Hold own(busy), scenes(scene.busy());
    if (!own.holds()) refuse("step", "called while the solver is in a step", "one step at a time");
    if (!scenes.holds()) refuse("step.scene", "in another step", "one step at a time");
    if (!(dt >= 0 && dt <= 1)) refuse("step.dt", dt, "0 to 1 (s)");
    if (contacts.size() > INT32_MAX)
        refuse("step.contacts.size()", static_cast<double>(contacts.size()), "at most 2^31 - 1");
    const auto began = std::chrono::steady_clock::now();
    pick_settings();
    const std::exception_ptr late = runner.with_workers(runs_alone(scene, contacts), [&] {
        StageClock clock(report);
        report.error = take_in(scene, contacts, report);
        clock.charge(Stage::intake);
        if (dt == 0 && report.error.empty()) report.error = ContactIntake::repeated_key(contacts);
        if (dt == 0 || !report.error.empty()) return;
        report.error = lay_out(scene, contacts);
        if (!report.error.empty()) return;
        layout.point_at(scene, step_constants(settings, dt, scene.last_substep));
        clock.charge(Stage::colour);
        if (settings.measures) measure_start(scene, contacts, report.measures);
        if (settings.method == Method::direct) {
            solve_directly(scene, dt, contacts, report);
        } else {
            solve_substeps(scene, dt, report);
        }
        if (settings.measures) report.measures.after = scene.errors();
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

/// Who solves directly does it on one thread, for far longer than others should wait for him awake.
bool Solver::Impl::runs_alone(const Scene& scene, std::span<const Contact> contacts) const
{
    return settings.method == Method::direct || size_of(scene, contacts) < alone_below;
}

void Solver::Impl::decide_on_blocks(const Scene& scene)
{
    picks_blocks = settings.tolerance > 0 || scene.asks_for_iterations();
    tells_blocks_apart = picks_blocks || settings.measures || settings.budget_ms > 0;
}

/// The host's settings, with as much work as its budget has room for.
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
    // What is done once a step whatever the settings is not work to be picked.
    for (const Stage stage : {Stage::integrate_velocities, Stage::warm_start, Stage::solve,
                              Stage::integrate_positions, Stage::relax})
        work += report.seconds[static_cast<std::size_t>(stage)];
    budget.learn(report.total_seconds() - work, work,
                 asked.method == Method::soft_step ? settings.substeps : settings.iterations);
}

/// The step as the data sees it.
void Solver::Impl::solve_substeps(Scene& scene, float dt, StepReport& report)
{
    const bool soft = settings.method == Method::soft_step;
    const bool projects = !soft && settings.drift_correction == DriftCorrection::projection;
    StageClock clock(report);

    if (picks_blocks) {
        convergence.find_islands(layout.context, layout.joint_placements(), layout.contact_placements(),
                                 layout.sweeps());
        convergence.take_wishes(scene, layout.sweeps());
    }
    sweeper.begin_free_groups();
    sweeper.transfer(&ConstraintKernels::prepare);
    if (layout.is_overloaded()) sweeper.sweep(&ConstraintKernels::stiffen);
    // Where nothing has to be known of all between them, a patch is solved, moved and relaxed at one visit.
    const int once = visits_patches_once() ? 1 : 0;
    if (once != 0) sweeper.list_beside_patches();
    clock.charge(Stage::prepare);
    sweeper.step_lone_figures(figure_steps());
    clock.charge(Stage::figures);
    const bool can_replay = layout.has_constant_responses();
    layout.context.replay = can_replay ? Replay::next_time : Replay::nothing;
    // Where nothing comes between, positions and the next velocities are one pass over the bodies.
    const bool relaxes = soft && settings.relaxations > 0;
    const bool runs_on = !projects && !relaxes;
    for (int substep = 0; substep < settings.substeps; ++substep) {
        const bool is_last = substep + 1 == settings.substeps;
        if (substep > 0) sweeper.add_up();
        if (substep == 0) {
            sweeper.integrate(&BodyKernels::begin_velocities);
        } else if (!runs_on) {
            sweeper.integrate(&BodyKernels::integrate_velocities);
        }
        clock.charge(Stage::integrate_velocities);
        // Where bodies relax, their trees have been factored after the last move: see step_figure().
        if (substep == 0 || !relaxes) sweeper.prepare_touched_trees();
        sweeper.begin_touched_trees();
        if (substep == 0 || !can_replay) sweeper.sweep(&ConstraintKernels::warm_start);
        if (can_replay) layout.context.replay = Replay::last_substep;
        sweeper.solve_touched_trees(layout.context.step.exact_rate);
        clock.charge(Stage::warm_start);
        const int iterations = iterate(&ConstraintKernels::solve, settings.iterations - once) + once;
        if (once != 0) {
            sweeper.sweep_across(&ConstraintKernels::solve);
            sweeper.visit_patches();
        }
        report.iterations = std::max(report.iterations, iterations);
        report.sweeps += iterations;
        if (is_last) measure_residual(report);
        clock.charge(Stage::solve);
        if (once != 0) {
            sweeper.move_beside_patches();
        } else {
            sweeper.integrate(runs_on && !is_last ? &BodyKernels::integrate_on
                                                  : &BodyKernels::integrate_positions);
        }
        for (int i = 0; projects && i < settings.projections; ++i) sweeper.sweep(&ConstraintKernels::project);
        clock.charge(Stage::integrate_positions);
        if (relaxes) sweeper.prepare_touched_trees();
        if (once != 0) sweeper.sweep_across(&ConstraintKernels::relax);
        if (soft) report.sweeps += once + iterate(&ConstraintKernels::relax, settings.relaxations - once);
        clock.charge(Stage::relax);
    }
    if (anything_bounces(scene)) sweeper.sweep(&ConstraintKernels::restitute);
    clock.charge(Stage::restitution);
    sweeper.add_up();
    sweeper.transfer(&ConstraintKernels::store);
    sweeper.land_free_groups();
    finish(scene, dt, report);
    report.substeps = settings.substeps;
    report.sweeps += settings.substeps * (1 + (projects ? settings.projections : 0));
    clock.charge(Stage::store);
}

/// The same step by the reference: it reads and writes the scene itself, and leaves the lanes alone.
void Solver::Impl::solve_directly(Scene& scene, float dt, std::span<const Contact> contacts,
                                  StepReport& report)
{
    StageClock clock(report);
    const reference::DirectResult result = reference::step_directly(scene, dt, settings, contacts);
    report.direct_violation = result.violation;
    report.direct_unsolved = result.unsolved;
    clock.charge(Stage::solve);
    finish(scene, dt, report);
    clock.charge(Stage::store);
}

void Solver::Impl::finish(Scene& scene, float dt, StepReport& report)
{
    move_bodies(scene, report);
    scene.contact_cache().accept_staged();
    scene.last_substep = layout.context.step.substep;
    scene.last_step = dt;
    scene.find_break_events();
    layout.report(report);
}

bool Solver::Impl::anything_bounces(const Scene& scene) const
{
    bool any = layout.intake.bounces();
    scene.joints().for_each([&](const auto& store, int) {
        using Type = typename std::remove_cvref_t<decltype(store)>::Type;
        if constexpr (Type::has_restitution) any = any || store.size() > 0;
    });
    return any;
}

std::string Solver::Impl::take_in(Scene& scene, std::span<const Contact> contacts, StepReport& report)
{
    ContactIntake& intake = layout.intake;
    const bool skips = settings.bad_contacts == BadContacts::skip;
    std::string error = intake.take_in(
        scene, contacts, skips, [&](std::int64_t count, const auto& chunk) { runner.run(count, chunk); });
    if (!skips) return error;
    report.contacts_skipped = intake.bad_contacts();
    report.skipped_error = std::move(error);
    return {};
}

std::string Solver::Impl::lay_out(Scene& scene, std::span<const Contact> contacts)
{
    decide_on_blocks(scene);
    scene.make_room_for_break_events();
    ContactCache& cache = scene.contact_cache();
    layout.begin(scene, contacts.size(), use_of_figures());
    // What only one thread can do is one chunk among those of whatever else is ready.
    runner.run(1 + cache.part_count(), [&](std::int64_t chunk) {
        if (chunk == 0) {
            layout.colour_contacts(scene.bodies(), cache.staged());
        } else {
            cache.verify(chunk - 1);
        }
    });
    if (cache.has_repeated_key()) return ContactIntake::repeated_key(contacts);
    runner.run(layout.contacts.chunk_count(), [&](std::int64_t chunk) { layout.count_contacts(chunk); });
    layout.contacts.open(layout.kernels(), settings.substeps > 1);
    runner.run(layout.contacts.chunk_count(), [&](std::int64_t chunk) { layout.contacts.fill(chunk); });
    layout.cut(scene, contacts, tells_blocks_apart);
    sweeper.make_room();
    return {};
}

/// Sweeps `iterations` times, or until every island is within the tolerance; longer where more was asked for. Returns how
/// many sweeps there were.
int Solver::Impl::iterate(ConstraintKernels::Sweep ConstraintKernels::*kernel, int iterations)
{
    const float rate = kernel == &ConstraintKernels::solve ? layout.context.step.exact_rate : 0;
    // Impulses of trees are not among those that a warm start applies.
    const bool renews = sweeps_long() && layout.figures.touched_trees().empty();
    if (renews) renewal.begin();
    const auto renew_after = [&](int done, int most) {
        if (renews && (done % Renewal::sweeps == 0 || done == most)) renewal.renew();
    };
    if (!picks_blocks) {
        for (int done = 1; done <= iterations; ++done) {
            sweeper.sweep(kernel);
            sweeper.solve_touched_trees(rate);
            renew_after(done, iterations);
        }
        return iterations;
    }
    convergence.start_over(layout.sweeps());
    // Wishes are for what solves, not for what relaxes.
    const int most =
        kernel == &ConstraintKernels::solve ? std::max(iterations, convergence.most_wanted()) : iterations;
    int done = 0;
    while (done < most && convergence.unfinished() > 0) {
        ++done;
        // Measuring costs about a sweep: early for what is nearly solved, then only now and then.
        const bool measured = settings.tolerance > 0 && (done == 2 || done % 4 == 0 || done == most);
        layout.context.measure = measured ? Measure::while_solving : Measure::nothing;
        sweeper.sweep(kernel, done <= iterations ? 0 : done);
        sweeper.solve_touched_trees(rate);
        if (measured) convergence.judge(layout.sweeps(), settings.tolerance);
        renew_after(done, most);
    }
    layout.context.measure = Measure::nothing;
    return done;
}

/// What is left of the constraints as the bodies are now.
void Solver::Impl::measure_residual(StepReport& report)
{
    if (settings.tolerance > 0) {
        report.islands = convergence.islands();
        report.islands_above_tolerance = convergence.unfinished();
    }
    if (!settings.measures && settings.budget_ms == 0) return;
    convergence.start_over(layout.sweeps());
    layout.context.measure = Measure::without_solving;
    sweeper.sweep(&ConstraintKernels::solve);
    layout.context.measure = Measure::nothing;
    const ResidualSum sum = sum_residuals(layout.sweeps());
    const auto constraints = static_cast<double>(std::max<std::int64_t>(1, sum.constraints));
    report.measures.residual_norm = std::sqrt(sum.energy);
    report.measures.residual_rms = std::sqrt(sum.squares / constraints);
    report.measures.residual_max = sum.largest;
}

/// Figures take part alone or not at all where blocks are told apart, and where positions are projected.
FigureUse Solver::Impl::use_of_figures() const
{
    const bool projects = settings.method == Method::sequential_impulse &&
                          settings.drift_correction == DriftCorrection::projection;
    const bool possible = settings.method != Method::direct && !projects;
    // Nor do copies have their velocities made anew.
    const bool in_lockstep = !tells_blocks_apart && (settings.exact_joints || !sweeps_long());
    return {possible && in_lockstep, possible && settings.exact_joints};
}

bool Solver::Impl::sweeps_long() const
{
    return std::max(settings.iterations, settings.relaxations) > Renewal::sweeps;
}

/// Measures, island by island or of all, want bodies as they are between solving and relaxing; so do trees.
bool Solver::Impl::visits_patches_once() const
{
    return layout.intake.patches.are_wanted() && settings.method == Method::soft_step &&
           settings.relaxations > 0 && !sweeps_long() && !tells_blocks_apart &&
           layout.figures.touched_trees().empty();
}

FigureSteps Solver::Impl::figure_steps() const
{
    return {settings.substeps, settings.iterations,
            settings.method == Method::soft_step ? settings.relaxations : 0};
}

void Solver::Impl::move_bodies(Scene& scene, StepReport& report)
{
    std::uint32_t first_slot = 0;
    report.bodies_contained = sweeper.commit(scene.bodies(), first_slot);
    if (layout.is_overloaded()) scene.bodies().restore_planar_inertia();
    if (report.bodies_contained == 0) return;
    report.first_contained = scene.bodies().id_of_slot(first_slot);
    scene.bodies().contained_count += static_cast<std::size_t>(report.bodies_contained);
    scene.joints().version.reset();  // theirs are left out from now on
}

}  // namespace motley
