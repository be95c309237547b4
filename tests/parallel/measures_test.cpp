// The reported residual of a step, and the tolerance that ends an island's sweeps. Independent evidence: residuals of
// particles, computed by hand from their velocities; the kinetic energy that solving one joint exactly removes, which
// is half of r^T K^-1 r for any joint; and equal bits with measuring on and off.
#include <gtest/gtest.h>

#include <functional>

#include "joint_scene.h"
#include "rig.h"
#include "scene/scene_core.h"

namespace motley {
namespace {

using testing::box;
using testing::frame_time;

/// One sweep of rigid constraints, without gravity or correction of positions: the residual is J v alone.
SolverSettings one_plain_sweep()
{
    SolverSettings settings = testing::weightless_sweeps(1);
    settings.measures = true;
    return settings;
}

TEST(Measures, ResidualOfParticlesIsTheirRelativeVelocity)
{
    Scene scene;
    std::vector<BodyId> ids;
    const float masses[] = {1, 3, 0.5F, 2};
    for (int i = 0; i < 4; ++i) {
        BodyDefinition body{.model = BodyModel::particle, .mass = masses[i]};
        body.linear_velocity = {static_cast<float>(i * i), static_cast<float>(1 - i), 0.5F};
        ids.push_back(scene.add_body(body));
    }
    for (int i = 1; i < 4; ++i) scene.add_joint(BallSocketDefinition{ids[i - 1], ids[i]});
    Solver solver(one_plain_sweep(), {});
    const StepReport report = solver.step(scene, frame_time);
    double energy = 0, squares = 0, largest = 0;
    for (int i = 1; i < 4; ++i) {
        const Vec3<double> r = convert<double>(scene.state(ids[i]).linear_velocity) -
                               convert<double>(scene.state(ids[i - 1]).linear_velocity);
        const double inverse_mass =
            1 / static_cast<double>(masses[i]) + 1 / static_cast<double>(masses[i - 1]);
        energy += dot(r, r) / inverse_mass;
        squares += dot(r, r) / 3;
        largest = std::max(largest, std::sqrt(dot(r, r)));
    }
    ASSERT_GT(largest, 0.1);
    EXPECT_NEAR(report.measures.residual_norm, std::sqrt(energy), 1e-5 * std::sqrt(energy));
    EXPECT_NEAR(report.measures.residual_rms, std::sqrt(squares), 1e-5 * std::sqrt(squares));
    EXPECT_NEAR(report.measures.residual_max, largest, 1e-5 * largest);
}

/// Two joints in a row on bodies with lever arms and uneven inertia. The sweep solves the second joint last, so that
/// the whole residual is the first one's.
template <class Definition>
void expect_residual_is_the_energy_that_solving_takes(BodyModel model)
{
    // A time so short that nothing moves.
    constexpr float instant = 1e-6F;
    const auto make = [&](bool with_second, std::vector<BodyId>& ids) {
        Scene scene;
        for (int i = 0; i < 3; ++i) {
            BodyDefinition body = box({1.0 * i, 0, 0}, 1.5F + static_cast<float>(i));
            body.model = model;
            body.linear_velocity = {0.3F * static_cast<float>(i), 1.0F - static_cast<float>(i),
                                    model == BodyModel::planar ? 0.0F : 0.4F};
            if (model == BodyModel::rigid) body.angular_velocity = {1, -0.5F, 0.7F};
            if (model == BodyModel::planar) body.angular_velocity.z = 0.7F * static_cast<float>(i);
            ids.push_back(scene.add_body(body));
        }
        Definition first{}, second{};
        first.body_a = ids[0];
        first.body_b = ids[1];
        second.body_a = ids[1];
        second.body_b = ids[2];
        if constexpr (requires { first.frame_a; }) {
            first.frame_a.position = second.frame_a.position = {0.5F, 0.1F, 0};
            first.frame_b.position = second.frame_b.position = {-0.5F, 0.1F, 0};
        } else {
            first.local_anchor_a = second.local_anchor_a = {0.5F, 0.1F, 0};
            first.local_anchor_b = second.local_anchor_b = {-0.5F, 0.1F, 0};
        }
        scene.add_joint(first);
        if (with_second) scene.add_joint(second);
        return scene;
    };
    std::vector<BodyId> ids, alone_ids;
    Scene both = make(true, ids), alone = make(false, alone_ids);
    Solver solver(one_plain_sweep(), {});
    const StepReport report = solver.step(both, instant);
    for (int i = 0; i < 3; ++i) {
        const BodyState s = both.state(ids[i]);
        alone.set_velocity(alone_ids[i], s.linear_velocity, s.angular_velocity);
    }
    const double before = alone.errors().kinetic_energy;
    solver.step(alone, instant);
    const double taken = 2 * (before - alone.errors().kinetic_energy);
    ASSERT_GT(taken, 1e-3);
    // Bound: a difference of two energies, with a thousand times the rounding of one.
    EXPECT_NEAR(report.measures.residual_norm * report.measures.residual_norm, taken,
                1e-4 * taken + 1e-6 * before);
}

TEST(Measures, ResidualIsTheEnergyThatSolvingTakesFromRigidBodies)
{
    expect_residual_is_the_energy_that_solving_takes<BallSocketDefinition>(BodyModel::rigid);
    expect_residual_is_the_energy_that_solving_takes<HingeDefinition>(BodyModel::rigid);
    expect_residual_is_the_energy_that_solving_takes<FixedDefinition>(BodyModel::rigid);
    expect_residual_is_the_energy_that_solving_takes<PointOnPlaneDefinition>(BodyModel::rigid);
}
TEST(Measures, ResidualIsTheEnergyThatSolvingTakesFromPlanarBodies)
{
    expect_residual_is_the_energy_that_solving_takes<BallSocketDefinition>(BodyModel::planar);
    expect_residual_is_the_energy_that_solving_takes<FixedDefinition>(BodyModel::planar);
}

TEST(Measures, ResidualOfContactsVanishesAsIterationsGrow)
{
    // Falling balls, friction and a floor: inequalities and cones. A thousand sweeps reach what rounding leaves.
    double last = 0;
    for (const int iterations : {1, 10, 100, 1000, 10000}) {
        if (testing::is_sanitized && iterations > 1000) break;
        testing::MixedScene mixed;
        mixed.restitution = 0;
        SolverSettings settings = one_plain_sweep();
        settings.gravity = {0, -9.81F, 0};
        settings.iterations = 20;
        Solver solver(settings, {});
        for (int step = 0; step < 60; ++step) solver.step(mixed.scene, frame_time, mixed.contacts());
        settings.iterations = iterations;
        solver.set_settings(settings);
        const StepReport report = solver.step(mixed.scene, frame_time, mixed.contacts());
        ASSERT_GT(report.contacts, 10);
        std::printf("%4d iterations: residual %.3g sqrt(J), rms %.3g m/s, max %.3g m/s\n", iterations,
                    report.measures.residual_norm, report.measures.residual_rms,
                    report.measures.residual_max);
        if (iterations > 1 && iterations < 10000) {
            EXPECT_LT(report.measures.residual_norm, last) << iterations;
        }
        last = report.measures.residual_norm;
        // Bound: rounding of speeds of some m/s.
        if (iterations >= 1000) {
            EXPECT_LT(last, 1e-5) << iterations;
        }
    }
}

TEST(Measures, EnergyMomentumAndPenetrationAreOfTheStep)
{
    Scene scene;
    const BodyId ball = scene.add_body({.model = BodyModel::particle, .mass = 2});
    SolverSettings settings;
    settings.gravity = {0, -10, 0};
    settings.measures = true;
    Solver solver(settings, {});
    Contact contact;
    contact.body_a = scene.ground();
    contact.body_b = ball;
    contact.normal = {1, 0, 0};
    contact.separation = -0.01F;
    const StepReport report = solver.step(scene, 0.1F, std::span(&contact, 1));
    EXPECT_DOUBLE_EQ(report.measures.before.kinetic_energy, 0);
    EXPECT_NEAR(report.measures.after.momentum[1] - report.measures.before.momentum[1], -2 * 10 * 0.1, 1e-5);
    EXPECT_NEAR(report.measures.penetration_max, 0.01, 1e-8);
    EXPECT_NEAR(report.measures.penetration_rms, 0.01, 1e-8);
}

/// Hashes of two scenes after every step.
std::vector<std::uint64_t> run(const SolverSettings& settings, const SolverOptions& options)
{
    testing::MixedScene mixed;
    testing::JointScene joints;
    Solver solver(settings, options);
    std::vector<std::uint64_t> hashes;
    for (int step = 0; step < testing::long_run(60); ++step) {
        EXPECT_EQ(solver.step(mixed.scene, frame_time, mixed.contacts()).status, StepStatus::done);
        EXPECT_EQ(solver.step(joints.scene, frame_time).status, StepStatus::done);
        hashes.push_back(mixed.scene.state_hash());
        hashes.push_back(joints.scene.state_hash());
    }
    return hashes;
}

TEST(Measures, MeasuringChangesNoBit)
{
    for (const Method method : {Method::soft_step, Method::sequential_impulse}) {
        SolverSettings settings;
        settings.method = method;
        settings.gravity = {0, -9.81F, 0};
        const auto unmeasured = run(settings, {});
        settings.measures = true;
        EXPECT_EQ(run(settings, {}), unmeasured);
    }
}

TEST(Measures, AreTheSameForAnyThreadsAndInstructionSet)
{
    const auto figures = [](const SolverOptions& options) {
        SolverSettings settings;
        settings.gravity = {0, -9.81F, 0};
        settings.measures = true;
        testing::MixedScene mixed;
        Solver solver(settings, options);
        std::vector<double> all;
        for (int step = 0; step < 30; ++step) {
            const StepMeasures m = solver.step(mixed.scene, frame_time, mixed.contacts()).measures;
            all.insert(all.end(), {m.residual_norm, m.residual_rms, m.residual_max, m.penetration_rms,
                                   m.after.kinetic_energy, m.after.joint_separation_rms});
        }
        return all;
    };
    const auto scalar = figures({.isa = Isa::scalar});
    for (const Isa isa : available_isas()) {
        EXPECT_EQ(figures({.isa = isa}), scalar) << isa_name(isa);
        EXPECT_EQ(figures({.threads = 3, .alone_below = 0, .isa = isa}), scalar) << isa_name(isa);
    }
}

TEST(Tolerance, KeepsTheBitsOfEveryInstructionSetAndThreadCount)
{
    SolverSettings settings;
    settings.gravity = {0, -9.81F, 0};
    settings.iterations = 20;
    settings.relaxations = 5;
    settings.tolerance = 1e-3F;
    const auto scalar = run(settings, {.isa = Isa::scalar});
    for (const Isa isa : available_isas()) {
        EXPECT_EQ(run(settings, {.isa = isa}), scalar) << isa_name(isa);
        EXPECT_EQ(run(settings, {.threads = 3, .alone_below = 0, .isa = isa}), scalar) << isa_name(isa);
    }
}

/// A chain that whips, and unconnected to it pairs of a body and the ground that hang still.
struct WhipAndPairs {
    Scene scene;
    explicit WhipAndPairs(int pairs)
    {
        BodyId before = scene.ground();
        for (int i = 0; i < 12; ++i) {
            BodyDefinition link = box({0.5 * i + 0.25, 0, 0}, 1);
            const BodyId id = scene.add_body(link);
            scene.add_joint(BallSocketDefinition{
                before, id, i == 0 ? Vec3<float>{} : Vec3<float>{0.25F, 0, 0}, {-0.25F, 0, 0}});
            before = id;
        }
        for (int i = 0; i < pairs; ++i) {
            const double x = 10 + i;
            const BodyId id = scene.add_body(box({x, -0.5, 0}, 1));
            scene.add_joint(
                BallSocketDefinition{scene.ground(), id, {static_cast<float>(x), 0, 0}, {0, 0.5F, 0}});
        }
    }
};

TEST(Tolerance, EndsSweepsWhenEveryIslandIsSolved)
{
    WhipAndPairs whip(3);
    SolverSettings settings = one_plain_sweep();
    settings.gravity = {0, -9.81F, 0};
    settings.iterations = 2000;
    settings.tolerance = 1e-3F;
    Solver solver(settings, {});
    for (int step = 0; step < 30; ++step) {
        const StepReport report = solver.step(whip.scene, frame_time);
        EXPECT_EQ(report.islands, 4);
        EXPECT_EQ(report.islands_above_tolerance, 0);
        EXPECT_LT(report.sweeps, 2000);
        // The final residual is of the order of the last sweep's changes.
        EXPECT_LT(report.measures.residual_max, 2e-3);
    }
    settings.iterations = 2;
    solver.set_settings(settings);
    const StepReport cut_short = solver.step(whip.scene, frame_time);
    EXPECT_EQ(cut_short.islands_above_tolerance, 1);
    EXPECT_EQ(cut_short.sweeps, 3);
}

/// Positions and velocities of the pairs, for comparison bit for bit.
std::vector<double> pair_positions(const Scene& scene, int pairs)
{
    std::vector<double> values;
    for (std::uint32_t slot = 14; slot < 14 + static_cast<std::uint32_t>(pairs); ++slot) {
        const BodyState s = scene.state(core_of(scene).bodies.id_of_slot(slot));
        values.insert(values.end(), {s.position.x, s.position.y, static_cast<double>(s.linear_velocity.y)});
    }
    return values;
}

/// A whip and 32 pairs after one step of so many iterations without a warm start.
WhipAndPairs whip_after(int iterations, float tolerance, StepReport& report)
{
    SolverSettings settings = one_plain_sweep();
    settings.gravity = {1, -9.81F, 0};
    settings.warm_start = false;
    settings.iterations = iterations;
    settings.tolerance = tolerance;
    WhipAndPairs whip(32);
    Solver solver(settings, {});
    report = solver.step(whip.scene, frame_time);
    return whip;
}

TEST(Tolerance, AnIslandStopsOnItsOwn)
{
    // One sweep solves a pair, and the second finds nothing to do; the chain needs hundreds. All joints to the ground
    // have one colour, and the first sixteen of these 33 share a block with the chain's joint: they are swept as
    // often as the chain.
    StepReport tolerant_report, plain_report;
    const WhipAndPairs tolerant = whip_after(500, 1e-4F, tolerant_report),
                       plain = whip_after(2, 0, plain_report);
    EXPECT_GT(tolerant_report.sweeps, 20);
    const auto left = pair_positions(tolerant.scene, 32), right = pair_positions(plain.scene, 32);
    EXPECT_TRUE(std::equal(left.begin() + 15 * 3, left.end(), right.begin() + 15 * 3));
}

/// The residual of the chain's joints after one step, with the iterations that `ask` requests.
double residual_when_asked(const std::function<void(Scene&, const std::vector<ConstraintId>&, BodyId)>& ask,
                           StepReport& report)
{
    Scene scene;
    std::vector<ConstraintId> joints;
    BodyId before = scene.ground(), last{};
    for (int i = 0; i < 12; ++i) {
        last = scene.add_body(box({0.5 * i + 0.25, 0, 0}, 1));
        joints.push_back(scene.add_joint(BallSocketDefinition{
            before, last, i == 0 ? Vec3<float>{} : Vec3<float>{0.25F, 0, 0}, {-0.25F, 0, 0}}));
        before = last;
    }
    ask(scene, joints, last);
    SolverSettings settings = one_plain_sweep();
    settings.gravity = {0, -9.81F, 0};
    settings.iterations = 3;
    Solver solver(settings, {});
    report = solver.step(scene, frame_time);
    return report.measures.residual_norm;
}

TEST(Iterations, OfAnIslandAreAsManyAsItsBodyAsksFor)
{
    StepReport report;
    const double plain = residual_when_asked([](auto&, const auto&, BodyId) {}, report);
    EXPECT_EQ(report.iterations, 3);
    const double asked = residual_when_asked(
        [](Scene& s, const auto&, BodyId body) { s.set_island_iterations(body, 60); }, report);
    EXPECT_EQ(report.iterations, 60);
    EXPECT_LT(asked, plain / 10);
    // Fewer iterations than everybody gets change nothing; 0 withdraws the request.
    EXPECT_EQ(residual_when_asked(
                  [](Scene& s, const auto&, BodyId body) { s.set_island_iterations(body, 2); }, report),
              plain);
    EXPECT_EQ(residual_when_asked(
                  [](Scene& s, const auto&, BodyId body) {
                      s.set_island_iterations(body, 60);
                      s.set_island_iterations(body, 0);
                  },
                  report),
              plain);
}

TEST(Iterations, OfEveryJointOrOfItsIslandAreTheSame)
{
    StepReport report;
    const double island = residual_when_asked(
        [](Scene& s, const auto&, BodyId body) { s.set_island_iterations(body, 60); }, report);
    const double joints = residual_when_asked(
        [](Scene& s, const std::vector<ConstraintId>& all, BodyId) {
            for (const ConstraintId joint : all) s.set_iterations(joint, 60);
        },
        report);
    EXPECT_EQ(joints, island);
}

TEST(Iterations, OfOneIslandLeaveTheOthersBitsAlone)
{
    const auto pairs_when = [](bool asks) {
        WhipAndPairs whip(32);
        if (asks) whip.scene.set_island_iterations(core_of(whip.scene).bodies.id_of_slot(5), 50);
        SolverSettings settings;
        settings.gravity = {1, -9.81F, 0};
        Solver solver(settings, {});
        for (int step = 0; step < 30; ++step) solver.step(whip.scene, frame_time);
        return pair_positions(whip.scene, 32);
    };
    const auto asked = pairs_when(true), plain = pairs_when(false);
    // As above, the first fifteen pairs share a block with the chain's first joint.
    EXPECT_TRUE(std::equal(asked.begin() + 15 * 3, asked.end(), plain.begin() + 15 * 3));
    EXPECT_FALSE(asked.empty());
}

TEST(Iterations, RemovedBodiesAndJointsTakeTheirWishesWithThem)
{
    Scene scene;
    const BodyId a = scene.add_body(box({0, 0, 0})), b = scene.add_body(box({1, 0, 0}));
    const ConstraintId joint = scene.add_joint(BallSocketDefinition{a, b});
    scene.set_iterations(joint, 7);
    scene.set_island_iterations(a, 9);
    EXPECT_TRUE(core_of(scene).asks_for_iterations());
    scene.remove_joint(joint);
    EXPECT_TRUE(core_of(scene).asks_for_iterations());
    scene.remove_body(a);
    EXPECT_FALSE(core_of(scene).asks_for_iterations());
    EXPECT_THROW(scene.set_iterations(joint, 7), InvalidInput);
    EXPECT_THROW(scene.set_island_iterations(a, 7), InvalidInput);
    EXPECT_THROW(scene.set_island_iterations(scene.ground(), 7), InvalidInput);
    EXPECT_THROW(scene.set_island_iterations(b, -1), InvalidInput);
    EXPECT_THROW(scene.set_island_iterations(b, 10001), InvalidInput);
    EXPECT_FALSE(core_of(scene).asks_for_iterations());
}

TEST(Measures, WhatIsNotANumberIsNotSolved)
{
    // A force drives a light body beyond the range of floats within the step.
    for (const BodyModel model : {BodyModel::particle, BodyModel::planar, BodyModel::rigid}) {
        Scene scene;
        BodyDefinition body;
        body.model = model;
        body.mass = 1e-6F;
        const BodyId bad = scene.add_body(body);
        scene.add_joint(BallSocketDefinition{scene.ground(), bad, {}, {}});
        scene.set_force(bad, {3e38F, 3e38F, 0}, {});
        SolverSettings settings;
        settings.iterations = 8;
        settings.tolerance = 1e-3F;
        settings.measures = true;
        settings.substeps = 1;
        const StepReport report = Solver(settings).step(scene, 1.0F / 60);
        ASSERT_EQ(report.bodies_contained, 1);
        EXPECT_FALSE(report.measures.residual_max <= 1e30) << report.measures.residual_max;
        EXPECT_FALSE(report.measures.residual_rms <= 1e30) << report.measures.residual_rms;
        EXPECT_FALSE(report.measures.residual_norm <= 1e30) << report.measures.residual_norm;
        EXPECT_EQ(report.islands_above_tolerance, 1);
        EXPECT_EQ(report.iterations, 8);
    }
}

TEST(Measures, AServosPullIsNoSeparation)
{
    Scene scene;
    BodyDefinition body;
    const BodyId a = scene.add_body(body);
    scene.add_joint(BallSocketDefinition{scene.ground(), a, {0.0007F, 0, 0}, {}});
    scene.add_joint(PointServoDefinition{scene.ground(), a, {0.031F, 0, 0}, {}});
    AngularServoDefinition turn{scene.ground(), a};
    turn.frame_a.rotation = {0, 0, 1, 1};
    scene.add_joint(turn);
    const SceneErrors errors = scene.errors();
    EXPECT_NEAR(errors.joint_separation_max, 0.0007, 1e-9);
    EXPECT_NEAR(errors.joint_separation_rms, 0.0007, 1e-9);
    EXPECT_EQ(errors.joint_angle_max, 0);
}

}  // namespace
}  // namespace motley
