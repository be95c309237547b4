// Kernels by themselves: every constraint, instruction set and size, colouring full and incremental, and the hand-over
// between stages. Run it on a quiet machine: motley_benchmarks --benchmark_repetitions=5
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include "motley/motley.h"
#include "stage_runner.h"

namespace motley::bench {
namespace {

/// A square net of bodies, each tied to the one on its right and the one above.
struct Net {
    Scene scene;
    std::vector<BodyId> bodies;
    std::vector<Contact> contacts;

    explicit Net(int side, BodyModel model)
    {
        for (int i = 0; i < side * side; ++i) {
            BodyDefinition body{.model = model, .mass = 1};
            body.position = {0.4 * (i % side), 0.4 * (i / side), 0};
            body.inertia = {0.02F, 0, 0, 0.02F, 0, 0.02F};
            bodies.push_back(scene.add_body(body));
        }
    }
    /// Calls tie(a, b, arm) for each pair; the arm leads from a's centre to the point between them.
    template <class Tie>
    void for_each_pair(int side, const Tie& tie)
    {
        for (int i = 0; i < side * side; ++i) {
            const auto a = static_cast<std::size_t>(i);
            if (i % side + 1 < side) tie(bodies[a], bodies[a + 1], Vec3<float>{0.2F, 0, 0});
            if (i / side + 1 < side)
                tie(bodies[a], bodies[a + static_cast<std::size_t>(side)], Vec3<float>{0, 0.2F, 0});
        }
    }
};

enum class Tie {
    smooth_contact,
    friction_contact,
    ball_socket,
    rod,
    fixed,
    hinge,
    slider,
    twist_drive,
    swing_limit
};

std::unique_ptr<Net> make_net(Tie kind, BodyModel model, int side)
{
    auto net = std::make_unique<Net>(side, model);
    std::uint64_t key = 0;
    net->for_each_pair(side, [&](BodyId a, BodyId b, Vec3<float> arm) {
        if (kind == Tie::ball_socket) {
            net->scene.add_joint(BallSocketDefinition{a, b, arm, -arm});
        } else if (kind == Tie::fixed) {
            net->scene.add_joint(FixedDefinition{a, b, {arm}, {-arm}});
        } else if (kind == Tie::hinge) {
            net->scene.add_joint(HingeDefinition{a, b, {arm}, {-arm}});
        } else if (kind == Tie::slider) {
            net->scene.add_joint(SliderDefinition{a, b, {arm}, {-arm}});
        } else if (kind == Tie::twist_drive) {
            TwistDriveDefinition drive{.body_a = a, .body_b = b, .lower = -1, .upper = 1};
            drive.motor_speed = 1;
            drive.motor_max_force = 1;
            drive.spring_hertz = 2;
            net->scene.add_joint(drive);
        } else if (kind == Tie::swing_limit) {
            net->scene.add_joint(SwingLimitDefinition{.body_a = a, .body_b = b, .max_angle = 0.5F});
        } else if (kind == Tie::rod) {
            net->scene.add_joint(
                DistanceDefinition{.body_a = a, .body_b = b, .min_length = 0.4F, .max_length = 0.4F});
        } else {
            Contact contact;
            contact.body_a = a;
            contact.body_b = b;
            contact.key = key++;
            contact.normal = 5.0F * arm;
            contact.separation = -0.001F;
            contact.arm_a = arm;
            contact.arm_b = -arm;
            contact.friction = kind == Tie::friction_contact ? 0.5F : 0;
            net->contacts.push_back(contact);
        }
    });
    return net;
}

/// One sweep of `solve` over every constraint, from the solver's own clock: the maths, gathers and scatters, and the
/// hand-over between colours.
void sweep(benchmark::State& state, Tie kind, BodyModel model, Isa isa, int threads, int side)
{
    const auto net = make_net(kind, model, side);
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

/// The colour stage, intake included: of a scene never seen, or of the same contacts again.
void colour(benchmark::State& state, bool again, int threads, int side)
{
    auto net = make_net(Tie::smooth_contact, BodyModel::planar, side);
    Solver solver({}, {.threads = threads});
    solver.step(net->scene, 1e-3F, net->contacts);
    for (auto _ : state) {
        if (!again) {
            state.PauseTiming();
            net = make_net(Tie::smooth_contact, BodyModel::planar, side);
            state.ResumeTiming();
        }
        const StepReport report = solver.step(net->scene, 1e-3F, net->contacts);
        state.SetIterationTime(report.seconds[static_cast<std::size_t>(Stage::colour)]);
    }
    using benchmark::Counter;
    const auto constraints = static_cast<double>(net->contacts.size());
    state.counters["s_per_constraint"] =
        Counter(constraints * static_cast<double>(state.iterations()), Counter::kIsRate | Counter::kInvert);
}

/// A stage whose chunks do nothing: what a colour costs beyond its constraints.
void hand_over(benchmark::State& state)
{
    struct Lender final : Executor {
        Solver solver{{}, {.threads = 2}};
        [[nodiscard]] int concurrency() const override { return 2; }
        void run(int workers, const std::function<void(int)>& job) override
        {
            solver.executor().run(workers, job);
        }
    } lender;
    StageRunner runner(&lender);
    runner.with_workers([&] {
        for (auto _ : state) runner.run(2, [](std::int64_t i) { benchmark::DoNotOptimize(i); });
    });
}

void enter_all()
{
    struct Named {
        const char* name;
        Tie tie;
        BodyModel model;
    };
    const Named kinds[] = {{"smooth_contact/planar", Tie::smooth_contact, BodyModel::planar},
                           {"smooth_contact/particle", Tie::smooth_contact, BodyModel::particle},
                           {"smooth_contact/rigid", Tie::smooth_contact, BodyModel::rigid},
                           {"contact/planar", Tie::friction_contact, BodyModel::planar},
                           {"contact/rigid", Tie::friction_contact, BodyModel::rigid},
                           {"ball_socket/planar", Tie::ball_socket, BodyModel::planar},
                           {"ball_socket/rigid", Tie::ball_socket, BodyModel::rigid},
                           {"rod/planar", Tie::rod, BodyModel::planar},
                           {"rod/rigid", Tie::rod, BodyModel::rigid},
                           {"fixed/rigid", Tie::fixed, BodyModel::rigid},
                           {"hinge/rigid", Tie::hinge, BodyModel::rigid},
                           {"slider/rigid", Tie::slider, BodyModel::rigid},
                           {"twist_drive/rigid", Tie::twist_drive, BodyModel::rigid},
                           {"swing_limit/rigid", Tie::swing_limit, BodyModel::rigid}};
    // 4,000 constraints stay in a second level cache, 320,000 do not.
    const std::pair<const char*, int> sizes[] = {{"in_cache", 45}, {"streaming", 400}};
    for (const auto& [place, side] : sizes) {
        for (const Named& kind : kinds) {
            for (const Isa isa : available_isas()) {
                benchmark::RegisterBenchmark(
                    fmt::format("sweep/{}/{}/{}", kind.name, place, isa_name(isa)).c_str(),
                    [kind, isa, size = side](benchmark::State& s) {
                        sweep(s, kind.tie, kind.model, isa, 1, size);
                    })
                    ->UseManualTime()
                    ->Unit(benchmark::kMicrosecond);
            }
        }
        for (const int threads : {1, 2}) {
            for (const bool again : {false, true}) {
                benchmark::RegisterBenchmark(
                    fmt::format("colour/{}/{}/threads:{}", again ? "again" : "full", place, threads).c_str(),
                    [again, threads, size = side](benchmark::State& s) { colour(s, again, threads, size); })
                    ->UseManualTime()
                    ->Unit(benchmark::kMicrosecond);
            }
        }
    }
    benchmark::RegisterBenchmark("hand_over/threads:2", hand_over);
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
