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

/// What ties two bodies; the arm leads from the centre of a to the point between them.
using Tie = std::function<void(Net&, BodyId a, BodyId b, Vec3<float> arm)>;

std::unique_ptr<Net> make_net(const Tie& tie, BodyModel model, int side)
{
    auto net = std::make_unique<Net>(side, model);
    net->for_each_pair(side, [&](BodyId a, BodyId b, Vec3<float> arm) { tie(*net, a, b, arm); });
    return net;
}

Tie contact(float friction)
{
    return [friction](Net& net, BodyId a, BodyId b, Vec3<float> arm) {
        Contact contact;
        contact.body_a = a;
        contact.body_b = b;
        contact.key = net.contacts.size();
        contact.normal = 5.0F * arm;
        contact.separation = -0.001F;
        contact.arm_a = arm;
        contact.arm_b = -arm;
        contact.friction = friction;
        net.contacts.push_back(contact);
    };
}

/// A joint between frames where the bodies meet; `fill` sets what is its own.
template <class Definition>
Tie frames(void (*fill)(Definition&) = [](Definition&) {})
{
    return [fill](Net& net, BodyId a, BodyId b, Vec3<float> arm) {
        Definition joint;
        joint.body_a = a;
        joint.body_b = b;
        joint.frame_a.position = arm;
        joint.frame_b.position = -arm;
        fill(joint);
        net.scene.add_joint(joint);
    };
}

/// A joint between two bodies; `fill` sets what is its own.
template <class Definition>
Tie joint(void (*fill)(Definition&, Vec3<float> arm) = [](Definition&, Vec3<float>) {})
{
    return [fill](Net& net, BodyId a, BodyId b, Vec3<float> arm) {
        Definition joint;
        joint.body_a = a;
        joint.body_b = b;
        fill(joint, arm);
        net.scene.add_joint(joint);
    };
}

template <class Definition>
void everything(Definition& drive)
{
    drive.lower = -1;
    drive.upper = 1;
    drive.motor_speed = 1;
    drive.motor_max_force = 1;
    drive.spring_hertz = 2;
}

template <class Definition>
void at_anchors(Definition& joint, Vec3<float> arm)
{
    joint.local_anchor_a = arm;
    joint.local_anchor_b = -arm;
}

/// Six degrees of freedom set up as a hinge.
void six_dof_hinge(Net& net, BodyId a, BodyId b, Vec3<float> arm)
{
    SixDofDefinition six;
    six.body_a = a;
    six.body_b = b;
    six.frame_a.position = arm;
    six.frame_b.position = -arm;
    six.rotation[0] = AxisSetup::free();
    add_six_dof(net.scene, six);
}

struct NamedTie {
    const char* name;
    BodyModel model;
    Tie tie;
};

std::vector<NamedTie> every_tie()
{
    const auto planar = BodyModel::planar, rigid = BodyModel::rigid;
    const Tie rod = joint<DistanceDefinition>(
        [](DistanceDefinition& j, Vec3<float>) { j.min_length = j.max_length = 0.4F; });
    const Tie strut = joint<DistanceDefinition>([](DistanceDefinition& j, Vec3<float>) {
        j.min_length = 0.3F;
        j.max_length = 0.5F;
        j.rest_length = 0.4F;
        j.spring_hertz = 2;
    });
    return {{"smooth_contact/planar", planar, contact(0)},
            {"smooth_contact/particle", BodyModel::particle, contact(0)},
            {"smooth_contact/rigid", rigid, contact(0)},
            {"contact/planar", planar, contact(0.5F)},
            {"contact/rigid", rigid, contact(0.5F)},
            {"ball_socket/planar", planar, joint<BallSocketDefinition>(at_anchors<BallSocketDefinition>)},
            {"ball_socket/rigid", rigid, joint<BallSocketDefinition>(at_anchors<BallSocketDefinition>)},
            {"rod/planar", planar, rod},
            {"rod/rigid", rigid, rod},
            {"strut/rigid", rigid, strut},
            {"fixed/rigid", rigid, frames<FixedDefinition>()},
            {"hinge/rigid", rigid, frames<HingeDefinition>()},
            {"six_dof_hinge/rigid", rigid, six_dof_hinge},
            {"slider/rigid", rigid, frames<SliderDefinition>()},
            {"point_on_plane/rigid", rigid, frames<PointOnPlaneDefinition>()},
            {"point_on_line/rigid", rigid, frames<PointOnLineDefinition>()},
            {"rotation_lock/rigid", rigid, frames<RotationLockDefinition>()},
            {"parallel_axes/rigid", rigid, frames<ParallelAxesDefinition>()},
            {"perpendicular_axes/rigid", rigid, frames<PerpendicularAxesDefinition>()},
            {"slide_drive/rigid", rigid, frames<SlideDriveDefinition>(everything<SlideDriveDefinition>)},
            {"twist_drive/rigid", rigid, frames<TwistDriveDefinition>(everything<TwistDriveDefinition>)},
            {"swing_limit/rigid", rigid, frames<SwingLimitDefinition>()},
            {"point_servo/rigid", rigid, joint<PointServoDefinition>(at_anchors<PointServoDefinition>)},
            {"angular_servo/rigid", rigid, frames<AngularServoDefinition>()},
            {"gear/rigid", rigid, joint<GearDefinition>()},
            {"rack_and_pinion/rigid", rigid, joint<RackAndPinionDefinition>()},
            {"pulley/rigid", rigid, joint<PulleyDefinition>([](PulleyDefinition& pulley, Vec3<float> arm) {
                 at_anchors(pulley, arm);
                 pulley.point_a = {-1, 30, 0};
                 pulley.point_b = {1, 30, 0};
                 pulley.max_length = 40;
             })},
            {"manifold/rigid", rigid, joint<ManifoldDefinition>([](ManifoldDefinition& m, Vec3<float> arm) {
                 m.normal = arm;
                 m.point_count = 4;
                 for (int i = 0; i < 4; ++i) {
                     const Vec3<float> off{0.1F * arm.y * static_cast<float>(i % 2),
                                           0.1F * arm.x * static_cast<float>(i % 2),
                                           0.05F * static_cast<float>(i / 2)};
                     m.points[i] = {arm + off, off - arm};
                 }
                 m.friction = 0.5F;
                 m.torsional_radius = 0.1F;
                 m.rolling_radius = 0.01F;
             })}};
}

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

/// The colour stage, intake included: of a scene never seen, or of the same contacts again.
void colour(benchmark::State& state, bool again, int threads, int side)
{
    auto net = make_net(contact(0), BodyModel::planar, side);
    Solver solver({}, {.threads = threads});
    solver.step(net->scene, 1e-3F, net->contacts);
    for (auto _ : state) {
        if (!again) {
            state.PauseTiming();
            net = make_net(contact(0), BodyModel::planar, side);
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
    // 4,000 constraints stay in a second level cache, 320,000 do not.
    const std::pair<const char*, int> sizes[] = {{"in_cache", 45}, {"streaming", 400}};
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
