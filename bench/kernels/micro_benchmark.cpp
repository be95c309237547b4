// Kernels by themselves: every constraint, instruction set and size; full and incremental colouring; and the
// hand-over between stages. Run it on a quiet machine: motley_benchmarks --benchmark_repetitions=5
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numeric>
#include <random>
#include <string_view>
#include <utility>
#include <vector>

#include "kernels/transfer.h"
#include "measuring/host.h"
#include "motley/motley.h"
#include "stage_runner.h"
#include "worlds/random.h"
#include "worlds/tie_net.h"

namespace motley::bench {
namespace {

/// One sweep of `solve` over every constraint, from the solver's own clock: the maths, gathers and scatters, and the
/// hand-over between colours.
void sweep(benchmark::State& state, const NamedTie& kind, Isa isa, int threads, int side)
{
    const auto net = make_net(kind.tie, kind.model, side);
    constexpr int iterations = 32;
    Solver solver({.substeps = 1, .iterations = iterations, .relaxations = 0},
                  {.threads = threads, .isa = isa});
    StepReport report = solver.step(net->scene, 1e-3F, net->contacts);
    for (auto _ : state) {
        report = solver.step(net->scene, 1e-3F, net->contacts);
        state.SetIterationTime(report.seconds[static_cast<std::size_t>(Stage::solve)]);
    }
    const auto constraints = static_cast<double>(report.contacts + report.joints);
    const auto sweeps = static_cast<double>(state.iterations()) * iterations;
    using benchmark::Counter;
    state.counters["constraints"] = constraints;
    // Shown in seconds with a prefix: 3.1n is 3.1 ns.
    state.counters["s_per_constraint"] = Counter(constraints * sweeps, Counter::kIsRate | Counter::kInvert);
    state.counters["bytes_per_s"] =
        Counter(constraints * sweeps * report.bytes_per_constraint, Counter::kIsRate);
}

/// Times intake or colouring, either of a scene that the solver has not seen or of the same contacts again.
void lay_out(benchmark::State& state, Stage stage, bool again, int threads, int side)
{
    auto net = make_net(contact_tie(0), BodyModel::planar, side);
    Solver solver({}, {.threads = threads});
    solver.step(net->scene, 1e-3F, net->contacts);
    for (auto _ : state) {
        if (!again) {
            state.PauseTiming();
            net = make_net(contact_tie(0), BodyModel::planar, side);
            state.ResumeTiming();
        }
        const StepReport report = solver.step(net->scene, 1e-3F, net->contacts);
        state.SetIterationTime(report.seconds[static_cast<std::size_t>(stage)]);
    }
    using benchmark::Counter;
    const auto constraints = static_cast<double>(net->contacts.size());
    state.counters["s_per_constraint"] =
        Counter(constraints * static_cast<double>(state.iterations()), Counter::kIsRate | Counter::kInvert);
}

/// A step of smooth contacts in a net too large for the caches. Bodies lie in memory in the order of the net or
/// shuffled, and are renumbered or not.
void memory_order(benchmark::State& state, BodyOrder order, bool renumbered)
{
    const auto net = make_net(contact_tie(0), BodyModel::planar, side_streaming, order);
    if (renumbered) net->scene.renumber_bodies();
    Solver solver;
    solver.step(net->scene, 1e-3F, net->contacts);
    for (auto _ : state) solver.step(net->scene, 1e-3F, net->contacts);
    using benchmark::Counter;
    state.counters["s_per_constraint"] =
        Counter(static_cast<double>(net->contacts.size()) * static_cast<double>(state.iterations()),
                Counter::kIsRate | Counter::kInvert);
}

/// Memory of a crowd of a million planar people at 1.12 contacts each: bodies, and what steps keep of contacts. Run
/// it alone (--benchmark_filter=memory/): otherwise it reuses memory that other benchmarks have freed.
void memory(benchmark::State& state)
{
    constexpr int side = 1000;
    constexpr double people = double{side} * side;
    TieNet net;
    const double at_first = resident_bytes();
    net.add_bodies(side, BodyModel::planar);
    const double with_bodies = resident_bytes();
    const Tie touch = contact_tie(0);
    for (std::size_t i = 0; i < net.bodies.size(); ++i) {
        if (i % side + 1 < side) touch(net, net.bodies[i], net.bodies[i + 1], {0.2F, 0, 0});
        if (i + side < net.bodies.size() && i % 8 == 0)
            touch(net, net.bodies[i], net.bodies[i + side], {0, 0.2F, 0});
    }
    const double with_list = resident_bytes();
    Solver solver;
    for (auto _ : state) solver.step(net.scene, 1e-3F, net.contacts);
    state.counters["body_bytes"] = (with_bodies - at_first) / people - sizeof(BodyId);
    state.counters["contact_bytes"] = (resident_bytes() - with_list) / people;
    state.counters["contacts"] = static_cast<double>(net.contacts.size()) / people;
}

/// A step of 10,000 ball-sockets, in a net or in a thousand chains of eleven bodies, after `changed` of them were
/// removed and added again.
void changing_joints(benchmark::State& state, bool in_chains, int changed, bool exact)
{
    Scene scene;
    std::vector<BodyId> bodies;
    std::vector<BallSocketDefinition> definitions;
    const auto tie = [&](std::size_t a, std::size_t b, const Vec3<float>& half) {
        definitions.push_back({bodies[a], bodies[b], half, -half});
    };
    const std::size_t columns = in_chains ? 11 : 71, rows = in_chains ? 1000 : 71;
    for (std::size_t i = 0; i < columns * rows; ++i) {
        bodies.push_back(scene.add_body({.position = {double(i % columns), double(i / columns), 0}}));
        if (i % columns > 0) tie(i - 1, i, {0.5F, 0, 0});
        if (!in_chains && i >= columns) tie(i - columns, i, {0, 0.5F, 0});
    }
    std::vector<ConstraintId> joints;
    for (const BallSocketDefinition& definition : definitions) joints.push_back(scene.add_joint(definition));
    Solver solver({.exact_joints = exact, .gravity = {0, -9.81F, 0}});
    solver.step(scene, 1.0F / 60);
    std::uint32_t random = 1;
    for (auto _ : state) {
        for (int i = 0; i < changed; ++i) {
            random = random * 1664525 + 1013904223;
            const std::size_t joint = (random >> 8) % joints.size();
            scene.remove_joint(joints[joint]);
            joints[joint] = scene.add_joint(definitions[joint]);
        }
        solver.step(scene, 1.0F / 60);
    }
}

/// A thousand ragdolls of eleven bodies, who hang on nothing.
struct Ragdolls {
    static constexpr std::array<int, 11> parents{-1, 0, 1, 1, 3, 1, 5, 0, 7, 0, 9};
    Scene scene;
    std::vector<std::array<BodyId, parents.size()>> figures{1000};
    std::mt19937 random{1};

    Ragdolls()
    {
        for (std::size_t figure = 0; figure < figures.size(); ++figure) add(figure);
    }
    std::size_t any() { return random() % figures.size(); }
    void add(std::size_t figure)
    {
        for (std::size_t i = 0; i < parents.size(); ++i) {
            BodyDefinition definition;
            definition.position = {2.0 * static_cast<double>(figure), -static_cast<double>(i), 0};
            definition.linear_damping = definition.angular_damping = 3;
            figures[figure][i] = scene.add_body(definition);
            if (i == 0) continue;
            const auto parent = static_cast<std::size_t>(parents[i]);
            const Vec3<float> half{0, 0.5F * (static_cast<float>(parent) - static_cast<float>(i)), 0};
            scene.add_joint(BallSocketDefinition{figures[figure][parent], figures[figure][i], half, -half});
        }
    }
};

/// A step of them, after `changed` were removed, their bodies in any order, and as many added. The first thousand steps, in
/// which every one may have been changed, are not timed.
void changing_figures(benchmark::State& state, int changed, bool exact)
{
    Ragdolls ragdolls;
    Solver solver({.exact_joints = exact, .gravity = {0, -9.81F, 0}});
    const auto step = [&] {
        for (int i = 0; i < changed; ++i) {
            const std::size_t figure = ragdolls.any();
            auto& bodies = ragdolls.figures[figure];
            std::shuffle(bodies.begin(), bodies.end(), ragdolls.random);
            for (const BodyId body : bodies) ragdolls.scene.remove_body(body);
            ragdolls.add(figure);
        }
        return solver.step(ragdolls.scene, 1.0F / 60);
    };
    for (int i = 0; i < 1000; ++i) step();
    StepReport report;
    for (auto _ : state) report = step();
    state.counters["in_lockstep"] =
        static_cast<double>(report.joints_in_lockstep) / static_cast<double>(report.joints);
}

/// A step of them at rest without weight, after `pushed` of them got a push, from which each moves for a second.
void resting_figures(benchmark::State& state, int pushed, bool exact)
{
    Ragdolls ragdolls;
    Solver solver({.exact_joints = exact, .sleep_speed = 0.05F, .sleep_after = 0.3F});
    const auto step = [&] {
        for (int i = 0; i < pushed; ++i)
            ragdolls.scene.set_velocity(ragdolls.figures[ragdolls.any()][0], {1, 0, 0.5F}, {0, 1, 0});
        return solver.step(ragdolls.scene, 1.0F / 60);
    };
    for (int i = 0; i < 200; ++i) step();
    std::int64_t asleep = 0;
    for (auto _ : state) asleep += step().bodies_asleep;
    state.counters["asleep"] = static_cast<double>(asleep) / static_cast<double>(state.iterations()) /
                               static_cast<double>(ragdolls.scene.body_count());
}

/// A step of Method::direct at its default substeps: a standing wall of cubes with friction. Each cube has two
/// corners on each of the two cubes below it, or four on the floor, and each contact has three rows.
void direct(benchmark::State& state, int base)
{
    Scene scene;
    std::vector<Contact> contacts;
    const auto stand = [&](BodyId a, BodyId b, Vec3<float> at_a, Vec3<float> at_b) {
        Contact contact;
        contact.body_a = a;
        contact.body_b = b;
        contact.key = contacts.size() + 1;
        contact.normal = {0, 1, 0};
        contact.arm_a = at_a;
        contact.arm_b = at_b;
        contact.friction = 0.5F;
        contacts.push_back(contact);
    };
    std::vector<BodyId> below;
    for (int row = 0; row < base; ++row) {
        std::vector<BodyId> here;
        for (int i = 0; i < base - row; ++i) {
            BodyDefinition cube;
            cube.position = {1.05 * i + 0.525 * row, 0.5 + row, 0};
            cube.inertia = {1.0F / 6, 0, 0, 1.0F / 6, 0, 1.0F / 6};
            here.push_back(scene.add_body(cube));
            for (const float x : {-0.5F, 0.5F}) {
                for (const float z : {-0.5F, 0.5F}) {
                    const BodyId a =
                        row == 0 ? scene.ground() : below[static_cast<std::size_t>(x < 0 ? i : i + 1)];
                    const float side = x < 0 ? 0.025F : -0.025F;
                    const auto left = static_cast<float>(cube.position.x);
                    const Vec3<float> at_a =
                        row == 0 ? Vec3<float>{left + x, 0, z} : Vec3<float>{side, 0.5F, z};
                    stand(a, here.back(), at_a, {x, -0.5F, z});
                }
            }
        }
        below = here;
    }
    SolverSettings settings;
    settings.method = Method::direct;
    settings.gravity = {0, -9.81F, 0};
    Solver solver(settings);
    StepReport report = solver.step(scene, 1.0F / 60, contacts);
    for (auto _ : state) report = solver.step(scene, 1.0F / 60, contacts);
    state.counters["violation"] = report.direct_violation;
    state.counters["unsolved"] = static_cast<double>(report.direct_unsolved);
}

/// A stage whose chunks do nothing: the cost of a colour in addition to its constraints.
void hand_over(benchmark::State& state)
{
    struct Lender final : Executor {
        Solver solver{{}, {.threads = 2}};
        [[nodiscard]] int concurrency() const override { return 2; }
        void run(int workers, Job job) override { solver.executor().run(workers, job); }
    } lender;
    StageRunner runner(&lender);
    runner.with_workers(false, [&] {
        for (auto _ : state) runner.run(2, [](std::int64_t i) { benchmark::DoNotOptimize(i); });
    });
}

#ifdef MOTLEY_HAS_TRANSFER
/// Loads velocity rows of rigid bodies into lanes, in random order, of as many bodies as fit a second level cache.
void transfer(benchmark::State& state, SumRows sum)
{
    constexpr std::int64_t rows = 16384;
    std::vector<float> velocity(8 * rows, 1.0F);
    std::vector<std::int32_t> index(rows);
    std::iota(index.begin(), index.end(), 0);
    shuffle(index);
    for (auto _ : state) benchmark::DoNotOptimize(sum(velocity.data(), index.data(), rows));
    using benchmark::Counter;
    state.counters["s_per_constraint"] =
        Counter(static_cast<double>(rows * state.iterations()), Counter::kIsRate | Counter::kInvert);
}

void enter_transfers()
{
    const auto enter = [](Isa isa, Transfers (*transfers)()) {
        const std::vector<Isa> here = available_isas();
        if (std::find(here.begin(), here.end(), isa) == here.end()) return;
        // Code of that instruction set, so it is called only on machines that have it.
        const Transfers ways = transfers();
        for (const auto& [way, sum] :
             {std::pair{"transpose", ways.by_transpose}, std::pair{"gather", ways.by_gather}}) {
            benchmark::RegisterBenchmark(fmt::format("rows_to_lanes/{}/{}", way, isa_name(isa)).c_str(),
                                         [sum = sum](benchmark::State& s) { transfer(s, sum); });
        }
    };
    enter(Isa::avx2, transfers_avx2);
    enter(Isa::avx512, transfers_avx512);
}
#endif

void enter_all()
{
    // 4,000 constraints fit a second level cache, 320,000 do not.
    const std::pair<const char*, int> sizes[] = {{"in_cache", side_in_cache}, {"streaming", side_streaming}};
    for (const auto& [place, side] : sizes) {
        for (const NamedTie& kind : every_tie()) {
            for (const Isa isa : available_isas()) {
                benchmark::RegisterBenchmark(
                    fmt::format("sweep/{}/{}/{}", kind.name, place, isa_name(isa)).c_str(),
                    [kind, isa, size = side](benchmark::State& s) { sweep(s, kind, isa, 1, size); })
                    ->UseManualTime()
                    ->Unit(benchmark::kMicrosecond);
            }
        }
    }
    // Intake and colouring are also run with a million contacts.
    const std::pair<const char*, int> colour_sizes[] = {sizes[0], sizes[1], {"million", 708}};
    for (const Stage stage : {Stage::intake, Stage::colour}) {
        for (const auto& [place, side] : colour_sizes) {
            for (const int threads : {1, 2}) {
                for (const bool again : {false, true}) {
                    benchmark::RegisterBenchmark(fmt::format("{}/{}/{}/threads:{}", stage_name(stage),
                                                             again ? "again" : "full", place, threads)
                                                     .c_str(),
                                                 [stage, again, threads, size = side](benchmark::State& s) {
                                                     lay_out(s, stage, again, threads, size);
                                                 })
                        ->UseManualTime()
                        ->Unit(benchmark::kMicrosecond);
                }
            }
        }
    }
    const auto enter_order = [](const char* name, BodyOrder order, bool renumbered) {
        benchmark::RegisterBenchmark(name, [order, renumbered](benchmark::State& s) {
            memory_order(s, order, renumbered);
        })->Unit(benchmark::kMicrosecond);
    };
    enter_order("memory_order/in_line", BodyOrder::in_line, false);
    enter_order("memory_order/shuffled", BodyOrder::shuffled, false);
    enter_order("memory_order/shuffled_and_renumbered", BodyOrder::shuffled, true);
    benchmark::RegisterBenchmark("memory/planar_crowd", memory)->Iterations(3)->Unit(benchmark::kMillisecond);
    benchmark::RegisterBenchmark("hand_over/threads:2", hand_over);
    for (const bool exact : {false, true}) {
        const std::string_view joints = exact ? "/exact_joints" : "";
        for (const bool in_chains : {false, true}) {
            for (const int changed : {0, 20}) {
                benchmark::RegisterBenchmark(
                    fmt::format("joints_changed:{}/{}{}", changed, in_chains ? "chains" : "net", joints)
                        .c_str(),
                    [=](benchmark::State& s) { changing_joints(s, in_chains, changed, exact); })
                    ->Unit(benchmark::kMillisecond);
            }
        }
        for (const int changed : {0, 2}) {
            benchmark::RegisterBenchmark(fmt::format("figures_changed:{}{}", changed, joints).c_str(),
                                         [=](benchmark::State& s) { changing_figures(s, changed, exact); })
                ->Unit(benchmark::kMillisecond);
        }
        for (const int pushed : {0, 1, 5}) {
            benchmark::RegisterBenchmark(fmt::format("resting_figures/pushed:{}{}", pushed, joints).c_str(),
                                         [=](benchmark::State& s) { resting_figures(s, pushed, exact); })
                ->Unit(benchmark::kMillisecond);
        }
    }
    for (const int base : {4, 8, 12, 16, 57}) {
        const int rows = 6 * base * (base + 1);  // twelve a cube
        benchmark::RegisterBenchmark(fmt::format("direct/rows:{}", rows).c_str(), [base](
                                                                                      benchmark::State& s) {
            direct(s, base);
        })->Unit(benchmark::kMillisecond);
    }
#ifdef MOTLEY_HAS_TRANSFER
    enter_transfers();
#endif
}

}  // namespace
}  // namespace motley::bench

int main(int argc, char** argv)
{
    motley::bench::enter_all();
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
    benchmark::RunSpecifiedBenchmarks();
    return 0;
}
