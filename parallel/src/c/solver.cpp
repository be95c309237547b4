// Solvers and steps of the C interface.
#include "motley/c/solver.h"

#include <memory>
#include <type_traits>
#include <utility>

#include "host_executor.h"
#include "joint_reports.h"
#include "motley/core/snapshot.h"
#include "motley/parallel/solver.h"
#include "solver_mirrors.h"

struct motley_solver {
    std::unique_ptr<motley::c::HostExecutor> executor;  ///< null where the host lends no threads
    motley::Solver solver;
};

namespace motley::c {

/// What motley_solver_options say: SolverOptions leave the instruction set open in another way, and own no executor.
struct HostOptions {
    int threads = SolverOptions{}.threads;
    motley_isa isa = MOTLEY_ISA_DEFAULT;
    std::size_t alone_below = SolverOptions{}.alone_below;
    const motley_executor* executor = nullptr;
};

template <>
struct Mirror<motley_solver_options, HostOptions> : Pair<motley_solver_options, HostOptions> {
    static constexpr const char* name = "motley_solver_options";
    static constexpr auto fields = std::tuple(MOTLEY_FIELD(threads), MOTLEY_FIELD(isa),
                                              MOTLEY_FIELD(alone_below), MOTLEY_FIELD(executor));
};

namespace {

Solver& solver_of(motley_solver* solver)
{
    return need(solver, "solver").solver;
}
const Solver& solver_of(const motley_solver* solver)
{
    return need(solver, "solver").solver;
}

std::span<const Contact> contacts_of(const motley_contact* contacts, std::size_t count)
{
    static_assert(same_layout<motley_contact, Contact>());
    return array<const Contact>(contacts, count, "contacts");
}

SolverSettings settings_or_default(const motley_solver_settings* settings)
{
    return settings == nullptr ? SolverSettings{} : read<SolverSettings>(settings, "settings");
}

std::unique_ptr<motley_solver> make_solver(const SolverSettings& settings, const HostOptions& host)
{
    SolverOptions options{.threads = host.threads, .alone_below = host.alone_below};
    if (host.isa < MOTLEY_ISA_DEFAULT || host.isa > MOTLEY_ISA_NEON)
        refuse("motley_solver_options.isa", host.isa, "-1 to 4");
    if (host.isa != MOTLEY_ISA_DEFAULT) options.isa = static_cast<Isa>(host.isa);
    std::unique_ptr<HostExecutor> executor;
    if (host.executor != nullptr)
        executor = std::make_unique<HostExecutor>(read<HostThreads>(host.executor, "options->executor"));
    options.executor = executor.get();
    Solver solver(settings, options);
    return std::unique_ptr<motley_solver>(new motley_solver{std::move(executor), std::move(solver)});
}

/// Writes as much of a report as the host knows.
void give_report(const StepReport& report, motley_step_report& to)
{
    motley_step_report full{};
    give_fields(report, full);
    full.struct_size = to.struct_size;
    full.refused = report.status == StepStatus::refused ? 1 : 0;
    give_known(full, to);
}

}  // namespace
}  // namespace motley::c

using namespace motley;
using namespace motley::c;

MOTLEY_DEFINE_DEFAULT(solver_settings, SolverSettings)
MOTLEY_DEFINE_DEFAULT(executor, HostThreads)
MOTLEY_DEFINE_DEFAULT(solver_options, HostOptions)
MOTLEY_DEFINE_DEFAULT(step_report, StepReport)

motley_status motley_job_run(motley_job* job, int32_t worker)
{
    return call(__func__, [&] {
        motley_job& of = need(job, "job");
        if (worker < 0 || worker >= of.workers)
            refuse("worker", worker, "0 to " + std::to_string(of.workers - 1));
        const std::uint64_t bit = std::uint64_t{1} << (worker % 64);
        if ((of.begun[static_cast<std::size_t>(worker) / 64].fetch_or(bit) & bit) != 0)
            refuse("worker", worker, "one that has not been run");
        of.work(worker);
    });
}

const char* motley_stage_name(int32_t stage)
{
    return stage >= 0 && stage < stage_count ? stage_name(static_cast<Stage>(stage)) : nullptr;
}

motley_status motley_solver_create(const motley_solver_settings* settings,
                                   const motley_solver_options* options, motley_solver** solver)
{
    return call(__func__, [&] {
        motley_solver*& to = need(solver, "solver");
        const HostOptions host = options == nullptr ? HostOptions{} : read<HostOptions>(options, "options");
        to = make_solver(settings_or_default(settings), host).release();
    });
}

void motley_solver_destroy(motley_solver* solver)
{
    delete solver;
}

motley_status motley_solver_step(motley_solver* solver, motley_scene* scene, float dt, size_t contact_count,
                                 const motley_contact* contacts, motley_step_report* report)
{
    return call(__func__, [&] {
        if (report != nullptr) check_size<motley_step_report>(report->struct_size, "motley_step_report");
        const StepReport did =
            solver_of(solver).step(scene_of(scene), dt, contacts_of(contacts, contact_count));
        if (report != nullptr) give_report(did, *report);
        if (did.status == StepStatus::refused) throw InvalidInput(did.error);
    });
}

motley_status motley_solver_read_settings(const motley_solver* solver, motley_solver_settings* settings)
{
    return call(__func__, [&] {
        motley_solver_settings& to = need(settings, "settings");
        check_size<motley_solver_settings>(to.struct_size, "motley_solver_settings");
        motley_solver_settings full{};
        give_fields(solver_of(solver).settings(), full);
        full.struct_size = to.struct_size;
        give_known(full, to);
    });
}

motley_status motley_solver_set_settings(motley_solver* solver, const motley_solver_settings* settings)
{
    return call(__func__,
                [&] { solver_of(solver).set_settings(read<SolverSettings>(settings, "settings")); });
}

motley_status motley_solver_isa(const motley_solver* solver, motley_isa* isa)
{
    return call(__func__, [&] { need(isa, "isa") = static_cast<motley_isa>(solver_of(solver).isa()); });
}

motley_status motley_solver_threads(const motley_solver* solver, int32_t* threads)
{
    return call(__func__, [&] { need(threads, "threads") = solver_of(solver).threads(); });
}

motley_status motley_scene_contact_impulses(const motley_scene* scene,
                                            const motley_contact_impulse** impulses, size_t* count)
{
    return call(__func__,
                [&] { give_view(scene_of(scene).contact_impulses(), impulses, "impulses", count); });
}

motley_status motley_scene_last_substep_impulses(const motley_scene* scene,
                                                 const motley_contact_impulse** impulses, size_t* count)
{
    return call(__func__,
                [&] { give_view(scene_of(scene).last_substep_impulses(), impulses, "impulses", count); });
}

motley_status motley_scene_contact_report(const motley_scene* scene, size_t contact_count,
                                          const motley_contact* contacts, size_t index,
                                          motley_joint_report* report)
{
    return call(__func__, [&] {
        need(report, "report") = as<motley_joint_report>(
            scene_of(scene).contact_report(contacts_of(contacts, contact_count), index));
    });
}

motley_status motley_scene_read_loads(const motley_scene* scene, size_t count, const motley_body_id* bodies,
                                      size_t contact_count, const motley_contact* contacts,
                                      motley_body_load* loads, size_t load_stride,
                                      const float* circumferences, size_t circumference_stride)
{
    return call(__func__, [&] {
        static_assert(same_layout<motley_body_load, BodyLoad>());
        scene_of(scene).read_loads(
            bodies_of(bodies, count), contacts_of(contacts, contact_count),
            strided<BodyLoad>(loads, count, load_stride, "loads"),
            strided_or_none<const float>(circumferences, count, circumference_stride, "circumferences"));
    });
}

motley_status motley_save_problem(const motley_scene* scene, const motley_solver_settings* settings, float dt,
                                  size_t contact_count, const motley_contact* contacts, const char* file)
{
    return call_on_file(__func__, [&] {
        const auto list = contacts_of(contacts, contact_count);
        const StepProblem problem{
            scene_of(scene), read<SolverSettings>(settings, "settings"), dt, {list.begin(), list.end()}};
        save_problem(problem, std::string(&need(file, "file")));
    });
}
