// See distributed_run.h.
#include "commands/distributed_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "measuring/clock.h"
#include "measuring/median.h"
#include "motley/mpi/distributed_crowd.h"
#include "worlds/scenes/open_crowd_people.h"

namespace motley::bench {
namespace {

/// A goal as the 64 bits that cross with a person.
std::uint64_t pack(const Vec2<double>& goal)
{
    const float parts[2] = {static_cast<float>(goal.x), static_cast<float>(goal.y)};
    std::uint64_t bits = 0;
    std::memcpy(&bits, parts, sizeof bits);
    return bits;
}
Vec2<double> unpack(std::uint64_t bits)
{
    float parts[2];
    std::memcpy(parts, &bits, sizeof bits);
    return {static_cast<double>(parts[0]), static_cast<double>(parts[1])};
}

/// The open crowd on this rank and all others.
class DistributedOpenCrowd {
  public:
    DistributedOpenCrowd(const RunOptions& options, int rank, int ranks)
        : crowd(MPI_COMM_WORLD, options.settings, options.solver), who_(options)
    {
        const double side = who_.side;
        const std::vector<std::vector<Vec2<double>>> walls{
            {{0, 0}, {side, 0}}, {{side, 0}, {side, side}}, {{side, side}, {0, side}}, {{0, side}, {0, 0}}};
        for (const std::vector<Vec2<double>>& wall : walls)
            crowd.scene().add_wall({.points = wall, .friction = friction_of(options)});
        // Each rank brings its share of the numbers; the first step takes them to the ranks of their places.
        const auto share = [&](int of) {
            return who_.count * static_cast<std::size_t>(of) / static_cast<std::size_t>(ranks);
        };
        std::vector<std::uint64_t> numbers;
        std::vector<BodyDefinition> bodies;
        std::vector<DiscDefinition> discs;
        for (std::size_t number = share(rank); number < share(rank + 1); ++number) {
            const Agent agent = who_.person(number);
            const Vec2<double> at = who_.start_of(number);
            BodyDefinition body;
            body.model = BodyModel::planar;
            body.position = {at.x, at.y, 0};
            body.mass = agent.mass;
            body.inertia.zz = 0.5F * agent.mass * agent.radius * agent.radius;
            numbers.push_back(number);
            bodies.push_back(body);
            discs.push_back({.radius = agent.radius, .friction = friction_of(options)});
        }
        crowd.add_people(numbers, bodies, discs);
        for (std::size_t i = 0; i < numbers.size(); ++i)
            crowd.scene().set_user_data(crowd.find(numbers[i]), pack(who_.person(numbers[i]).goal));
        note_people();
    }

    DistributedCrowd crowd;

    void steer(std::int64_t step)
    {
        // People move to other ranks, and their rows, at a search.
        if (searches_ != crowd.figures().searches) note_people();
        positions_.resize(bodies_.size());
        velocities_.resize(bodies_.size());
        forces_.resize(bodies_.size());
        Scene& scene = crowd.scene();
        parallel_for(crowd.executor(), static_cast<std::int64_t>(bodies_.size()), 1024,
                     [&](std::int64_t begin, std::int64_t end) {
                         const auto first = static_cast<std::size_t>(begin),
                                    count = static_cast<std::size_t>(end - begin);
                         const auto some = std::span<const BodyId>(bodies_).subspan(first, count);
                         scene.read_positions(some, std::span(positions_).subspan(first, count));
                         scene.read_velocities(some, std::span(velocities_).subspan(first, count));
                         Agent agent;
                         for (std::size_t i = first; i < first + count; ++i) {
                             agent.goal = goals_[i];
                             forces_[i] =
                                 walking_force(agent, relaxation_time, positions_[i], velocities_[i]);
                         }
                         scene.set_forces(some, std::span<const Vec3<float>>(forces_).subspan(first, count));
                     });
        for (std::size_t i = 0; i < bodies_.size(); ++i) {
            const std::uint64_t number = numbers_[i];
            if (!OpenCrowdPeople::looks(number, step) ||
                !OpenCrowdPeople::has_reached(goals_[i], positions_[i]))
                continue;
            goals_[i] = who_.next_goal(number, positions_[i], step);
            scene.set_user_data(bodies_[i], pack(goals_[i]));
        }
    }

  private:
    static constexpr float relaxation_time = 0.5F;  // s, as Crowd's
    OpenCrowdPeople who_;
    std::int64_t searches_ = 0;
    std::vector<std::uint64_t> numbers_;
    std::vector<BodyId> bodies_;
    std::vector<Vec2<double>> goals_;
    std::vector<Vec3<double>> positions_;
    std::vector<Vec3<float>> velocities_, forces_;

    static float friction_of(const RunOptions& options)
    {
        return options.friction < 0 ? 0 : options.friction;
    }
    void note_people()
    {
        searches_ = crowd.figures().searches;
        numbers_.clear();
        bodies_.clear();
        goals_.clear();
        for (const OwnPerson& person : crowd.people()) {
            numbers_.push_back(person.number);
            bodies_.push_back(person.body);
            goals_.push_back(unpack(crowd.scene().user_data(person.body)));
        }
    }
};

double reduce(double value, MPI_Op operation)
{
    MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_DOUBLE, operation, MPI_COMM_WORLD);
    return value;
}

const char* refusal_of(const std::string& scene, const RunOptions& options, const RunOutputs& outputs)
{
    if (scene != "crowd") return "only the scene `crowd` runs on several ranks";
    if (options.lists_contacts || options.direct_every > 0 || options.settings.measures)
        return "--listed, --measures and --direct-every need all people in one process";
    if (options.steering != SteeringModel::plain || options.torsos)
        return "on several ranks people are discs with plain steering";
    if (!outputs.trajectories.empty() || !outputs.frames.empty() || !outputs.recording.empty() ||
        !outputs.problem.empty() || outputs.densities)
        return "--trajectories, --frames, --record and --densities need all people in one process";
    return nullptr;
}

/// What a run was, in the order in which it is printed: name, value, format.
struct Line {
    const char* name;
    const char* key;
    double value;
    int digits;
};

}  // namespace

bool is_started_by_mpi()
{
    for (const char* const name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "PMIX_RANK"}) {
        if (std::getenv(name) != nullptr) return true;
    }
    return false;
}

int run_distributed(const std::string& scene, RunOptions options, const RunOutputs& outputs,
                    const std::string& json)
{
    int threads_allowed = 0, rank = 0, ranks = 1;
    MPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &threads_allowed);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, &ranks);
    int code = 0;
    if (const char* const refused = refusal_of(scene, options, outputs)) {
        if (rank == 0) fmt::print(stderr, "motley: {}\n", refused);
        MPI_Finalize();
        return 2;
    }
    if (options.agents == 0) options.agents = 10000;
    if (options.seconds == 0) options.seconds = 10;
    {
        DistributedOpenCrowd all(options, rank, ranks);
        const auto steps =
            static_cast<std::int64_t>(std::ceil(options.seconds / static_cast<double>(options.dt)));
        std::vector<double> step_seconds, solver_seconds;
        double worst = 0;  // people of the fullest rank, as a share of the mean
        for (std::int64_t step = 0; step < steps && code == 0; ++step) {
            const double began = now();
            all.steer(step);
            const double steered = now();
            const StepReport report = all.crowd.step(options.dt);
            const double ended = now();
            if (report.status != StepStatus::done) {
                if (rank == 0) fmt::print(stderr, "motley: step {} refused: {}\n", step, report.error);
                code = 1;
                break;
            }
            step_seconds.push_back(ended - began);
            solver_seconds.push_back(ended - steered);
            worst = std::max(worst, reduce(static_cast<double>(all.crowd.people().size()), MPI_MAX));
            if (outputs.hash_every > 0 && (step + 1) % outputs.hash_every == 0) {
                const std::uint64_t hash = all.crowd.hash();
                if (rank == 0) fmt::print("step {} hash {:016x}\n", step + 1, hash);
            }
            if (outputs.progress && rank == 0 && step * 4 / steps != (step + 1) * 4 / steps)
                fmt::print(stderr, "crowd: {} %\n", 25 * ((step + 1) * 4 / steps));
        }
        if (code == 0) {
            // The first step allocates, and brings everybody to the right rank.
            const auto typical = [](std::vector<double> seconds) {
                if (seconds.size() > 1) seconds.erase(seconds.begin());
                return median(seconds);
            };
            const DistributedFigures own = all.crowd.figures();
            const double count = static_cast<double>(steps), people = static_cast<double>(options.agents);
            const double whole = reduce(typical(step_seconds), MPI_MAX),
                         solver = reduce(typical(solver_seconds), MPI_MAX);
            double total = 0, after_first = 0;
            for (const double seconds : solver_seconds) total += seconds;
            if (steps > 1) after_first = total - solver_seconds.front();
            const double all_ranks = reduce(total, MPI_SUM);
            const double slowest = reduce(steps > 1 ? after_first / (count - 1) : total, MPI_MAX);
            const double pushed = reduce(static_cast<double>(own.pushed), MPI_SUM);
            const double bytes = reduce(static_cast<double>(own.bytes), MPI_SUM) / count;
            const std::uint64_t hash = all.crowd.hash();
            const std::vector<Line> lines{
                {"people", "people", people, 0},
                {"people of the fullest rank / mean, most", "fullest_over_mean", worst * ranks / people, 3},
                {"agent-steps/s, solver alone (M)", "solver_agent_steps_per_second_M",
                 1e-6 * people / slowest, 3},
                {"whole step, median (ms)", "whole_step_ms", 1e3 * whole, 3},
                {"solver, median (ms)", "solver_step_ms", 1e3 * solver, 3},
                {"messages of sweeps (% of the solver's time)", "sweep_message_percent",
                 100 * reduce(own.seconds_sweeping, MPI_SUM) / all_ranks, 2},
                {"all other messages (% of the solver's time)", "other_message_percent",
                 100 * reduce(own.seconds_agreeing, MPI_SUM) / all_ranks, 2},
                {"searches that dealt out the plane (per step)", "searches_per_step",
                 static_cast<double>(own.searches) / count, 3},
                {"people who changed rank (per step)", "crossings_per_step",
                 reduce(static_cast<double>(own.crossings), MPI_SUM) / count, 1},
                {"people pushed across a border, last search", "pushed_across_borders", pushed, 0},
                {"bytes to neighbours (per step)", "neighbour_bytes_per_step", bytes, 0},
                {"bytes to neighbours per person pushed across a border (per step)",
                 "neighbour_bytes_per_pushed_person", pushed > 0 ? bytes / pushed : 0, 0},
                {"bytes of people who moved (per step)", "moved_bytes_per_step",
                 reduce(static_cast<double>(own.moved_bytes), MPI_SUM) / count, 0}};
            if (rank == 0) {
                fmt::print("crowd: {} rank{} of {} thread{}, {} steps\n", ranks, ranks == 1 ? "" : "s",
                           options.solver.threads, options.solver.threads == 1 ? "" : "s", steps);
                for (const Line& line : lines)
                    fmt::print("  {:<66}{:.{}f}\n", line.name, line.value, line.digits);
                fmt::print("  {:<66}{:016x}\n", "people hash", hash);
                if (!json.empty()) {
                    nlohmann::ordered_json out{{"scene", scene},
                                               {"ranks", ranks},
                                               {"threads", options.solver.threads},
                                               {"steps", steps}};
                    for (const Line& line : lines) out[line.key] = line.value;
                    out["people_hash"] = fmt::format("{:016x}", hash);
                    std::ofstream file(json);
                    file << out.dump(2) << '\n';
                    file.close();
                    if (!file) {
                        fmt::print(stderr, "motley: {}: cannot be written\n", json);
                        code = 1;
                    }
                }
            }
        }
    }
    MPI_Finalize();
    return code;
}

}  // namespace motley::bench
