#include "commands/behaviour.h"

#include <fmt/format.h>

#include <span>
#include <stdexcept>
#include <string_view>

#include "measuring/host.h"
#include "measuring/runner.h"

namespace motley::bench {
namespace {

constexpr struct {
    SteeringModel model;
    bool torsos;
    const char* name;
} steerings[] = {{SteeringModel::plain, false, "plain"},
                 {SteeringModel::plain, true, "plain, torsos"},
                 {SteeringModel::social_force, false, "social-force"},
                 {SteeringModel::orca, false, "orca"}};

RunResult run(const char* scene, const RunOptions& options)
{
    fmt::print(stderr, "behaviour: {}\n", scene);
    RunOutputs quiet;
    quiet.progress = false;
    return run_scene(*find_scene(scene), options, quiet);
}

double figure(const RunResult& result, std::string_view name)
{
    for (const Figure& figure : result.figures) {
        if (figure.first.starts_with(name)) return figure.second;
    }
    throw std::logic_error(fmt::format("{}: no figure '{}'", result.scene, name));
}

/// The columns of a run of `evacuation`.
std::string evacuated(const RunResult& r)
{
    return fmt::format("{:>8.0f}{:>10.2f}{:>12.2f}{:>8.0f}{:>10.1f}{:>10.1f}{:>10.2f}\n",
                       figure(r, "people through the door"), figure(r, "flow (persons/s)"),
                       figure(r, "flow per width"), figure(r, "clogs"), figure(r, "clogged in all"),
                       figure(r, "longest without"), figure(r, "overlap, deepest"));
}
std::string evacuated_head()
{
    return fmt::format("{:>8}{:>10}{:>12}{:>8}{:>10}{:>10}{:>10}\n", "out", "a second", "and metre", "clogs",
                       "s clogged", "longest", "overlap %");
}

void print_doors(const RunOptions& base, std::int64_t many)
{
    fmt::print(
        "flow through a door, contacts found; published: 1.9 persons/(m s), linear in the "
        "width\n{:>8}{:>8}{:>10}{}",
        "people", "door m", "friction", evacuated_head());
    for (const std::int64_t people : {base.agents, many}) {
        for (const float friction : {0.0F, 0.2F}) {
            for (const double door : {0.9, 1.2, 1.8, 2.4, 3.6, 5.0}) {
                RunOptions options = base;
                options.agents = people;
                options.friction = friction;
                options.door = door;
                fmt::print("{:>8}{:>8.1f}{:>10.1f}{}", people, door, friction,
                           evacuated(run("evacuation", options)));
            }
        }
    }
}

/// The walls and arrivals of an experiment.
void print_bottleneck(double seconds)
{
    fmt::print(
        "\n75 people of an experiment at a door of 0.5 m; measured: 1.15 "
        "persons/s\n{:<10}{:>8}{:>10}{:>8}{:>8}\n",
        "contacts", "1/dt", "through", "flow", "clogs");
    for (const bool is_listed : {false, true}) {
        for (const float rate : {30.0F, 60.0F, 120.0F}) {
            RunOptions options;
            options.dt = 1 / rate;
            options.seconds = seconds;
            options.lists_contacts = is_listed;
            const RunResult r = run("bottleneck", options);
            fmt::print("{:<10}{:>8.0f}{:>10.0f}{:>8.2f}{:>8.0f}\n", is_listed ? "listed" : "found", rate,
                       figure(r, "people through the door"), figure(r, "flow (persons/s)"),
                       figure(r, "clogs"));
        }
    }
}

void print_drift(const RunOptions& base)
{
    fmt::print("\nits drift with the step, door of 1.2 m, friction 0\n{:>8}{:>10}{}", "1/dt", "substeps",
               evacuated_head());
    for (const float rate : {30.0F, 60.0F, 120.0F}) {
        for (const int substeps : {1, 4, 16}) {
            RunOptions options = base;
            options.dt = 1 / rate;
            options.settings.substeps = substeps;
            fmt::print("{:>8.0f}{:>10}{}", rate, substeps, evacuated(run("evacuation", options)));
        }
    }
}

void print_steerings(const RunOptions& base)
{
    fmt::print("\nsteering models, evacuation by a door of 1.2 m\n{:<14}{}", "", evacuated_head());
    for (const auto& [model, torsos, name] : steerings) {
        RunOptions options = base;
        options.steering = model;
        options.torsos = torsos;
        fmt::print("{:<14}{}", name, evacuated(run("evacuation", options)));
    }
}

void print_counterflow(std::span<const std::int64_t> sizes, double seconds)
{
    fmt::print(
        "\ncounterflow in 50 x 5 m; lanes from 0, mixed, to 1, parted\n{:<14}{:>8}{:>12}{:>14}{:>12}{:>12}\n",
        "", "people", "m/s, mean", "lanes, start", "at the end", "overlap %");
    for (const auto& [model, torsos, name] : steerings) {
        for (const std::int64_t people : sizes) {
            RunOptions options;
            options.agents = people;
            options.seconds = seconds;
            options.steering = model;
            options.torsos = torsos;
            const RunResult r = run("counterflow", options);
            fmt::print("{:<14}{:>8}{:>12.3f}{:>14.2f}{:>12.2f}{:>12.2f}\n", name, people,
                       figure(r, "speed along"), figure(r, "lanes, 0 mixed"), figure(r, "lanes at the end"),
                       figure(r, "overlap, deepest"));
        }
    }
}

void print_speeds(double seconds)
{
    fmt::print(
        "\nspeed against density, one way; Weidmann: 1.34 (1 - exp(-1.913 (1/rho - "
        "1/5.4)))\n{:>12}{:>10}{:>12}\n",
        "people / m2", "m/s", "Weidmann's");
    for (const double density : {0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0}) {
        RunOptions options;
        options.density = density;
        options.seconds = seconds;
        const RunResult r = run("corridor", options);
        fmt::print("{:>12.1f}{:>10.3f}{:>12.3f}\n", density, figure(r, "speed (m/s)"), figure(r, "Weidmann"));
    }
}

void print_sparse(std::int64_t people, double seconds)
{
    fmt::print(
        "\na crowd that thins out, host load {:.1f}: the cost follows people and contacts, not the "
        "area\n{:>12}{:>12}{:>12}{:>22}\n",
        host_load(), "people / m2", "area, m2", "contacts", "M agent-steps/s");
    for (const double density : {5.0, 2.0, 0.5, 0.01}) {
        RunOptions options;
        options.agents = people;
        options.seconds = seconds;
        options.density = density;
        const RunResult r = run("crowd", options);
        const double rate = r.bodies / r.median_step_seconds * 1e-6;
        fmt::print("{:>12.2f}{:>12.0f}{:>12.0f}{:>22.2f}\n", density, r.bodies / density, r.constraints,
                   rate);
    }
}

}  // namespace

void print_behaviour(const BehaviourOptions& options)
{
    RunOptions base;
    base.agents = options.quick ? 100 : 400;
    base.seconds = options.quick ? 20 : 200;
    fmt::print("Steering decides these figures, not the solver; they are no pass marks.\n\n");
    print_doors(base, options.quick ? 200 : 1000);
    print_drift(base);
    print_bottleneck(options.quick ? 40 : 90);
    print_steerings(base);
    const std::int64_t sizes[] = {500, 1000};
    print_counterflow(std::span(sizes).first(options.quick ? 1 : 2), options.quick ? 25 : 80);
    print_speeds(options.quick ? 25 : 60);
    print_sparse(options.quick ? 2000 : 10000, options.quick ? 1 : 5);
}

}  // namespace motley::bench
