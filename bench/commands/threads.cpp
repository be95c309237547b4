// A core's clock varies within seconds by more than the effect measured here, so turns are short and each is compared
// with the next.
#include "commands/threads.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <stdexcept>

#include "commands/cores.h"
#include "measuring/clock.h"
#include "measuring/host.h"
#include "measuring/median.h"
#include "measuring/runner.h"
#include "motley/core/invalid_input.h"
#include "worlds/bench_scene.h"

namespace motley::bench {
namespace {

constexpr int steps_a_turn = 8;
/// The share of the ideal arithmetic rate above which every thread is taken to have a core of its own.
constexpr double whole_cores = 0.8;
/// s: a line takes 30 to 60 ns between cores that share a cache, and 150 ns or more between cores that do not.
constexpr double near_hand_over = 100e-9;

/// A scene with a solver of its own.
class Copy {
  public:
    Copy(const SceneEntry& entry, const RunOptions& options)
        : dt_(options.dt), scene_(entry.make(options)), solver_(adjusted(options), options.solver)
    {
    }
    /// Mean seconds a step. The first step is not counted: it brings the scene back into the caches after the other
    /// copy's turn.
    double turn()
    {
        step();
        double seconds = 0;
        for (int i = 0; i < steps_a_turn; ++i) seconds += step();
        return seconds / steps_a_turn;
    }
    [[nodiscard]] bool is_over() const { return scene_->is_over(time_); }
    [[nodiscard]] std::uint64_t hash() const { return scene_->scene.state_hash(); }
    [[nodiscard]] Executor& executor() { return solver_.executor(); }

  private:
    float dt_;
    double time_ = 0;
    std::unique_ptr<BenchScene> scene_;
    Solver solver_;

    double step()
    {
        const double began = now();
        scene_->steer(time_, executor());
        const StepReport report = solver_.step(scene_->scene, dt_, scene_->find_contacts(executor()));
        const double took = now() - began;
        if (report.status != StepStatus::done) throw std::runtime_error("step refused: " + report.error);
        scene_->observe(time_, solver_);
        time_ += static_cast<double>(dt_);
        return took;
    }
    [[nodiscard]] SolverSettings adjusted(const RunOptions& options) const
    {
        SolverSettings settings = options.settings;
        scene_->adjust(settings);
        return settings;
    }
};

SpeedUp quartiles_of(std::vector<double> values)
{
    if (values.empty()) return {};
    std::sort(values.begin(), values.end());
    const std::size_t count = values.size();
    return {static_cast<int>(count), values[count / 4], values[count / 2], values[count * 3 / 4]};
}

ThreadsResult measure(const SceneEntry& entry, const ThreadsOptions& asked)
{
    RunOptions options;
    options.agents = asked.agents > 0 ? asked.agents : entry.agents;
    options.settings = asked.settings;
    options.solver = asked.solver;
    settle_options(entry, options);
    Copy several(entry, options);
    options.solver.threads = 1;
    Copy one(entry, options);
    // The first turns are not counted: they allocate memory and find out how fast each core is.
    several.turn();
    one.turn();
    std::vector<double> of_one, of_several, all, near, far;
    for (int turn = 0; turn < asked.turns && !one.is_over(); ++turn) {
        const bool one_first = turn % 2 == 0;
        if (one_first) of_one.push_back(one.turn());
        of_several.push_back(several.turn());
        if (!one_first) of_one.push_back(one.turn());
        const double speed_up = of_one.back() / of_several.back();
        all.push_back(speed_up);
        const CoresAtHand at_hand = look_at_cores(several.executor());
        if (at_hand.cores >= whole_cores * asked.solver.threads)
            (at_hand.hand_over_seconds < near_hand_over ? near : far).push_back(speed_up);
    }
    if (all.empty()) throw std::runtime_error(fmt::format("{}: over before its first turn", entry.name));
    return {entry.name,         median(of_one),    median(of_several),          quartiles_of(all),
            quartiles_of(near), quartiles_of(far), one.hash() == several.hash()};
}

}  // namespace

std::vector<ThreadsResult> measure_threads(const ThreadsOptions& options)
{
    if (options.solver.threads < 2)
        refuse("ThreadsOptions.solver.threads", options.solver.threads, "2 to 1024");
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
    const auto cell = [](const SpeedUp& speed_up) {
        return speed_up.turns == 0
                   ? std::string("-")
                   : fmt::format("{:.2f} ({:.2f} {:.2f}) {:4}", speed_up.median, speed_up.lower_quartile,
                                 speed_up.upper_quartile, speed_up.turns);
    };
    std::string text = fmt::format(
        "{} threads beside one: copies of a scene in turn, {} steps a turn; host load {:.2f}\n"
        "times as fast, with quartiles, and in how many turns: all, and while each thread had a core of its "
        "own, near\n"
        "the other's (a line is handed over in less than {:.0f} ns) or far from it\n"
        "{:<12} {:>10} {:>10} {:>24} {:>24} {:>24}  {}\n",
        threads, steps_a_turn, host_load(), near_hand_over * 1e9, "scene", "ms on 1",
        fmt::format("ms on {}", threads), "all", "near", "far", "bits");
    for (const ThreadsResult& result : results) {
        text +=
            fmt::format("{:<12} {:10.3f} {:10.3f} {:>24} {:>24} {:>24}  {}\n", result.scene,
                        result.one_thread_seconds * 1e3, result.seconds * 1e3, cell(result.all),
                        cell(result.near), cell(result.far), result.same_bits ? "the same" : "NOT THE SAME");
    }
    return text;
}

}  // namespace motley::bench
