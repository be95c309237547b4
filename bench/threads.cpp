// A core's clock wanders within seconds, by more than what is asked; so turns are short, and each is compared with its neighbour.
#include "threads.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <stdexcept>

#include "bench_scene.h"
#include "host.h"
#include "median.h"

namespace motley::bench {
namespace {

constexpr int steps_a_turn = 8;

/// A scene with a solver of its own.
class Copy {
  public:
    Copy(const SceneEntry& entry, RunOptions options)
        : dt_(options.dt), scene_(entry.make(options)), solver_(adjusted(options), options.solver)
    {
    }
    /// One step; s that it took.
    double step()
    {
        const auto began = std::chrono::steady_clock::now();
        scene_->steer(time_, solver_.executor());
        const StepReport report = solver_.step(scene_->scene, dt_, scene_->find_contacts(solver_.executor()));
        const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
        if (report.status != StepStatus::done) throw std::runtime_error("step refused: " + report.error);
        scene_->observe(time_, solver_);
        time_ += static_cast<double>(dt_);
        return took.count();
    }
    /// Mean s a step. The first brings the scene back into the caches from the other's turn, and does not count.
    double turn()
    {
        step();
        double seconds = 0;
        for (int i = 0; i < steps_a_turn; ++i) seconds += step();
        return seconds / steps_a_turn;
    }
    [[nodiscard]] bool is_over() const { return scene_->is_over(time_); }
    [[nodiscard]] std::uint64_t hash() const { return scene_->scene.state_hash(); }

  private:
    float dt_;
    double time_ = 0;
    std::unique_ptr<BenchScene> scene_;
    Solver solver_;

    [[nodiscard]] SolverSettings adjusted(const RunOptions& options) const
    {
        SolverSettings settings = options.settings;
        scene_->adjust(settings);
        return settings;
    }
};

ThreadsResult measure(const SceneEntry& entry, const ThreadsOptions& asked)
{
    RunOptions options;
    options.agents = asked.agents > 0 ? asked.agents : entry.agents;
    options.settings = asked.settings;
    options.solver = asked.solver;
    Copy several(entry, options);
    options.solver.threads = 1;
    Copy one(entry, options);
    // The first turns make room, and find out how fast each core is.
    several.turn();
    one.turn();
    std::vector<double> of_one, of_several, speed_ups;
    for (int turn = 0; turn < asked.turns && !one.is_over(); ++turn) {
        if (turn % 2 == 0) {
            of_one.push_back(one.turn());
            of_several.push_back(several.turn());
        } else {
            of_several.push_back(several.turn());
            of_one.push_back(one.turn());
        }
        speed_ups.push_back(of_one.back() / of_several.back());
    }
    std::sort(speed_ups.begin(), speed_ups.end());
    const std::size_t turns = speed_ups.size();
    if (turns == 0) throw std::runtime_error(fmt::format("{}: over before its first turn", entry.name));
    return {entry.name,           median(of_one),           median(of_several),          speed_ups[turns / 4],
            speed_ups[turns / 2], speed_ups[turns * 3 / 4], one.hash() == several.hash()};
}

}  // namespace

std::vector<ThreadsResult> measure_threads(const ThreadsOptions& options)
{
    std::vector<ThreadsResult> results;
    for (const std::string& scene : options.scenes) {
        const SceneEntry* entry = find_scene(scene);
        if (entry == nullptr)
            throw std::runtime_error(fmt::format("no scene '{}'; `motley list` names them", scene));
        if (options.progress) fmt::print(stderr, "{}: {} turns of each\n", scene, options.turns);
        results.push_back(measure(*entry, options));
    }
    return results;
}

std::string table_of(const std::vector<ThreadsResult>& results, int threads)
{
    std::string text = fmt::format(
        "{} threads beside one, copies of a scene in turn, {} steps a turn; host load {:.2f}\n"
        "{:<12} {:>12} {:>12} {:>14} {:>12}  {}\n",
        threads, steps_a_turn, host_load(), "scene", "ms on one", fmt::format("ms on {}", threads),
        "times as fast", "quartiles", "bits");
    for (const ThreadsResult& result : results) {
        text += fmt::format("{:<12} {:12.3f} {:12.3f} {:14.2f} {:7.2f} {:.2f}  {}\n", result.scene,
                            result.one_thread_seconds * 1e3, result.seconds * 1e3, result.median_speed_up,
                            result.lower_quartile, result.upper_quartile,
                            result.same_bits ? "the same" : "NOT THE SAME");
    }
    return text;
}

}  // namespace motley::bench
