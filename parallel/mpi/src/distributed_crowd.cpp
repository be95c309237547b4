// See distributed_crowd.h.
#include "motley/mpi/distributed_crowd.h"

#include <array>
#include <cstdio>
#include <numbers>
#include <unordered_set>
#include <vector>

#include "maths/hash.h"
#include "motley/core/invalid_input.h"
#include "region.h"
#include "solver_access.h"
#include "stores/joint_store.h"

namespace motley {
namespace {

/// Refuses settings that need to know all of a crowd at once, or that let the clock decide.
void check_region_settings(const SolverSettings& settings)
{
    if (settings.method == Method::direct)
        refuse("SolverSettings.method", "direct, of a crowd on several ranks", "another one");
    if (settings.tolerance > 0)
        refuse("SolverSettings.tolerance", settings.tolerance, "0 of a crowd on several ranks");
    if (settings.budget_ms > 0)
        refuse("SolverSettings.budget_ms", settings.budget_ms, "0 of a crowd on several ranks");
    if (settings.exact_contacts)
        refuse("SolverSettings.exact_contacts", "true, of a crowd on several ranks", "false");
}

/// What in a scene a region cannot have; empty: nothing.
const char* unfit_in(const Scene& scene)
{
    if (scene.joint_count() > 0) return "joints";
    if (core_of(scene).shapes.is_in_use()) return "capsules or half-spaces";
    if (core_of(scene).asks_for_iterations()) return "wishes of islands for more iterations";
    return "";
}

std::uint64_t hash_of(const SceneCore& scene, std::uint64_t number, BodyId body)
{
    const PersonState state = read_state(scene, body.slot);
    const Vec3<PoseReal>& at = state.pose.position;
    const std::array<PoseReal, 4> pose{at.x, at.y, at.z, state.pose.yaw};
    const std::uint64_t hash = hash_bytes(mix(0, number), pose.data(), pose.size());
    return hash_bytes(hash, state.velocity.data(), state.velocity.size());
}

MPI_Comm duplicate(MPI_Comm comm)
{
    MPI_Comm own = MPI_COMM_NULL;
    MPI_Comm_dup(comm, &own);
    return own;
}

}  // namespace

struct DistributedCrowd::Impl {
    Scene scene;
    Solver solver;
    Region region;

    Impl(MPI_Comm comm, const SolverSettings& settings, const SolverOptions& options)
        : solver(settings, options), region(duplicate(comm), scene)
    {
        SolverAccess::set_region(solver, &region);
    }
    [[nodiscard]] std::string refusal(float dt) const;
};

DistributedCrowd::DistributedCrowd(MPI_Comm comm, const SolverSettings& settings,
                                   const SolverOptions& options)
{
    settings.validate();
    check_region_settings(settings);
    impl_ = std::make_unique<Impl>(comm, settings, options);
}

DistributedCrowd::~DistributedCrowd()
{
    MPI_Comm comm = impl_->region.comm();
    MPI_Comm_free(&comm);
}

Scene& DistributedCrowd::scene()
{
    return impl_->scene;
}
const Scene& DistributedCrowd::scene() const
{
    return impl_->scene;
}

Executor& DistributedCrowd::executor()
{
    return impl_->solver.executor();
}

void DistributedCrowd::add_people(std::span<const std::uint64_t> numbers,
                                  std::span<const BodyDefinition> bodies,
                                  std::span<const DiscDefinition> discs)
{
    Region& region = impl_->region;
    if (bodies.size() != numbers.size())
        refuse("add_people.bodies.size()", static_cast<double>(bodies.size()), "the size of numbers");
    if (discs.size() != numbers.size())
        refuse("add_people.discs.size()", static_cast<double>(discs.size()), "the size of numbers");
    std::unordered_set<std::uint64_t> seen;
    for (const std::uint64_t number : numbers) {
        if (region.index_of.contains(number) || !seen.insert(number).second)
            refuse("add_people.numbers", static_cast<double>(number),
                   "numbers that nobody on this rank has, each once");
    }
    for (const BodyDefinition& body : bodies) {
        if (body.model != BodyModel::planar || body.motion != BodyMotion::dynamic_body)
            refuse("add_people.bodies", "a body that is not planar and dynamic", "planar, dynamic bodies");
    }
    std::vector<BodyId> added(bodies.size());
    impl_->scene.add_bodies(bodies, added);
    try {
        impl_->scene.set_discs(added, {discs.data(), discs.size()});
    } catch (...) {
        impl_->scene.remove_bodies(added);
        throw;
    }
    region.grow_with_slots();
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        core_of(impl_->scene).discs.numbers[added[i].slot] = numbers[i];
        region.index_of[numbers[i]] = static_cast<std::uint32_t>(region.people.size());
        region.people.push_back({numbers[i], added[i]});
    }
}

void DistributedCrowd::remove_people(std::span<const std::uint64_t> numbers)
{
    Region& region = impl_->region;
    std::vector<BodyId> removed;
    for (const std::uint64_t number : numbers) {
        const BodyId body = find(number);
        if (body == BodyId{})
            refuse("remove_people.numbers", static_cast<double>(number), "numbers of people of this rank");
        removed.push_back(body);
    }
    impl_->scene.remove_bodies(removed);  // refuses one that is named twice
    for (const std::uint64_t number : numbers) region.forget_person(number);
}

std::span<const OwnPerson> DistributedCrowd::people() const
{
    return impl_->region.people;
}

BodyId DistributedCrowd::find(std::uint64_t number) const
{
    const Region& region = impl_->region;
    const auto place = region.index_of.find(number);
    return place == region.index_of.end() ? BodyId{} : region.people[place->second].body;
}

/// Why a step is refused on all ranks; empty: it is not. Tells every rank what any of them has.
std::string DistributedCrowd::Impl::refusal(float dt) const
{
    const char* const unfit = unfit_in(scene);
    const bool is_fit = unfit[0] == '\0';
    std::array<double, 3> most{static_cast<double>(dt), -static_cast<double>(dt), is_fit ? 0.0 : 1.0};
    if (!(dt >= 0 && dt <= 1)) most = {2, 2, most[2]};
    MPI_Allreduce(MPI_IN_PLACE, most.data(), static_cast<int>(most.size()), MPI_DOUBLE, MPI_MAX,
                  region.comm());
    if (most[0] != -most[1])
        return most[0] == 2 ? "step.dt is out of range on some rank; valid: 0 to 1 (s)"
                            : "step.dt is not the same on all ranks; valid: one dt";
    if (most[2] == 0) return {};
    if (!is_fit) return std::string(unfit) + " are in the scene; a crowd on several ranks cannot have them";
    return "another rank has joints, capsules, half-spaces or wishes of islands for more iterations, which a "
           "crowd on several ranks cannot have";
}

StepReport DistributedCrowd::step(float dt)
{
    Region& region = impl_->region;
    StepReport report;
    report.error = impl_->refusal(dt);
    if (!report.error.empty()) {
        report.status = StepStatus::refused;
        return report;
    }
    region.begin_step();
    report = impl_->solver.step(impl_->scene, dt);
    if (report.status == StepStatus::refused && region.has_left_others_waiting()) {
        std::fprintf(stderr, "motley: a rank cannot go on, so all end: %s\n", report.error.c_str());
        MPI_Abort(region.comm(), 1);
    }
    if (report.status != StepStatus::refused) ++region.figures.steps;
    report.bodies_asleep = region.people_asleep(core_of(impl_->scene));
    return report;
}

void DistributedCrowd::save(const std::string& path)
{
    impl_->region.save(path);
}
void DistributedCrowd::load(const std::string& path)
{
    impl_->region.load(path);
}

std::vector<BodyLoad> DistributedCrowd::read_loads() const
{
    const SceneCore& scene = core_of(impl_->scene);
    std::vector<Borne> borne(scene.bodies.slot_count());
    impl_->region.bear_from_below(scene, borne);
    scene.bear_disc_impulses(borne);
    std::vector<BodyLoad> loads;
    for (const OwnPerson& person : impl_->region.people) {
        const float radius = scene.discs.shapes[person.body.slot].radius;
        loads.push_back(scene.load_of(borne[person.body.slot], 2 * std::numbers::pi_v<float> * radius));
    }
    return loads;
}

std::uint64_t DistributedCrowd::hash() const
{
    std::uint64_t sum = 0;
    for (const OwnPerson& person : impl_->region.people)
        sum += hash_of(core_of(impl_->scene), person.number, person.body);
    MPI_Allreduce(MPI_IN_PLACE, &sum, 1, MPI_UINT64_T, MPI_SUM, impl_->region.comm());
    return sum;
}

DistributedFigures DistributedCrowd::figures() const
{
    DistributedFigures figures = impl_->region.figures;
    figures.people = static_cast<std::int64_t>(impl_->region.people.size());
    return figures;
}

std::uint64_t people_hash(const Scene& scene, std::span<const std::uint64_t> numbers,
                          std::span<const BodyId> bodies)
{
    if (numbers.size() != bodies.size())
        refuse("people_hash.numbers.size()", static_cast<double>(numbers.size()), "the size of bodies");
    core_of(scene).require_alive(bodies, "people_hash.bodies");
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < bodies.size(); ++i) sum += hash_of(core_of(scene), numbers[i], bodies[i]);
    return sum;
}

}  // namespace motley
