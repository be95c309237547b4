// Springs of drives solved with the locks (SolverSettings::exact_limits). Independent evidence: statics of the arm in its
// minimal coordinates, its equation of motion integrated in steps of a microsecond, Hooke's law, and conservation.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "level_arm.h"

namespace motley {
namespace {

using testing::arm_of;
using testing::exact_limits;
using testing::frame_time;
using testing::g;
using testing::half_link;

TwistDriveDefinition spring(double stiffness, double damping)
{
    TwistDriveDefinition drive;
    drive.spring_stiffness = static_cast<float>(stiffness);
    drive.spring_damping = static_cast<float>(damping);
    return drive;
}

/// Gives each joint of an arm a spring that its load bends by about `angle`, with damping that lets it settle.
std::vector<double> soften(testing::Arm& arm, double angle)
{
    std::vector<double> stiffnesses;
    for (std::size_t joint = 0; joint < arm.drives.size(); ++joint) {
        stiffnesses.push_back(arm.torque_at(joint) / angle);
        TwistDriveDefinition drive = arm.definitions[joint];
        drive.spring_stiffness = static_cast<float>(stiffnesses.back());
        drive.spring_damping = 0.1F * drive.spring_stiffness;
        arm.scene.set_joint(arm.drives[joint], drive);
    }
    return stiffnesses;
}

/// Where an arm with these springs is at rest.
struct Statics {
    Vec3<double> load;
    std::vector<double> torques;
};
Statics statics_of(const testing::Arm& arm, const std::vector<double>& stiffnesses)
{
    const std::size_t count = stiffnesses.size();
    Statics rest{{}, std::vector<double>(count, 0)};
    for (int round = 0; round < 200; ++round) {
        std::vector<double> joint_x{0}, middle_x;
        double heading = 0, x = 0, y = 0;
        for (std::size_t i = 0; i < count; ++i) {
            heading -= rest.torques[i] / stiffnesses[i];
            middle_x.push_back(x + half_link * std::cos(heading));
            x += 2 * half_link * std::cos(heading);
            y += 2 * half_link * std::sin(heading);
            joint_x.push_back(x);
        }
        rest.load = {x, y, 0};
        for (std::size_t joint = 0; joint < count; ++joint) {
            rest.torques[joint] = g * arm.mass * (x - joint_x[joint]);
            for (std::size_t i = joint; i < count; ++i)
                rest.torques[joint] += g * (middle_x[i] - joint_x[joint]);
        }
    }
    return rest;
}

TEST(ExactSprings, BearTonsAsStaticsSays)
{
    for (const int substeps : {1, 4}) {
        for (const bool turned : {false, true}) {
            for (const int links : {1, 3, 8}) {
                for (const double mass : {1e4, 1e2, 1.0}) {
                    // Later ones access the same memory as earlier ones.
                    if (testing::is_sanitized && (links > 3 || mass < 1e4)) continue;
                    testing::Arm arm = arm_of(links, mass, {}, turned);
                    const Statics rest = statics_of(arm, soften(arm, 0.01));
                    Solver solver(exact_limits(substeps));
                    testing::run(arm.scene, solver, 5);
                    // By sweeps beside exact joints one link under 100 kg falls, and so do eight under 1 kg.
                    const Vec3<double> at = arm.scene.state(arm.load).position;
                    EXPECT_LT(testing::length(at - rest.load), 1e-5 * arm.length())
                        << substeps << " substeps, turned " << turned << ", " << links << " links, " << mass
                        << " kg";
                    for (std::size_t joint = 0; joint < arm.drives.size(); ++joint) {
                        const double torque =
                            std::abs(static_cast<double>(arm.scene.joint_report(arm.drives[joint]).torque.z));
                        EXPECT_NEAR(torque / rest.torques[joint], 1, 1e-3) << links << " " << mass;
                    }
                }
            }
        }
    }
}

/// The angle of a single link with a load after each step: I q'' = -k q - c q' - m g r cos q.
std::vector<double> motion_of(double inertia, double moment, double stiffness, double damping, int steps)
{
    std::vector<double> angles;
    double q = 0, w = 0;
    const int pieces = 1 << 14;
    const double h = static_cast<double>(frame_time) / pieces;
    for (int step = 0; step < steps; ++step) {
        for (int piece = 0; piece < pieces; ++piece) {
            // The midpoint rule.
            const auto rate = [&](double at, double speed) {
                return (-stiffness * at - damping * speed - moment * std::cos(at)) / inertia;
            };
            const double q_half = q + h / 2 * w, w_half = w + h / 2 * rate(q, w);
            q += h * w_half;
            w += h * rate(q_half, w_half);
        }
        angles.push_back(q);
    }
    return angles;
}

TEST(ExactSprings, MoveAsTheirEquationOfMotion)
{
    for (const double mass : {1e4, 1e2, 1.0}) {
        if (testing::is_sanitized && mass < 1e4) continue;
        const double r = 2 * half_link;
        const double inertia = 0.021 + half_link * half_link + mass * r * r + 0.01 * mass;
        const double moment = g * (mass * r + half_link), stiffness = 40 * inertia, damping = inertia;
        const std::vector<double> truth = motion_of(inertia, moment, stiffness, damping, 90);
        double before = 0;
        for (const int substeps : {16, 64}) {
            testing::Arm arm = arm_of(1, mass, spring(stiffness, damping));
            Solver solver(exact_limits(substeps));
            double worst = 0;
            for (const double angle : truth) {
                ASSERT_EQ(solver.step(arm.scene, frame_time).status, StepStatus::done);
                worst = std::fmax(worst, std::abs(arm.angle() - angle));
            }
            // It swings by 0.9 rad. Implicit integration is of first order.
            EXPECT_LT(worst, 0.16 / substeps) << mass << " kg, " << substeps << " substeps";
            if (substeps == 64) {
                EXPECT_NEAR(before / worst, 4, 0.8) << mass << " kg";
            }
            before = worst;
        }
    }
}

/// The stiffness of a frequency is that of the two bodies alone, whatever else they bear.
TEST(ExactSprings, OfAFrequencyAreAsStiffAsItsTwoBodiesSay)
{
    // A stage of 1 kg on a spring, and 100 kg on the stage.
    Scene scene;
    const Quat<float> upwards = testing::axis_along(1);
    const BodyId stage = scene.add_body({.mass = 1}),
                 load = scene.add_body({.position = {0, 0.5, 0}, .mass = 100});
    scene.add_joint(SliderDefinition{scene.ground(), stage, {{}, upwards}, {{}, upwards}});
    SlideDriveDefinition drive{
        .body_a = scene.ground(), .body_b = stage, .spring_hertz = 10, .spring_damping_ratio = 1};
    drive.frame_a.rotation = drive.frame_b.rotation = upwards;
    const ConstraintId held = scene.add_joint(drive);
    scene.add_joint(FixedDefinition{stage, load, {{0, 0.5F, 0}}, {}});
    Solver solver(exact_limits(4));
    testing::run(scene, solver, 20);
    const double omega = 2 * 3.14159265358979 * 10;
    EXPECT_NEAR(scene.state(stage).position.y / (-g * 101 / (omega * omega)), 1, 1e-4);
    EXPECT_NEAR(static_cast<double>(scene.joint_report(held).force.y) / (g * 101), 1, 1e-4);
}

TEST(ExactSprings, PushNoHarderThanTheyMay)
{
    for (const int substeps : {1, 4}) {
        for (const int links : {1, 4}) {
            // The first joint has a weak spring, the others stiff ones; without weight, and spinning away from the spring.
            testing::Arm arm = arm_of(links, 100, spring(1e7, 1e6));
            double inertia = 1;
            for (const BodyId body : arm.links) {
                const auto r = static_cast<float>(arm.scene.state(body).position.x);
                arm.scene.set_velocity(body, {0, 0.5F * r, 0}, {0, 0, 0.5F});
                inertia += 0.021 + static_cast<double>(r * r);
            }
            const auto r = static_cast<float>(arm.length());
            arm.scene.set_velocity(arm.load, {0, 0.5F * r, 0}, {0, 0, 0.5F});
            inertia += 100 * static_cast<double>(r * r);
            TwistDriveDefinition weak = arm.definitions.front();
            const double most = 0.2 * inertia;
            weak.spring_max_force = static_cast<float>(most);
            arm.scene.set_joint(arm.drives.front(), weak);
            Solver solver(exact_limits(substeps, {}));
            testing::run(arm.scene, solver, 0.2);
            const double before = static_cast<double>(arm.scene.state(arm.load).angular_velocity.z);
            for (int step = 0; step < 30; ++step) {
                ASSERT_EQ(solver.step(arm.scene, frame_time).status, StepStatus::done);
                const auto told =
                    std::abs(static_cast<double>(arm.scene.joint_report(arm.drives.front()).torque.z));
                EXPECT_NEAR(told / most, 1, 1e-4)
                    << substeps << " substeps, " << links << " links, step " << step;
            }
            const double lost = before - static_cast<double>(arm.scene.state(arm.load).angular_velocity.z);
            EXPECT_NEAR(lost / 0.1, 1, 0.05) << substeps << " substeps, " << links << " links";
        }
    }
}

TEST(ExactSprings, AreStoppedByLimitsAndComeBack)
{
    for (const int substeps : {1, 4}) {
        for (const int links : {1, 3}) {
            testing::Arm arm = arm_of(links, 1e3, {});
            // Springs that would give way by 0.2 rad, and limits at a tenth of that.
            for (std::size_t joint = 0; joint < arm.drives.size(); ++joint) {
                TwistDriveDefinition& drive = arm.definitions[joint];
                drive.spring_stiffness = static_cast<float>(arm.torque_at(joint) / 0.2);
                drive.spring_damping = 0.1F * drive.spring_stiffness;
                drive.lower = -0.02F, drive.upper = 0.02F;
                arm.scene.set_joint(arm.drives[joint], drive);
            }
            Solver solver(exact_limits(substeps));
            testing::run(arm.scene, solver, 3);
            double y = 0;
            for (int i = 1; i <= links; ++i) y -= 2 * half_link * std::sin(0.02 * i);
            EXPECT_NEAR(arm.scene.state(arm.load).position.y, y, 1e-4)
                << substeps << " substeps, " << links << " links";
            // Without weight the springs straighten the arm, with slow swings of the load.
            solver.set_settings(exact_limits(substeps, {}));
            testing::run(arm.scene, solver, 20);
            EXPECT_NEAR(arm.scene.state(arm.load).position.y, 0, 1e-4)
                << substeps << " substeps, " << links << " links";
        }
    }
}

TEST(ExactSprings, TakeNoMomentumAndGiveNoEnergy)
{
    for (const int substeps : {1, 4})
        testing::expect_momenta_and_no_energy(exact_limits(substeps, {}),
                                              [](int i) { return spring(500, i % 2 == 0 ? 5 : 0); });
}

/// Sixteen arms are solved in lockstep. One has the same bits whether the springs of the others act, let go or do not exist.
TEST(ExactSprings, OfAFigureDoNotDependOnTheOtherLanes)
{
    const auto run = [](float stiffness, float most) {
        return testing::states_of_watched([&](int i) {
            const bool is_watched = i == testing::watched_arm;
            TwistDriveDefinition drive =
                spring(is_watched ? 2e4 : static_cast<double>(stiffness), is_watched ? 1e3 : 0);
            drive.spring_max_force = is_watched ? 3000 : most;
            return drive;
        });
    };
    const std::vector<BodyState> among_stiff = run(1e5F, 1e9F);
    for (const std::vector<BodyState>& among : {run(0, 1e9F), run(1e5F, 200)}) {
        testing::expect_equal(among_stiff, among);
    }
}

TEST(ExactSprings, HaveTheSameBitsForEveryInstructionSetAndThreadCount)
{
    testing::expect_same_bits_of_arms([](int i) {
        TwistDriveDefinition drive = spring(1e4 * (1 + i % 4), 300 * (i % 3));
        drive.spring_max_force = i % 5 == 0 ? 1000 : 1e9F;
        drive.lower = -0.1F, drive.upper = 0.5F;
        return drive;
    });
}

}  // namespace
}  // namespace motley
