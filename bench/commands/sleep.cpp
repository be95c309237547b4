// Steps each scene until who may sleep does, and then measures it.
#include "commands/sleep.h"

#include <fmt/format.h>

#include <chrono>
#include <functional>
#include <memory>
#include <stdexcept>

#include "measuring/median.h"
#include "worlds/random.h"
#include "worlds/tie_net.h"

namespace motley::bench {
namespace {

constexpr float dt = 1.0F / 60;
/// Steps until all who may sleep do, and those that are measured.
constexpr int warm_steps = 60, steps = 60;

SolverSettings settings_of(bool sleeps)
{
    SolverSettings settings;
    settings.sleep_speed = sleeps ? 0.01F : 0;
    return settings;
}

/// Steps a scene; `steer` is called before each step and not measured.
SleepLine measure(Scene& scene, std::span<const Contact> contacts, const SleepOptions& options, bool sleeps,
                  const std::function<void()>& steer = {})
{
    Solver solver(settings_of(sleeps), options.solver);
    SleepLine line;
    double seconds = 0;  // a mean, because every twentieth step of those who walk searches all people
    for (int step = 0; step < warm_steps + steps; ++step) {
        if (steer) steer();
        const auto began = std::chrono::steady_clock::now();
        const StepReport report = solver.step(scene, dt, contacts);
        const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
        if (report.status != StepStatus::done) throw std::runtime_error(report.error);
        if (step >= warm_steps) seconds += took.count();
        line.contacts = report.contacts;
        line.asleep = report.bodies_asleep;
    }
    line.seconds = seconds / steps;
    return line;
}

/// A square of people who just touch, in a box. They stand, except `walkers` of them in the first rows, who move at up to
/// `speed`, m/s.
struct Square {
    Scene scene;
    std::vector<BodyId> people;
    static constexpr float radius = 0.2F;
    static constexpr double spacing = 0.4005;

    Square(int side, int walkers, float speed)
    {
        Random random(7);
        for (int i = 0; i < side * side; ++i) {
            BodyDefinition body;
            body.model = BodyModel::planar;
            body.mass = 80;
            body.inertia.zz = 0.5F * body.mass * radius * radius;
            body.position = {spacing * (i % side), spacing * (i / side), 0};
            if (i < walkers) {
                body.position.y -= 2;
                body.linear_velocity = {speed * static_cast<float>(random.symmetric()),
                                        speed * static_cast<float>(random.symmetric()), 0};
            }
            people.push_back(scene.add_body(body));
        }
        const std::vector<DiscDefinition> discs(people.size(), DiscDefinition{radius});
        scene.set_discs(people, std::span<const DiscDefinition>(discs));
        const double low = -0.3, high = spacing * (side - 1) + 0.3, bottom = low - (walkers > 0 ? 2 : 0);
        const Vec2<double> corners[] = {{low, bottom}, {high, bottom}, {high, high}, {low, high}};
        scene.add_wall({.points = corners, .closed = true});
        // Who walks does so in a lane of its own.
        if (walkers > 0 && walkers < side * side) {
            const Vec2<double> ends[] = {{low, -0.9}, {high, -0.9}};
            scene.add_wall({.points = ends});
        }
    }
};

struct Case {
    std::string name;
    std::function<SleepLine()> run;
};

std::vector<Case> all_cases(const SleepOptions& options)
{
    const int all = options.side * options.side;
    const auto crowd = [&options](int walkers, bool sleeps) {
        Square square(options.side, walkers, 1.3F);
        return measure(square.scene, {}, options, sleeps);
    };
    const auto steered = [&options] {
        Square square(options.side, 0, 0);
        const std::vector<Vec3<float>> forces(square.people.size());
        return measure(square.scene, {}, options, true,
                       [&] { square.scene.set_forces(square.people, std::span<const Vec3<float>>(forces)); });
    };
    const auto listed = [&options](bool sleeps) {
        const auto net = make_net(contact_tie(0.5F), BodyModel::planar, options.net);
        for (Contact& contact : net->contacts) contact.separation = 0;
        return measure(net->scene, net->contacts, options, sleeps);
    };
    return {
        {"all walk, nobody may sleep", [=] { return crowd(all, false); }},
        {"all walk, all may sleep", [=] { return crowd(all, true); }},
        {"all stand, nobody may sleep", [=] { return crowd(0, false); }},
        {"all sleep", [=] { return crowd(0, true); }},
        {"all sleep, forces written in every step", steered},
        {"a row walks, the others sleep", [=, &options] { return crowd(options.side, true); }},
        {"listed contacts at rest, nobody may sleep", [=] { return listed(false); }},
        {"listed contacts, all sleep", [=] { return listed(true); }},
    };
}

}  // namespace

std::vector<SleepLine> measure_sleep(const SleepOptions& options)
{
    const std::vector<Case> cases = all_cases(options);
    std::vector<std::vector<double>> seconds(cases.size());
    std::vector<SleepLine> lines(cases.size());
    for (int round = 0; round < options.rounds; ++round) {
        for (std::size_t i = 0; i < cases.size(); ++i) {
            lines[i] = cases[i].run();
            seconds[i].push_back(lines[i].seconds);
        }
    }
    for (std::size_t i = 0; i < cases.size(); ++i) {
        lines[i].name = cases[i].name;
        lines[i].seconds = median(seconds[i]);
    }
    return lines;
}

std::string table_of(const std::vector<SleepLine>& lines)
{
    std::string text = fmt::format("{:<44}{:>10}{:>12}{:>10}\n", "", "ms a step", "contacts", "asleep");
    for (const SleepLine& line : lines)
        text += fmt::format("{:<44}{:10.3f}{:12}{:10}\n", line.name, line.seconds * 1e3, line.contacts,
                            line.asleep);
    return text;
}

}  // namespace motley::bench
