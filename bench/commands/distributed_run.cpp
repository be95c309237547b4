// See distributed_run.h.
#include "commands/distributed_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "commands/distributed_frames.h"
#include "commands/distributed_trajectories.h"
#include "commands/distributed_view.h"
#include "measuring/clock.h"
#include "measuring/median.h"
#include "motley/mpi/distributed_crowd.h"
#include "recording/recording.h"
#include "worlds/density.h"
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
    /// Goes on from the checkpoint `restart`, if that is not empty.
    DistributedOpenCrowd(const RunOptions& options, const std::string& restart, int rank, int ranks)
        : crowd(MPI_COMM_WORLD, options.settings, options.solver), who_(options)
    {
        for (const Wall& wall : who_.walls()) {
            const std::array<Vec2<double>, 2> ends{wall.from, wall.to};
            walls_.push_back(crowd.scene().add_wall({.points = ends, .friction = who_.friction}));
        }
        if (restart.empty()) {
            add_share(rank, ranks);
        } else {
            crowd.load(restart);
        }
        note_people();
    }

    DistributedCrowd crowd;

    [[nodiscard]] const OpenCrowdPeople& who() const { return who_; }
    [[nodiscard]] std::span<const WallId> walls() const { return walls_; }

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
                             forces_[i] = walking_force(agent, Crowd::default_relaxation_time, positions_[i],
                                                        velocities_[i]);
                         }
                         scene.set_forces(some, std::span<const Vec3<float>>(forces_).subspan(first, count));
                     });
        for (std::size_t i = 0; i < bodies_.size(); ++i) {
            const std::uint64_t number = numbers_[i];
            if (number % OpenCrowdPeople::one_in != OpenCrowdPeople::first_to_look(step) ||
                !OpenCrowdPeople::has_reached(goals_[i], positions_[i]))
                continue;
            goals_[i] = who_.next_goal(number, positions_[i], step);
            scene.set_user_data(bodies_[i], pack(goals_[i]));
        }
    }

  private:
    /// Each rank brings its share of the numbers; the first step takes them to the ranks of their places.
    void add_share(int rank, int ranks)
    {
        const auto share = [&](int of) {
            return who_.count * static_cast<std::size_t>(of) / static_cast<std::size_t>(ranks);
        };
        std::vector<std::uint64_t> numbers;
        std::vector<BodyDefinition> bodies;
        std::vector<DiscDefinition> discs;
        for (std::size_t number = share(rank); number < share(rank + 1); ++number) {
            const Agent agent = who_.person(number);
            numbers.push_back(number);
            bodies.push_back(body_of(agent, who_.start_of(number)));
            discs.push_back({.radius = agent.radius, .friction = who_.friction});
        }
        crowd.add_people(numbers, bodies, discs);
        for (std::size_t i = 0; i < numbers.size(); ++i)
            crowd.scene().set_user_data(crowd.find(numbers[i]), pack(who_.person(numbers[i]).goal));
    }

    OpenCrowdPeople who_;
    std::vector<WallId> walls_;
    std::int64_t searches_ = 0;
    std::vector<std::uint64_t> numbers_;
    std::vector<BodyId> bodies_;
    std::vector<Vec2<double>> goals_;
    std::vector<Vec3<double>> positions_;
    std::vector<Vec3<float>> velocities_, forces_;

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

const char* refusal_of(const std::string& scene, const RunOptions& options)
{
    if (scene != "crowd") return "only the scene `crowd` runs on several ranks";
    if (options.lists_contacts || options.direct_every > 0 || options.settings.measures)
        return "--listed, --measures and --direct-every need all people in one process";
    if (options.steering != SteeringModel::plain || options.torsos)
        return "on several ranks people are discs with plain steering";
    return nullptr;
}

/// A line of the table of a run, and its key in JSON.
struct Line {
    const char* name;
    const char* key;
    double value;
    int digits;
};

/// What this rank has measured.
struct Measured {
    std::int64_t steps = 0;
    std::vector<double> step_seconds, solver_seconds;
    double fullest = 0;  ///< most people of a rank in any step
};

std::vector<Line> lines_of(const Measured& run, const DistributedFigures& own, double people, int ranks)
{
    // The first step allocates, and brings everybody to the right rank.
    const auto later = [](std::vector<double> seconds) {
        if (seconds.size() > 1) seconds.erase(seconds.begin());
        return seconds;
    };
    const std::vector<double> steps = later(run.step_seconds), solver = later(run.solver_seconds);
    const double total = std::accumulate(solver.begin(), solver.end(), 0.0);
    const double mean = reduce(total / static_cast<double>(solver.size()), MPI_MAX);
    const double all_ranks =
        reduce(std::accumulate(run.solver_seconds.begin(), run.solver_seconds.end(), 0.0), MPI_SUM);
    const auto count = static_cast<double>(run.steps);
    const double pushed = reduce(static_cast<double>(own.pushed), MPI_SUM);
    const double bytes = reduce(static_cast<double>(own.bytes), MPI_SUM) / count;
    return {{"people", "people", people, 0},
            {"people of the fullest rank / mean, most", "fullest_over_mean", run.fullest * ranks / people, 3},
            {"agent-steps/s, solver alone (M)", "solver_agent_steps_per_second_M", 1e-6 * people / mean, 3},
            {"whole step, median (ms)", "whole_step_ms", 1e3 * reduce(median(steps), MPI_MAX), 3},
            {"solver, median (ms)", "solver_step_ms", 1e3 * reduce(median(solver), MPI_MAX), 3},
            {"messages of sweeps (% of the solver's time)", "sweep_message_percent",
             100 * reduce(own.seconds_sweeping, MPI_SUM) / all_ranks, 2},
            {"all other messages (% of the solver's time)", "other_message_percent",
             100 * reduce(own.seconds_agreeing, MPI_SUM) / all_ranks, 2},
            {"searches that dealt out the plane (per step)", "searches_per_step",
             static_cast<double>(own.searches) / count, 3},
            {"people who changed rank (per step)", "crossings_per_step",
             reduce(static_cast<double>(own.crossings), MPI_SUM) / count, 1},
            {"people pushed across a border, last search", "pushed_across_borders", pushed, 0},
            {"messages to neighbours (per step)", "neighbour_messages_per_step",
             reduce(static_cast<double>(own.messages), MPI_SUM) / count, 1},
            {"bytes to neighbours (per step)", "neighbour_bytes_per_step", bytes, 0},
            {"bytes to neighbours per person pushed across a border (per step)",
             "neighbour_bytes_per_pushed_person", pushed > 0 ? bytes / pushed : 0, 0},
            {"bytes of people who moved (per step)", "moved_bytes_per_step",
             reduce(static_cast<double>(own.moved_bytes), MPI_SUM) / count, 0}};
}

void print(const std::vector<Line>& lines, std::uint64_t hash, int ranks, int threads, std::int64_t steps)
{
    fmt::print("crowd: {} rank{} of {} thread{}, {} steps\n", ranks, ranks == 1 ? "" : "s", threads,
               threads == 1 ? "" : "s", steps);
    for (const Line& line : lines) fmt::print("  {:<66}{:.{}f}\n", line.name, line.value, line.digits);
    fmt::print("  {:<66}{:016x}\n", "people hash", hash);
}

void write_json(const std::string& path, const std::vector<Line>& lines, const std::vector<Figure>& figures,
                std::uint64_t hash, int ranks, int threads, std::int64_t steps)
{
    nlohmann::ordered_json out{{"scene", "crowd"}, {"ranks", ranks}, {"threads", threads}, {"steps", steps}};
    for (const Line& line : lines) out[line.key] = line.value;
    for (const auto& [name, value] : figures) out["figures"][name] = value;
    out["people_hash"] = fmt::format("{:016x}", hash);
    std::ofstream file(path);
    file << out.dump(2) << '\n';
    file.close();
    if (!file) throw std::runtime_error(path + ": cannot be written");
}

/// Throws on all ranks alike, or ends them all.
void run_crowd(const RunOptions& options, const RunOutputs& outputs, const Checkpoints& checkpoints,
               const std::string& json, int rank, int ranks)
{
    DistributedOpenCrowd all(options, checkpoints.restart, rank, ranks);
    const auto last = static_cast<std::int64_t>(std::ceil(options.seconds / static_cast<double>(options.dt)));
    std::optional<DistributedTrajectories> trajectories;
    if (!outputs.trajectories.empty())
        trajectories.emplace(outputs.trajectories, 1 / static_cast<double>(options.dt));
    std::optional<DistributedFrames> frames;
    if (!outputs.frames.empty()) frames.emplace(outputs);
    std::optional<RecordingWriter> recording;  // on rank 0
    const bool is_recorded = !outputs.recording.empty();
    if (is_recorded) {
        try_on_all([&] {
            if (rank == 0)
                recording.emplace(outputs.recording, "crowd",
                                  outputs.record_every * static_cast<double>(options.dt));
        });
    }
    DistributedView view(all.who(), all.walls());
    Measured run;
    for (std::int64_t step = all.crowd.figures().steps; step < last; ++step) {
        // As one process does, from where people are when the step begins.
        if (trajectories) trajectories->write(all.crowd, step);
        const bool draws = frames && step % outputs.frame_every == 0;
        const bool records = is_recorded && step % outputs.record_every == 0;
        if (draws || records) view.note_places(all.crowd);
        const double began = now();
        all.steer(step);
        const double steered = now();
        const StepReport report = all.crowd.step(options.dt);
        const double ended = now();
        if (report.status != StepStatus::done)
            throw std::runtime_error(fmt::format("step {} refused: {}", step, report.error));
        if (draws) frames->write(view, all.crowd);
        if (records) {
            const std::optional<View> seen = view.gather(all.crowd, 0);
            try_on_all([&] {
                if (seen) recording->write(*seen, step);
            });
        }
        ++run.steps;
        run.step_seconds.push_back(ended - began);
        run.solver_seconds.push_back(ended - steered);
        run.fullest = std::max(run.fullest, reduce(static_cast<double>(all.crowd.people().size()), MPI_MAX));
        if (outputs.hash_every > 0 && (step + 1) % outputs.hash_every == 0) {
            const std::uint64_t hash = all.crowd.hash();
            if (rank == 0) fmt::print("step {} hash {:016x}\n", step + 1, hash);
        }
        if (!checkpoints.file.empty() && (step + 1) % checkpoints.every == 0)
            all.crowd.save(checkpoints.file);
        if (outputs.progress && rank == 0 && step * 4 / last != (step + 1) * 4 / last)
            fmt::print(stderr, "crowd: {} %\n", 25 * ((step + 1) * 4 / last));
    }
    if (trajectories) trajectories->close();
    if (frames) frames->close(all.crowd);
    std::vector<Figure> densities;  // on rank 0
    if (outputs.densities) {
        view.note_places(all.crowd);
        const std::optional<View> seen = view.gather(all.crowd, 0);
        try_on_all([&] {
            if (seen) densities = density_figures(*seen, all.crowd.executor());
        });
    }
    if (run.steps == 0)
        throw std::runtime_error("--restart: the checkpoint is at or beyond the end of --seconds");
    const std::vector<Line> lines =
        lines_of(run, all.crowd.figures(), static_cast<double>(options.agents), ranks);
    const std::uint64_t hash = all.crowd.hash();
    if (rank != 0) return;
    print(lines, hash, ranks, options.solver.threads, run.steps);
    for (const auto& [name, value] : densities) fmt::print("  {} {:.4g}\n", name, value);
    if (!json.empty()) write_json(json, lines, densities, hash, ranks, options.solver.threads, run.steps);
}

}  // namespace

bool is_started_by_mpi()
{
    for (const char* const name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "PMIX_RANK"}) {
        if (std::getenv(name) != nullptr) return true;
    }
    return false;
}

int run_distributed(const std::string& scene, RunOptions options, const RunOutputs& outputs,
                    const Checkpoints& checkpoints, const std::string& json)
{
    int threads_allowed = 0, rank = 0, ranks = 1, code = 0;
    MPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &threads_allowed);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, &ranks);
    const SceneEntry& entry = *find_scene("crowd");
    if (options.agents == 0) options.agents = entry.agents;
    if (options.seconds == 0) options.seconds = entry.seconds;
    try {
        if (const char* const refused = refusal_of(scene, options)) {
            code = 2;
            throw std::runtime_error(refused);
        }
        run_crowd(options, outputs, checkpoints, json, rank, ranks);
    } catch (const std::exception& error) {
        if (rank == 0) fmt::print(stderr, "motley: {}\n", error.what());
        code = std::max(code, 1);
    }
    MPI_Bcast(&code, 1, MPI_INT, 0, MPI_COMM_WORLD);
    MPI_Finalize();
    return code;
}

}  // namespace motley::bench
