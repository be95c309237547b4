// The loop around the solver: steer, search, step, observe.
#include "measuring/runner.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>

#include "measuring/clock.h"
#include "measuring/host.h"
#include "measuring/median.h"
#include "page/frames.h"
#include "recording/recording.h"
#include "scene/scene_core.h"
#include "worlds/density.h"
#include "worlds/trajectories.h"

namespace motley::bench {
namespace {

constexpr double lanes_of_a_block = 16;

/// A bar on a terminal; elsewhere a line each quarter.
class Progress {
  public:
    Progress(bool shown, std::string what, std::int64_t steps)
        : shown_(shown), terminal_(isatty(2) != 0), what_(std::move(what)), steps_(steps)
    {
    }
    void advance(std::int64_t step)
    {
        const auto percent = static_cast<int>(100 * step / std::max<std::int64_t>(1, steps_));
        if (!shown_ || percent == percent_) return;
        percent_ = percent;
        if (terminal_) {
            fmt::print(stderr, "\r{} [{:<40}] {:3} %", what_,
                       std::string(static_cast<std::size_t>(percent * 2 / 5), '#'), percent);
            if (percent == 100) fmt::print(stderr, "\n");
            std::fflush(stderr);
        } else if (percent / 25 != quarter_) {
            quarter_ = percent / 25;
            fmt::print(stderr, "{}: {} %\n", what_, percent);
        }
    }

  private:
    bool shown_, terminal_;
    std::string what_;
    std::int64_t steps_;
    int percent_ = -1, quarter_ = 0;
};

/// Judges overlaps and remaining approach speeds, from the positions and velocities after the last step.
void judge_contacts(RunResult& result, BenchScene& scene, Executor& executor)
{
    Crowd* crowd = scene.crowd();
    if (crowd == nullptr || crowd->agents.empty()) return;
    crowd->observe(scene.scene, executor);
    const auto contacts = crowd->find_contacts(scene.scene, executor);
    const auto pairs = crowd->pairs();
    std::vector<double> deepest(crowd->agents.size(), 0.0);
    double squares = 0;
    std::int64_t touching = 0;
    for (std::size_t i = 0; i < contacts.size(); ++i) {
        if (contacts[i].separation > 0) continue;
        const auto a = static_cast<std::size_t>(pairs[i].a);
        const auto note = [&](std::size_t agent) {
            deepest[agent] = std::max(
                deepest[agent], -static_cast<double>(contacts[i].separation / crowd->agents[agent].radius));
        };
        note(a);
        Vec3<float> relative = crowd->velocities[a];
        if (pairs[i].b >= 0) {
            note(static_cast<std::size_t>(pairs[i].b));
            relative = crowd->velocities[static_cast<std::size_t>(pairs[i].b)] - relative;
        }
        const double approach = std::min(0.0, static_cast<double>(dot(contacts[i].normal, relative)));
        squares += approach * approach;
        ++touching;
    }
    std::sort(deepest.begin(), deepest.end());
    result.overlap_p50 = deepest[deepest.size() / 2];
    result.overlap_p99 = deepest[std::min(deepest.size() - 1, deepest.size() * 99 / 100)];
    result.overlap_max = deepest.back();
    result.residual = touching > 0 ? std::sqrt(squares / static_cast<double>(touching)) : 0;
}

/// How far velocities are from those of the simultaneous solution of the same steps.
class DirectComparison {
  public:
    DirectComparison(const RunOptions& options) : dt_(options.dt), solver_(settings_of(options), {}) {}
    void solve(const Scene& before, std::span<const Contact> contacts)
    {
        copy_ = before;
        const StepReport report = solver_.step(copy_, dt_, contacts);
        if (report.status != StepStatus::done) throw std::runtime_error("direct: " + report.error);
    }
    void compare(const Scene& after)
    {
        for (std::uint32_t slot = 1; slot < core_of(after).bodies.slot_count(); ++slot) {
            if (!core_of(after).bodies.is_slot_live(slot)) continue;
            const BodyId body = core_of(after).bodies.id_of_slot(slot);
            const Vec3<float> off = after.state(body).linear_velocity - copy_.state(body).linear_velocity;
            const auto length2 = static_cast<double>(dot(off, off));
            squares_ += length2;
            largest_ = std::max(largest_, std::sqrt(length2));
            ++count_;
        }
    }
    void report(RunResult& result) const
    {
        if (count_ == 0) return;
        result.direct_rms = std::sqrt(squares_ / static_cast<double>(count_));
        result.direct_max = largest_;
    }

  private:
    float dt_;
    Solver solver_;
    Scene copy_;
    double squares_ = 0, largest_ = 0;
    std::int64_t count_ = 0;

    static SolverSettings settings_of(const RunOptions& options)
    {
        SolverSettings settings = options.settings;
        settings.method = Method::direct;
        return settings;
    }
};

}  // namespace

void settle_options(const SceneEntry& entry, RunOptions& options)
{
    const auto refuse = [&](const char* option, const char* why) {
        throw InvalidInput(fmt::format("{}: the scene {} {}", option, entry.name, why));
    };
    const SceneTakes& takes = entry.takes;
    if (options.door > 0 && !takes.door) refuse("--door", "has no door whose width can be chosen");
    if (options.density > 0 && !takes.density) refuse("--density", "has a density of its own");
    if (options.steering != SteeringModel::plain && !takes.steering)
        refuse("--steering", "has a steering of its own");
    if (options.torsos && !takes.torsos) refuse("--torsos", "has people as discs only");
    if (!takes.listed && !takes.found) return;
    if (options.lists_contacts && options.torsos) refuse("--listed", "cannot list the contacts of torsos");
    if (options.lists_contacts && !takes.listed) refuse("--listed", "leaves its contacts to the library");
    options.lists_contacts = options.lists_contacts || !takes.found;
}

RunResult run_scene(const SceneEntry& entry, RunOptions options, const RunOutputs& outputs)
{
    if (options.agents == 0) options.agents = entry.agents;
    if (options.seconds == 0) options.seconds = entry.seconds;
    settle_options(entry, options);
    const double bytes_before = allocated_bytes();
    const std::unique_ptr<BenchScene> scene = entry.make(options);
    scene->adjust(options.settings);
    DirectComparison direct(options);
    Solver solver(options.settings, options.solver);
    Executor& executor = solver.executor();
    std::unique_ptr<TrajectoryWriter> trajectories;
    std::unique_ptr<FrameWriter> frames;
    if (!outputs.trajectories.empty())
        trajectories =
            std::make_unique<TrajectoryWriter>(outputs.trajectories, 1 / static_cast<double>(options.dt));
    if (!outputs.frames.empty()) frames = std::make_unique<FrameWriter>(outputs.frames, outputs.colour);
    std::unique_ptr<RecordingWriter> recording;
    if (!outputs.recording.empty())
        recording = std::make_unique<RecordingWriter>(outputs.recording, entry.name,
                                                      outputs.record_every * static_cast<double>(options.dt));
    if (scene->crowd() == nullptr && trajectories)
        throw std::runtime_error(fmt::format("{}: has no people who walk, so no trajectories", entry.name));
    if (!scene->view() && (frames || outputs.densities || recording))
        throw std::runtime_error(
            fmt::format("{}: has no people, so no frames, recordings or densities", entry.name));

    RunResult result;
    result.scene = entry.name;
    result.isa = isa_name(solver.isa());
    result.method = options.settings.method == Method::soft_step            ? "soft_step"
                    : options.settings.method == Method::sequential_impulse ? "sequential_impulse"
                                                                            : "direct";
    result.threads = solver.threads();
    result.lists_contacts = options.lists_contacts;
    const auto steps =
        static_cast<std::int64_t>(std::ceil(options.seconds / static_cast<double>(options.dt)));
    Progress progress(outputs.progress, entry.name, steps);
    std::vector<double> step_seconds, solver_seconds, unsteered_seconds;
    double blocks = 0;
    for (std::int64_t step = 0; step < steps; ++step) {
        const double time = static_cast<double>(step) * static_cast<double>(options.dt);
        const double began = now();
        scene->steer(time, executor);
        const double steered = now();
        const std::span<const Contact> contacts = scene->find_contacts(executor);
        const double searched = now() - steered;
        const bool compares = options.direct_every > 0 && step % options.direct_every == 0;
        if (compares) direct.solve(scene->scene, contacts);
        if (step == outputs.problem_step && !outputs.problem.empty())
            save_problem({scene->scene, options.settings, options.dt, {contacts.begin(), contacts.end()}},
                         outputs.problem);
        const double found = now();
        result.last = solver.step(scene->scene, options.dt, contacts);
        const double solved = now();
        if (result.last.status != StepStatus::done)
            throw std::runtime_error(fmt::format("step {} refused: {}", step, result.last.error));

        if (compares) direct.compare(scene->scene);
        RunTimes& times = result.times;
        if (step == 1) times = {};
        ++times.steps;
        times.steering += steered - began;
        times.search += searched;
        times.solver += solved - found;
        step_seconds.push_back((solved - found) + searched + (steered - began));
        solver_seconds.push_back(solved - found);
        unsteered_seconds.push_back((solved - found) + searched);
        for (std::size_t s = 0; s < stage_count; ++s) times.stages[s] += result.last.seconds[s];
        const auto constraints = static_cast<double>(result.last.contacts + result.last.joints);
        result.constraints += constraints;
        blocks += static_cast<double>(result.last.blocks);
        result.bytes_per_constraint += result.last.bytes_per_constraint * constraints;
        result.colours = std::max(result.colours, result.last.colours);
        result.overflow = std::max(result.overflow, result.last.overflow);
        times.constraint_sweeps += constraints * static_cast<double>(result.last.sweeps);
        result.bodies += static_cast<double>(scene->scene.body_count());
        result.contained += result.last.bodies_contained;
        ++result.steps;
        scene->observe(time, solver);
        if (trajectories) trajectories->write(*scene->crowd(), step);
        if (recording && step % outputs.record_every == 0) recording->write(*scene->view(), step);
        if (frames && step % outputs.frame_every == 0) frames->write(*scene->view(), executor);
        if (outputs.hash_every > 0 && (step + 1) % outputs.hash_every == 0) {
            fmt::print("step {} hash {:016x}\n", step + 1, scene->scene.state_hash());
        }
        progress.advance(step + 1);
        if (scene->is_over(time)) break;
    }
    progress.advance(steps);
    if (trajectories) trajectories->close();
    const auto count = static_cast<double>(std::max<std::int64_t>(1, result.steps));
    result.bodies /= count;
    if (result.constraints > 0) {
        result.lane_occupancy = result.constraints / (lanes_of_a_block * blocks);
        result.bytes_per_constraint /= result.constraints;
    }
    result.constraints /= count;
    result.median_step_seconds = median_of_eights(step_seconds);
    result.median_solver_seconds = median_of_eights(solver_seconds);
    result.median_unsteered_seconds = median_of_eights(unsteered_seconds);
    result.errors = scene->scene.errors();
    result.state_hash = scene->scene.state_hash();
    result.bytes = allocated_bytes() - bytes_before;
    judge_contacts(result, *scene, executor);
    direct.report(result);
    result.error = scene->error();
    result.figures = scene->figures();
    if (outputs.densities) {
        const std::vector<Figure> told = density_figures(*scene->view(), executor);
        result.figures.insert(result.figures.end(), told.begin(), told.end());
    }
    result.marks = scene->marks();
    if (result.error) result.figures.emplace_back(result.error->name, result.error->value);
    return result;
}

}  // namespace motley::bench
