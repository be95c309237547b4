// The report of a step's residual, and the tolerance that ends an island's sweeps. Independent evidence: residuals of
// particles by hand from their velocities; the kinetic energy that solving one joint exactly takes away, which is half
// of r^T K^-1 r whatever the joint; equal bits with the measuring on and off.
#include <gtest/gtest.h>

#include "joint_scene.h"
#include "rig.h"

namespace motley {
namespace {

using testing::box;
using testing::frame_time;

/// One sweep of rigid constraints, no gravity, no correction of positions: what is left is J v and nothing else.
SolverSettings one_plain_sweep()
{
    SolverSettings settings;
    settings.method = Method::sequential_impulse;
    settings.drift_correction = DriftCorrection::none;
    settings.substeps = settings.iterations = 1;
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

/// Two joints in a row on bodies with levers and uneven inertia: the sweep solves the later one last, so all that is
/// left is the first one's.
template <class Definition>
void expect_residual_is_the_energy_that_solving_takes(BodyModel model)
{
    // Times so short that nobody moves.
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
    // The difference of two energies: a thousand times the rounding of one.
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
    // Falling balls, friction, a floor: inequalities and cones.
    double last = 0;
    for (const int iterations : {1, 10, 100, 1000}) {
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
        if (iterations > 1) {
            EXPECT_LT(report.measures.residual_norm, last) << iterations;
        }
        last = report.measures.residual_norm;
    }
    // Rounding of speeds of some m/s.
    EXPECT_LT(last, 1e-4);
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

/// Hashes after every step, and the largest number of islands.
std::vector<std::uint64_t> run(const SolverSettings& settings, const SolverOptions& options)
{
    testing::MixedScene mixed;
    testing::JointScene joints;
    Solver solver(settings, options);
    std::vector<std::uint64_t> hashes;
    for (int step = 0; step < 60; ++step) {
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
        EXPECT_EQ(figures({.threads = 3, .isa = isa}), scalar) << isa_name(isa);
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
        EXPECT_EQ(run(settings, {.threads = 3, .isa = isa}), scalar) << isa_name(isa);
    }
}

/// A chain that whips, and, apart from it, pairs that hang still.
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
        // What is left afterwards is of the order of what the last sweep changed.
        EXPECT_LT(report.measures.residual_max, 2e-3);
    }
    settings.iterations = 2;
    solver.set_settings(settings);
    const StepReport cut_short = solver.step(whip.scene, frame_time);
    EXPECT_EQ(cut_short.islands_above_tolerance, 1);
    EXPECT_EQ(cut_short.sweeps, 3);
}

TEST(Tolerance, AnIslandStopsOnItsOwn)
{
    // The pairs alone need two sweeps: one that solves them, one that finds nothing to do. Beside the chain, which wants
    // hundreds, their bits are those of two sweeps: they were left alone.
    const auto pair_positions = [](Scene& scene) {
        std::vector<double> values;
        for (std::uint32_t slot = 13; slot < 13 + 32; ++slot) {
            const BodyState s = scene.state(scene.bodies().id_of_slot(slot));
            values.insert(values.end(),
                          {s.position.x, s.position.y, static_cast<double>(s.linear_velocity.y)});
        }
        return values;
    };
    SolverSettings settings = one_plain_sweep();
    settings.gravity = {1, -9.81F, 0};
    settings.warm_start = false;
    settings.iterations = 500;
    settings.tolerance = 1e-4F;
    WhipAndPairs tolerant(32);
    Solver solver(settings, {});
    const StepReport report = solver.step(tolerant.scene, frame_time);
    EXPECT_GT(report.sweeps, 20);
    // As many chain joints as fill no block with the pairs' would differ; sixteen pairs a block stand alone.
    settings.tolerance = 0;
    settings.iterations = 2;
    WhipAndPairs plain(32);
    Solver two(settings, {});
    two.step(plain.scene, frame_time);
    const auto left = pair_positions(tolerant.scene), right = pair_positions(plain.scene);
    std::size_t same = 0;
    for (std::size_t i = 0; i < left.size(); ++i) same += left[i] == right[i] ? 1U : 0U;
    // Those that share a block with the chain may have been swept on; the others may not.
    EXPECT_GE(same, left.size() / 2);
}

}  // namespace
}  // namespace motley
