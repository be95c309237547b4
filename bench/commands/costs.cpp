#include "commands/costs.h"

#include <fmt/format.h>

#include <functional>
#include <stdexcept>

#include "measuring/median.h"
#include "measuring/runner.h"
#include "worlds/tie_net.h"

namespace motley::bench {
namespace {

struct Sample {
    double seconds, error;
};
struct Case {
    std::string group, name;
    std::function<Sample()> run;
};

/// Times a step of a net of 10,000 bodies at the default settings. Bodies move at `moved_at` m/s, of which 1e-40 is
/// denormal.
Sample run_net(const std::string& name, float moved_at)
{
    constexpr int side = 100;
    const NamedTie tie = tie_called(name);
    const auto net = make_net(tie.tie, tie.model, side);
    for (std::size_t i = 0; moved_at > 0 && i < net->bodies.size(); ++i)
        net->scene.set_velocity(net->bodies[i], {i % 2 == 0 ? moved_at : -moved_at, 0, 0}, {});
    Solver solver;
    std::vector<double> seconds;
    for (int step = 0; step < 30; ++step) {
        const StepReport report = solver.step(net->scene, 1e-3F, net->contacts);
        if (report.status != StepStatus::done) throw std::runtime_error(report.error);
        if (step >= 5) seconds.push_back(report.total_seconds());
    }
    return {median(seconds), -1};
}

Sample run_crowd(const SolverSettings& settings, float friction, const SolverOptions& solver = {})
{
    RunOptions options;
    options.agents = 10000;
    options.seconds = 1;
    options.settings = settings;
    options.friction = friction;
    options.solver = solver;
    RunOutputs quiet;
    quiet.progress = false;
    const RunResult result = run_scene(*find_scene("crowd"), options, quiet);
    return {result.median_solver_seconds, result.overlap_p99};
}

std::vector<Case> all_cases()
{
    std::vector<Case> cases;
    const auto net = [&](const char* group, const char* name, const char* tie, float moved_at = 0) {
        cases.push_back({group, name, [tie, moved_at] { return run_net(tie, moved_at); }});
    };
    const char* models = "body model: a net of 10,000 bodies, 19,800 smooth contacts";
    net(models, "planar", "smooth_contact/planar");
    net(models, "particle", "smooth_contact/particle");
    net(models, "rigid", "smooth_contact/rigid");
    const char* friction = "friction: the same net, rigid bodies";
    net(friction, "without", "smooth_contact/rigid");
    net(friction, "with", "contact/rigid");
    net(friction, "manifolds of four points, friction of the whole", "manifold/rigid");
    const char* six = "six degrees of freedom set up as a hinge: a net of 19,800 joints";
    net(six, "hinge", "hinge/rigid");
    net(six, "six degrees of freedom", "six_dof_hinge/rigid");
    const char* rows = "rows: the same net, each joint";
    net(rows, "ball-socket, 3 rows", "ball_socket/rigid");
    net(rows, "hinge, 5 rows", "hinge/rigid");
    net(rows, "fixed, 6 rows", "fixed/rigid");

    const char* numbers = "numbers: a net of 19,800 ball-sockets whose bodies move";
    net(numbers, "at 1e-3 m/s", "ball_socket/rigid", 1e-3F);
    net(numbers, "at 1e-40 m/s, denormal", "ball_socket/rigid", 1e-40F);

    const char* features = "features of a step: a crowd of 10,000";
    const auto crowd = [&](const char* name, auto change, float between = 0) {
        SolverSettings settings;
        change(settings);
        cases.push_back({features, name, [settings, between] { return run_crowd(settings, between); }});
    };
    crowd("the default", [](SolverSettings&) {});
    crowd(
        "friction 0.2", [](SolverSettings&) {}, 0.2F);
    crowd("no warm start", [](SolverSettings& s) { s.warm_start = false; });
    crowd("no relaxation", [](SolverSettings& s) { s.relaxations = 0; });
    crowd("2 substeps", [](SolverSettings& s) { s.substeps = 2; });
    crowd("8 substeps", [](SolverSettings& s) { s.substeps = 8; });
    crowd("2 iterations", [](SolverSettings& s) { s.iterations = 2; });
    crowd("8 iterations", [](SolverSettings& s) { s.iterations = 8; });
    crowd("8 iterations, tolerance 0.01 m/s", [](SolverSettings& s) {
        s.iterations = 8;
        s.tolerance = 0.01F;
    });
    crowd("measures", [](SolverSettings& s) { s.measures = true; });
    crowd("sequential_impulse, 1 x 10", [](SolverSettings& s) {
        s.method = Method::sequential_impulse;
        s.substeps = 1;
        s.iterations = 10;
    });
    return cases;
}

}  // namespace

std::vector<CostLine> measure_costs(int rounds, bool progress)
{
    const std::vector<Case> cases = all_cases();
    std::vector<std::vector<double>> seconds(cases.size());
    std::vector<double> errors(cases.size());
    for (int round = 0; round < rounds; ++round) {
        for (std::size_t i = 0; i < cases.size(); ++i) {
            if (progress) fmt::print(stderr, "costs: round {} of {}, {}\n", round + 1, rounds, cases[i].name);
            const Sample sample = cases[i].run();
            seconds[i].push_back(sample.seconds);
            errors[i] = sample.error;
        }
    }
    std::vector<CostLine> lines;
    for (std::size_t i = 0; i < cases.size(); ++i)
        lines.push_back({cases[i].group, cases[i].name, median(seconds[i]), errors[i]});
    return lines;
}

std::vector<WayLine> measure_ways(int rounds, bool progress)
{
    struct Way {
        std::string name;
        SolverOptions options;
        std::vector<double> seconds;
    };
    std::vector<Way> ways;
    for (const Isa isa : available_isas())
        ways.push_back({fmt::format("{}, 1 thread", isa_name(isa)), {.threads = 1, .isa = isa}, {}});
    ways.push_back({fmt::format("{}, 2 threads", isa_name(available_isas().back())),
                    {.threads = 2, .isa = available_isas().back()},
                    {}});
    for (int round = 0; round < rounds; ++round) {
        for (Way& way : ways) {
            if (progress) fmt::print(stderr, "ways: round {} of {}, {}\n", round + 1, rounds, way.name);
            way.seconds.push_back(run_crowd({}, 0, way.options).seconds);
        }
    }
    std::vector<WayLine> lines;
    for (const Way& way : ways) lines.push_back({way.name, 10000 / median(way.seconds)});
    return lines;
}

}  // namespace motley::bench
