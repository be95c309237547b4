// Runs every point of a sweep in turn, round after round, so that a slowdown of the machine affects all of them.
#include "commands/sweep.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>

#include "engines/engine.h"
#include "measuring/clock.h"
#include "measuring/host.h"
#include "measuring/median.h"
#include "measuring/runner.h"
#include "worlds/rig.h"

namespace motley::bench {
namespace {

constexpr double came_apart = std::numeric_limits<double>::infinity();
/// Steps between two measurements of the joints of a rig.
constexpr int steps_a_look = 10;

/// What one run of one point gave.
struct Run {
    double step_seconds = 0, error = 0, worst = 0;
    std::int64_t steps = 0;
    std::string note{};
    double solver_seconds = -1;
};

/// A point that is still to be measured.
struct Candidate {
    SweepPoint point;
    std::function<Run()> run;
    std::vector<double> solver_seconds{};  ///< of each round
};

struct RigTimes {
    double warm_up, seconds;
};

Run run_rig(const Rig& rig, Engine& engine, const RigTimes& times)
{
    constexpr auto dt = static_cast<float>(1.0 / 60);
    const auto warm = static_cast<std::int64_t>(std::lround(times.warm_up * 60));
    const auto steps = static_cast<std::int64_t>(std::lround(times.seconds * 60));
    std::vector<RigPose> poses(rig.bodies.size());
    std::vector<double> durations, solver_durations;
    Run run;
    double squares = 0;
    int looks = 0;
    for (std::int64_t step = 1; step <= warm + steps; ++step) {
        const double began = now();
        engine.step(dt);
        if (step > warm) {
            durations.push_back(now() - began);
            if (engine.solver_seconds() >= 0) solver_durations.push_back(engine.solver_seconds());
        }
        if (step <= warm || (!rig.truth && step % steps_a_look != 0)) continue;
        engine.read(poses);
        double error = 0, worst = 0;
        if (rig.truth) {
            error = worst = rig.truth(poses, static_cast<double>(step) / 60);
        } else {
            const Separation separation = separation_of(rig, poses);
            error = separation.rms;
            worst = separation.max;
        }
        squares += error * error;
        run.worst = std::max(run.worst, worst);
        ++looks;
    }
    run.step_seconds = median(durations);
    if (!solver_durations.empty()) run.solver_seconds = median(solver_durations);
    run.steps = steps;
    run.error = std::sqrt(squares / std::max(1, looks));
    if (!std::isfinite(run.error) || run.error > 1e3) {
        run.error = run.worst = came_apart;
        run.note = "came apart";
    }
    return run;
}

class RigSubject {
  public:
    RigSubject(const RigEntry& entry, const SweepOptions& options)
        : suits_direct_(entry.suits_direct),
          rig_(entry.make(options.agents > 0 ? options.agents : entry.bodies, options.seed)),
          times_{entry.warm_up, options.seconds > 0 ? options.seconds : entry.seconds}
    {
        if (rig_.bodies.empty() || (rig_.joints.empty() && !rig_.collides))
            throw std::runtime_error(fmt::format("{}: too few bodies", entry.name));
    }
    void describe(SweepResult& result) const
    {
        result.bodies = static_cast<std::int64_t>(rig_.bodies.size());
        result.joints = static_cast<std::int64_t>(rig_.joints.size());
    }
    /// Empty where the combination makes no sense.
    [[nodiscard]] std::function<Run()> candidate(const Dials& dials) const
    {
        if (dials.settings.method == Method::direct && !suits_direct_) return {};
        // Nets have more loops than exact_joints can close; four-bars, with four joints for three bodies, do not.
        const bool has_trees = !rig_.joints.empty() && 2 * rig_.joints.size() <= 3 * rig_.bodies.size();
        if (dials.settings.exact_joints && !has_trees) return {};
        if (dials.settings.exact_contacts && !rig_.collides) return {};
        return [this, dials] {
            const auto engine = make_motley_engine(rig_, dials.settings, dials.solver);
            return run_rig(rig_, *engine, times_);
        };
    }
    [[nodiscard]] std::function<Run()> candidate(const Peer& peer, const PeerSetting& setting) const
    {
        if (setting.is_direct && !suits_direct_) return {};
        return [this, &peer, &setting] {
            const auto engine = peer.make(rig_, setting);
            return run_rig(rig_, *engine, times_);
        };
    }

  private:
    bool suits_direct_;
    Rig rig_;
    RigTimes times_;
};

/// A crowd: its error is how deep people overlap.
class CrowdSubject {
  public:
    CrowdSubject(const SceneEntry& entry, const SweepOptions& options) : entry_(entry), options_(options) {}
    void describe(SweepResult& result) const
    {
        result.bodies = options_.agents > 0 ? options_.agents : entry_.agents;
    }
    [[nodiscard]] std::function<Run()> candidate(const Dials& dials) const
    {
        const SolverSettings& s = dials.settings;
        if (s.method == Method::direct || s.exact_joints || s.exact_contacts) return {};
        return [this, dials] {
            RunOptions run;
            run.agents = options_.agents;
            run.seconds = options_.seconds;
            run.settings = dials.settings;
            run.solver = dials.solver;
            run.seed = options_.seed;
            RunOutputs quiet;
            quiet.progress = false;
            const RunResult result = run_scene(entry_, run, quiet);
            const double error = result.error ? result.error->value : result.overlap_p99;
            const double worst = result.error ? error : result.overlap_max;
            return Run{result.median_solver_seconds, error, worst, result.steps};
        };
    }

  private:
    const SceneEntry& entry_;
    const SweepOptions& options_;
};

template <class Subject>
void add_motley(const Subject& subject, const DialGrid& grid, std::vector<Candidate>& candidates)
{
    for (const Dials& dials : expand(grid)) {
        std::function<Run()> run = subject.candidate(dials);
        if (!run) continue;
        Candidate candidate{{}, std::move(run)};
        candidate.point.engine = "motley";
        candidate.point.label = label_of(dials);
        candidate.point.dials = dials;
        candidates.push_back(std::move(candidate));
    }
}

void run_rounds(std::vector<Candidate>& candidates, const SweepOptions& options, SweepResult& result)
{
    const std::size_t total = candidates.size() * static_cast<std::size_t>(options.rounds);
    std::size_t done = 0;
    for (int round = 0; round < options.rounds; ++round) {
        for (Candidate& candidate : candidates) {
            ++done;
            if (options.progress)
                fmt::print(stderr, "{}: {} of {}, {} {}\n", result.scene, done, total, candidate.point.engine,
                           candidate.point.label);
            const Run run = candidate.run();
            candidate.point.step_seconds.push_back(run.step_seconds);
            candidate.solver_seconds.push_back(run.solver_seconds);
            candidate.point.error = run.error;
            candidate.point.worst = run.worst;
            candidate.point.note = run.note;
            result.steps = run.steps;
        }
    }
    for (Candidate& candidate : candidates) {
        candidate.point.seconds = median(candidate.point.step_seconds);
        candidate.point.solver_seconds = median(candidate.solver_seconds);
        result.points.push_back(std::move(candidate.point));
    }
    std::stable_sort(result.points.begin(), result.points.end(),
                     [](const SweepPoint& x, const SweepPoint& y) { return x.seconds < y.seconds; });
    mark_front(result.points);
}

}  // namespace

void mark_front(std::vector<SweepPoint>& points)
{
    for (SweepPoint& point : points) {
        point.on_front = std::isfinite(point.error) &&
                         std::none_of(points.begin(), points.end(), [&](const SweepPoint& other) {
                             return other.seconds <= point.seconds && other.error <= point.error &&
                                    (other.seconds < point.seconds || other.error < point.error);
                         });
    }
}

std::vector<std::pair<std::string, const SweepPoint*>> fastest_within(const SweepResult& result, double error)
{
    std::vector<std::pair<std::string, const SweepPoint*>> fastest{{"motley", nullptr}};
    for (const SweepPoint& p : result.points) {
        auto entry =
            std::find_if(fastest.begin(), fastest.end(), [&](const auto& e) { return e.first == p.engine; });
        if (entry == fastest.end()) entry = fastest.insert(entry, {p.engine, nullptr});
        if (p.error <= error && (entry->second == nullptr || p.seconds < entry->second->seconds))
            entry->second = &p;
    }
    return fastest;
}

SweepResult sweep(const std::string& scene, const DialGrid& grid, const SweepOptions& options)
{
    SweepResult result;
    result.scene = scene;
    result.rounds = options.rounds;
    result.host_load = host_load();
    std::vector<Candidate> candidates;
    if (const RigEntry* entry = find_rig(scene)) {
        result.description = entry->description;
        result.error_name = entry->error_name;
        const RigSubject subject(*entry, options);
        subject.describe(result);
        add_motley(subject, grid, candidates);
        std::vector<Peer> others;
        if (options.with_peers) {
            others = peers();
            result.notes = missing_peers();
        }
        for (const Peer& peer : others) {
            for (const PeerSetting& setting : peer.settings) {
                const bool is_wanted =
                    fmt::format("{} {}", peer.name, setting.label).find(options.only_peer) !=
                    std::string::npos;
                std::function<Run()> run = is_wanted ? subject.candidate(peer, setting) : nullptr;
                if (!run) continue;
                Candidate candidate{{}, std::move(run)};
                candidate.point.engine = peer.name;
                candidate.point.label = setting.label;
                candidates.push_back(std::move(candidate));
            }
        }
        run_rounds(candidates, options, result);
        return result;
    }
    const SceneEntry* entry = find_scene(scene);
    if (entry == nullptr)
        throw std::runtime_error(fmt::format("no scene '{}'; `motley list` names them", scene));
    result.description = entry->description;
    RunOptions small;
    small.agents = 100;
    const std::optional<SceneError> own = entry->make(small)->error();
    result.error_name = own ? own->name : "overlap, 99th percentile (share of the radius)";
    const CrowdSubject subject(*entry, options);
    subject.describe(result);
    add_motley(subject, grid, candidates);
    if (options.with_peers) result.notes.emplace_back("peers have no crowds: motley alone");
    run_rounds(candidates, options, result);
    return result;
}

}  // namespace motley::bench
