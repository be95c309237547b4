// All locks solved at once in lanes. Independent evidence: Method::direct, a sparse system of the whole scene in
// double whose elimination shares nothing with the tree's; conservation laws; and mass ratios at which sweeps fail.
#include <gtest/gtest.h>

#include <cstdio>

#include "joint_cases.h"
#include "momentum_rounding.h"
#include "rig.h"
#include "scene/scene_core.h"
#include "stores/joint_store.h"

namespace motley {
namespace {

using testing::box;
using testing::frame_time;
using testing::Random;

SolverSettings exact_settings(int substeps = 4)
{
    SolverSettings settings = testing::with_gravity({0, -9.81F, 0});
    settings.exact_joints = true;
    settings.substeps = substeps;
    return settings;
}

Quat<float> random_rotation(Random& random)
{
    Quat<float> q;
    q.x = static_cast<float>(random.symmetric());
    q.y = static_cast<float>(random.symmetric());
    q.z = static_cast<float>(random.symmetric());
    q.w = 1.5F;
    const float scale = 1 / std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
    return {scale * q.x, scale * q.y, scale * q.z, scale * q.w};
}

template <class Definition>
void tie(Scene& scene, BodyId a, BodyId b, Vec3<double> at, const Quat<float>& turn)
{
    const auto arm = [&](BodyId body) { return convert<float>(at - scene.state(body).position); };
    if constexpr (requires(Definition d) { d.frame_a; }) {
        scene.add_joint(Definition{a, b, {arm(a), turn}, {arm(b), turn}});
    } else {
        scene.add_joint(Definition{a, b, arm(a), arm(b)});
    }
}

struct Tree {
    Scene scene;
    std::vector<BodyId> ids;
    std::vector<double> masses;  ///< inertia is that of testing::box
};

/// A tree of eight bodies with three branches and mass ratios up to 100, on the ground or floating. Every joint has
/// this type; body a is in turn the nearer and the farther one. At first the joints have no error, and everything
/// moves.
template <class Definition>
Tree tree_of(bool floats, std::uint64_t seed)
{
    static constexpr int hangs_on[] = {-1, 0, 1, 1, 3, 0, 5, 6};
    Tree tree;
    Random random(seed);
    std::vector<Vec3<double>> places;
    for (const int near : hangs_on) {
        Vec3<double> at = near < 0 ? Vec3<double>{} : places[static_cast<std::size_t>(near)];
        at.x += 0.6 + 0.3 * random.symmetric();
        at.y += 0.5 * random.symmetric();
        at.z += 0.5 * random.symmetric();
        places.push_back(at);
        BodyDefinition body = box(at, static_cast<float>(std::pow(10.0, random.symmetric())));
        body.linear_velocity = {static_cast<float>(random.symmetric()), 1, 0};
        body.angular_velocity = {0, static_cast<float>(random.symmetric()), 2};
        tree.masses.push_back(static_cast<double>(body.mass));
        tree.ids.push_back(tree.scene.add_body(body));
    }
    for (std::size_t i = 0; i < places.size(); ++i) {
        if (i == 0 && floats) continue;
        const auto near = static_cast<std::size_t>(i == 0 ? 0 : hangs_on[i]);
        const BodyId on = i == 0 ? tree.scene.ground() : tree.ids[near];
        const Vec3<double> from = i == 0 ? Vec3<double>{} : places[near];
        const Vec3<double> at = 0.5 * (from + places[i]);
        const Quat<float> turn = random_rotation(random);
        if (i % 2 == 0) {
            tie<Definition>(tree.scene, on, tree.ids[i], at, turn);
        } else {
            tie<Definition>(tree.scene, tree.ids[i], on, at, turn);
        }
    }
    return tree;
}

double speed_difference(const Scene& x, const Scene& y, std::span<const BodyId> ids)
{
    double most = 0;
    for (const BodyId id : ids) {
        const BodyState s = x.state(id), t = y.state(id);
        const Vec3<float> dv = s.linear_velocity - t.linear_velocity;
        const Vec3<float> dw = s.angular_velocity - t.angular_velocity;
        most = std::max(
            {most, static_cast<double>(std::sqrt(dot(dv, dv))), static_cast<double>(std::sqrt(dot(dw, dw)))});
    }
    return most;
}

template <class Definition>
class ExactLocks : public ::testing::Test {
};
using Locks = ::testing::Types<BallSocketDefinition, FixedDefinition, HingeDefinition, SliderDefinition,
                               PointOnPlaneDefinition, PointOnLineDefinition, RotationLockDefinition,
                               ParallelAxesDefinition, PerpendicularAxesDefinition>;
TYPED_TEST_SUITE(ExactLocks, Locks);

TYPED_TEST(ExactLocks, OneStepHasTheVelocitiesOfTheSimultaneousSolutionInDouble)
{
    SolverSettings settings = exact_settings(1);
    settings.relaxations = 0;
    SolverSettings direct = settings;
    direct.method = Method::direct;
    direct.drift_correction = DriftCorrection::none;
    for (const bool floats : {false, true}) {
        for (std::uint64_t seed = 1; seed <= 10; ++seed) {
            Tree lanes = tree_of<TypeParam>(floats, seed);
            Scene truth = lanes.scene;
            Solver solver(settings), reference(direct);
            solver.step(lanes.scene, frame_time);
            reference.step(truth, frame_time);
            // Bound: float rounding of speeds of about 2, times a condition number of a few hundred from mass ratios
            // of 100.
            EXPECT_LT(speed_difference(lanes.scene, truth, lanes.ids), 2e-4)
                << "seed " << seed << ", floats " << floats;
        }
    }
}

TYPED_TEST(ExactLocks, FloatingTreesKeepTheirMomenta)
{
    SolverSettings settings = exact_settings();
    settings.gravity = {};
    Tree tree = tree_of<TypeParam>(true, 3);
    double squares = 0;
    const auto momenta = [&](Vec3<double>& linear, Vec3<double>& angular) {
        linear = angular = {};
        squares = 0;
        for (std::size_t i = 0; i < tree.ids.size(); ++i) {
            const double mass = tree.masses[i];
            const BodyState s = tree.scene.state(tree.ids[i]);
            const Vec3<double> v = convert<double>(s.linear_velocity);
            const Vec3<double> w = rotate(conjugate(s.orientation), convert<double>(s.angular_velocity));
            const Vec3<double> spin =
                rotate(s.orientation, mass * Vec3<double>{static_cast<double>(0.1F) * w.x,
                                                          static_cast<double>(0.2F) * w.y, 0.25 * w.z});
            linear = linear + mass * v;
            angular = angular + mass * cross(s.position, v) + spin;
            const double turning =
                mass * std::sqrt(dot(s.position, s.position) * dot(v, v)) + std::sqrt(dot(spin, spin));
            squares += turning * turning;
        }
    };
    Vec3<double> linear, angular, linear_after, angular_after;
    Solver solver(settings);
    solver.step(tree.scene, frame_time);  // removes the velocity error of the locks
    momenta(linear, angular);
    for (int step = 0; step < 60; ++step) solver.step(tree.scene, frame_time);
    momenta(linear_after, angular_after);
    const auto off = [](const Vec3<double>& u, const Vec3<double>& v) {
        return std::sqrt(dot(u - v, u - v));
    };
    // Bound: about 25 kg at 1 m/s, in 240 substeps that each round to 1e-7 of that.
    EXPECT_LT(off(linear, linear_after), 25 * 240 * 1e-7);
    // A substep stores velocities after gravity, the warm start, the solution and its relaxation.
    const double rounding = testing::rounding_of_momenta(240 * 4, squares);
    EXPECT_LT(off(angular, angular_after), rounding);
}

/// Ten links of 1 kg and a load, hanging straight down or level.
Scene loaded_chain(float load, bool level, ConstraintId* top = nullptr)
{
    Scene scene;
    BodyId before = scene.ground();
    Vec3<float> hook{};
    for (int i = 0; i <= 10; ++i) {
        const bool last = i == 10;
        const double along = last ? 5.5 : 0.25 + 0.5 * i;
        BodyDefinition body;
        body.position = level ? Vec3<double>{along, 0, 0} : Vec3<double>{0, -along, 0};
        body.mass = last ? load : 1;
        body.inertia = level ? Sym3<float>{0.005F, 0, 0, 0.02333F, 0, 0.02333F}
                             : Sym3<float>{0.02333F, 0, 0, 0.005F, 0, 0.02333F};
        if (last) body.inertia = {0.1F * load, 0, 0, 0.1F * load, 0, 0.1F * load};
        const BodyId link = scene.add_body(body);
        const float half = last ? 0.5F : 0.25F;
        const Vec3<float> up = level ? Vec3<float>{-half, 0, 0} : Vec3<float>{0, half, 0};
        const ConstraintId joint = scene.add_joint(BallSocketDefinition{before, link, hook, up});
        if (i == 0 && top != nullptr) *top = joint;
        hook = -up;
        before = link;
    }
    return scene;
}

TEST(ExactJoints, LightChainsHoldHeavyLoadsForAMinute)
{
    for (const float load : {1e3F, 1e6F}) {
        for (const bool level : {false, true}) {
            Scene scene = loaded_chain(load, level);
            Solver solver(exact_settings());
            double worst = 0;
            for (int step = 0; step < testing::long_run(3600); ++step) {
                const StepReport report = solver.step(scene, frame_time);
                ASSERT_EQ(report.status, StepStatus::done);
                ASSERT_EQ(report.bodies_contained, 0) << step;
                worst = std::max(worst, scene.errors().joint_separation_rms);
            }
            std::printf("%g kg on 1 kg links, %s: worst rms separation %.2g m\n", static_cast<double>(load),
                        level ? "from level" : "hanging", worst);
            EXPECT_LT(worst, 1e-3) << load << (level ? " level" : " hanging");
        }
    }
}

TEST(ExactJoints, AHangingChainBearsItsLoadInEveryJoint)
{
    // Statics: the topmost joint carries all 1,010 kg.
    ConstraintId top;
    Scene scene = loaded_chain(1000, false, &top);
    Solver solver(exact_settings());
    for (int step = 0; step < 10; ++step) solver.step(scene, frame_time);
    const Vec3<float> force = scene.joint_report(top).force;
    EXPECT_NEAR(std::sqrt(dot(force, force)), 1010 * 9.81F, 1010 * 9.81F * 1e-3F);
}

/// A net of side x side boxes with unit spacing, tied to their neighbours; one corner is tied to the world.
template <class Definition>
Tree net(int side)
{
    Tree tree;
    const auto place = [&](std::size_t i) { return tree.scene.state(tree.ids[i]).position; };
    for (int i = 0; i < side * side; ++i)
        tree.ids.push_back(tree.scene.add_body(
            box({1.0 * (i % side), 1.0 * (i / side), 0}, 1 + 0.2F * static_cast<float>(i))));
    const auto join = [&](int a, int b) {
        const auto u = static_cast<std::size_t>(a), v = static_cast<std::size_t>(b);
        tie<Definition>(tree.scene, tree.ids[u], tree.ids[v], 0.5 * (place(u) + place(v)),
                        testing::axis_along(2));
    };
    for (int i = 0; i < side * side; ++i) {
        if (i % side + 1 < side) join(i, i + 1);
        if (i / side + 1 < side) join(i, i + side);
    }
    tie<Definition>(tree.scene, tree.scene.ground(), tree.ids[0], {-0.5, 0, 0}, testing::axis_along(2));
    return tree;
}

TEST(ExactJoints, LoopsCloseExactly)
{
    // Four boxes in a ring of ball-sockets, without redundant rows.
    Tree lanes = net<BallSocketDefinition>(2);
    for (std::size_t i = 0; i < lanes.ids.size(); ++i)
        lanes.scene.set_velocity(lanes.ids[i], {0.3F, -0.2F * static_cast<float>(i), 0.5F},
                                 {1, static_cast<float>(i), 0});
    Scene truth = lanes.scene;
    SolverSettings settings = exact_settings(1);
    settings.relaxations = 0;
    SolverSettings direct = settings;
    direct.method = Method::direct;
    direct.drift_correction = DriftCorrection::none;
    Solver(settings).step(lanes.scene, frame_time);
    Solver(direct).step(truth, frame_time);
    EXPECT_LT(speed_difference(lanes.scene, truth, lanes.ids), 1e-4);

    Solver solver(exact_settings());
    double worst = 0;
    for (int step = 0; step < 300; ++step) {
        solver.step(lanes.scene, frame_time);
        worst = std::max(worst, lanes.scene.errors().joint_separation_rms);
    }
    std::printf("ring of four: worst rms separation %.2g m in 5 s\n", worst);
    EXPECT_LT(worst, 1e-3);
}

TEST(ExactJoints, RedundantLoopsOfHingesHoldAndMove)
{
    // Four parallel hinges close a loop with five rows where two are enough. The ring must still be able to fold,
    // which one rigid body on a hinge could not. Motion out of its plane is rounding.
    Tree ring = net<HingeDefinition>(2);
    Solver solver(exact_settings());
    double worst = 0, across = 0, moved = 0;
    for (int step = 0; step < 300; ++step) {
        const StepReport report = solver.step(ring.scene, frame_time);
        ASSERT_EQ(report.bodies_contained, 0);
        worst = std::max(worst, ring.scene.errors().joint_separation_rms);
        for (const BodyId id : ring.ids) {
            across = std::max(across, std::abs(ring.scene.state(id).position.z));
            moved = std::max(moved, std::abs(ring.scene.state(id).position.x - 0.5));
        }
    }
    std::printf("ring of four hinges: worst rms separation %.2g m, %.2g m out of its plane\n", worst, across);
    EXPECT_LT(worst, 1e-3);
    EXPECT_LT(across, 1e-4);
    EXPECT_GT(moved, 0.2);
}

TEST(ExactJoints, NetsOfManyLoopsAreLeftToSweeps)
{
    Scene asked = net<BallSocketDefinition>(5).scene, plain = asked;
    SolverSettings swept = exact_settings();
    swept.exact_joints = false;
    Solver solver(exact_settings()), sweeper(swept);
    for (int step = 0; step < 30; ++step) {
        solver.step(asked, frame_time);
        sweeper.step(plain, frame_time);
    }
    EXPECT_EQ(asked.state_hash(), plain.state_hash());
}

TEST(ExactJoints, AUniversalJointOfTwoLocksIsOneNode)
{
    Scene scene;
    const BodyId shaft = scene.add_body(box({0.5, 0, 0}));
    const BodyId driven = scene.add_body(box({1.5, 0, 0}));
    tie<HingeDefinition>(scene, scene.ground(), shaft, {}, {0, 0, 0, 1});
    tie<BallSocketDefinition>(scene, shaft, driven, {1, 0, 0}, {});
    tie<PerpendicularAxesDefinition>(scene, driven, shaft, {1, 0, 0}, testing::axis_along(2));
    scene.set_velocity(shaft, {}, {3, 0, 0});
    Solver solver(exact_settings());
    for (int step = 0; step < 300; ++step) solver.step(scene, frame_time);
    EXPECT_LT(scene.errors().joint_separation_max, 2e-4);
    EXPECT_LT(scene.errors().joint_angle_max, 2e-3);
}

TEST(ExactJoints, ASwingingChainKeepsItsEnergy)
{
    // Ten links fall from level for ten seconds, at 16 substeps: a chaotic whip. It must not gain energy, and its
    // loss is bounded by a share of what the fall gives (the chain's weight times half its length).
    Scene scene = loaded_chain(1, true);
    std::vector<BodyId> ids;
    core_of(scene).joints->for_each([&](const auto& store, int) {
        for (const auto& joint : store.definitions) ids.push_back(joint.body_b);
    });
    const auto energy = [&] {
        double sum = scene.errors().kinetic_energy;
        for (const BodyId id : ids) sum += 9.81 * scene.state(id).position.y;
        return sum;
    };
    const double before = energy(), fall = 9.81 * 11 * 2.75;
    Solver solver(exact_settings(16));
    double most = -1e9, least = 1e9;
    for (int step = 0; step < testing::long_run(600); ++step) {
        solver.step(scene, frame_time);
        most = std::max(most, energy() - before);
        least = std::min(least, energy() - before);
    }
    std::printf("a falling chain's energy: from %.3f to %.3f of what fell\n", least / fall, most / fall);
    EXPECT_LT(most, 0.01 * fall);
    EXPECT_GT(least, -0.5 * fall);
}

}  // namespace
}  // namespace motley
