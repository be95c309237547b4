// Limits and motors solved with the locks (SolverSettings::exact_limits). Independent evidence: statics, lever arms of
// loads; the angle that a motor's speed makes; work of a bounded torque; and conservation of momentum.
#include <gtest/gtest.h>

#include <cstdio>
#include <vector>

#include "every_way.h"
#include "fallen_figures.h"
#include "level_arm.h"

namespace motley {
namespace {

using testing::frame_time;

using testing::add_arm;
using testing::Arm;
using testing::arm_of;
using testing::exact_limits;
using testing::g;
using testing::half_link;

TwistDriveDefinition range(float lower, float upper)
{
    TwistDriveDefinition drive;
    drive.lower = lower;
    drive.upper = upper;
    return drive;
}
TwistDriveDefinition motor(float speed, float torque)
{
    TwistDriveDefinition drive;
    drive.motor_speed = speed;
    drive.motor_max_force = torque;
    return drive;
}

TEST(ExactLimits, OfLightLinksBearTonsAndTellTheirTorques)
{
    for (const int substeps : {1, 4}) {
        for (const bool up : {false, true}) {
            for (const bool turned : {false, true}) {
                for (const int links : {1, 3, 8}) {
                    for (const double mass : {1.0, 1e2, 1e4}) {
                        Arm arm = arm_of(links, mass, up ? range(-1, 0) : range(0, 1), turned);
                        Solver solver(exact_limits(substeps, {0, up ? 9.81F : -9.81F, 0}));
                        testing::run(arm.scene, solver, 1);
                        // By sweeps beside exact joints one link under 100 kg gives way by a tenth of a metre, eight under
                        // 1 kg by more than one.
                        testing::expect_held_level(arm, ::testing::Message()
                                                            << substeps << " substeps, up " << up
                                                            << ", turned " << turned << ", " << links
                                                            << " links, " << mass << " kg");
                    }
                }
            }
        }
    }
}

TEST(ExactLimits, OfASwingBearTons)
{
    for (const double mass : {1.0, 1e2, 1e4}) {
        // The rod may leave the x axis by half a radian, and is pressed downwards.
        Scene scene;
        BodyDefinition rod;
        rod.mass = 1;
        rod.inertia = {0.001F, 0, 0, 0.021F, 0, 0.021F};
        rod.position = {half_link, 0, 0};
        const BodyId link = scene.add_body(rod);
        BodyDefinition end = rod;
        end.position = {2 * half_link, 0, 0};
        end.mass = static_cast<float>(mass);
        const float inertia = 0.01F * end.mass;
        end.inertia = {inertia, 0, 0, inertia, 0, inertia};
        const BodyId load = scene.add_body(end);
        const JointFrame at_rod{{-static_cast<float>(half_link), 0, 0}};
        scene.add_joint(BallSocketDefinition{scene.ground(), link, {0, 0, 0}, {-0.25F, 0, 0}});
        SwingLimitDefinition cone{.body_a = scene.ground(), .body_b = link, .max_angle = 0.5F};
        cone.frame_b = at_rod;
        const ConstraintId limit = scene.add_joint(cone);
        scene.add_joint(FixedDefinition{link, load, {{0.25F, 0, 0}}, {}});
        Solver solver(exact_limits(4));
        testing::run(scene, solver, 3);
        const Vec3<double> at = scene.state(load).position;
        EXPECT_NEAR(std::atan2(at.y, at.x), -0.5, 2e-6) << mass;
        const double torque = g * std::cos(0.5) * (mass * 2 * half_link + half_link);
        const Vec3<double> told = convert<double>(scene.joint_report(limit).torque);
        EXPECT_NEAR(testing::length(told) / torque, 1, 1e-3) << mass;
    }
}

TEST(ExactLimits, OfSlidesBearTons)
{
    for (const double mass : {1.0, 1e2, 1e4}) {
        // Stages of 1 kg that slide upwards out of each other, pressed together.
        Scene scene;
        BodyId before = scene.ground();
        std::vector<ConstraintId> limits;
        const Quat<float> upwards = testing::axis_along(1);
        for (int i = 0; i < 6; ++i) {
            BodyDefinition stage;
            stage.position = {0, 0.5 * (i + 1), 0};
            stage.mass = i == 5 ? static_cast<float>(mass) : 1.0F;
            stage.inertia = {0.1F * stage.mass, 0, 0, 0.1F * stage.mass, 0, 0.1F * stage.mass};
            const BodyId body = scene.add_body(stage);
            const JointFrame inner{{0, 0.5F, 0}, upwards}, outer{{0, 0, 0}, upwards};
            scene.add_joint(SliderDefinition{before, body, inner, outer});
            SlideDriveDefinition range{.body_a = before, .body_b = body, .lower = 0, .upper = 0.4F};
            range.frame_a = inner, range.frame_b = outer;
            limits.push_back(scene.add_joint(range));
            before = body;
        }
        Solver solver(exact_limits(4));
        testing::run(scene, solver, 1);
        EXPECT_NEAR(scene.state(before).position.y, 3, 1e-6) << mass;
        for (std::size_t i = 0; i < limits.size(); ++i) {
            const double weight = g * (mass + 5 - static_cast<double>(i));
            const Vec3<double> force = convert<double>(scene.joint_report(limits[i]).force);
            EXPECT_NEAR(testing::length(force) / weight, 1, 1e-4) << mass << ", stage " << i;
        }
    }
}

TEST(ExactLimits, MotorsLiftTonsAtTheirSpeed)
{
    for (const bool turned : {false, true}) {
        for (const int links : {1, 3, 8}) {
            for (const double mass : {1.0, 1e2, 1e4}) {
                Arm arm = arm_of(links, mass, motor(0, 1e9F), turned);
                // The first joint lifts, the others hold.
                TwistDriveDefinition first = arm.definitions.front();
                first.motor_speed = turned ? -0.2F : 0.2F;
                arm.scene.set_joint(arm.drives.front(), first);
                Solver solver(exact_limits(4));
                testing::run(arm.scene, solver, 0.5);
                const double before = arm.angle();
                testing::run(arm.scene, solver, 1);
                EXPECT_NEAR(arm.angle() - before, 0.2, 1e-5) << links << " links, " << mass << " kg";
                const double torque =
                    std::abs(static_cast<double>(arm.scene.joint_report(arm.drives.front()).torque.z));
                // Of the middle of the last step.
                const double cosine = std::cos(arm.angle() - 0.1 / 60);
                EXPECT_NEAR(torque / (arm.torque_at(0) * cosine), 1, 1e-3) << links << " " << mass;
            }
        }
    }
}

TEST(ExactLimits, BrakesHaveNoMoreThanTheirTorque)
{
    for (const int substeps : {1, 4}) {
        for (const int links : {1, 4}) {
            // The first joint brakes, the others hold; nothing else acts. Beside it the same arm without a brake, because one
            // substep a step loses some speed by turning.
            Arm arm = arm_of(links, 100, motor(0, 1e9F));
            double inertia = 1;  // of the load about its middle
            const auto spin = [&](BodyId body) {
                const auto r = static_cast<float>(arm.scene.state(body).position.x);
                arm.scene.set_velocity(body, {0, 0.5F * r, 0}, {0, 0, 0.5F});
                return static_cast<double>(r * r);
            };
            for (const BodyId link : arm.links) inertia += 0.021 + spin(link);
            inertia += 100 * spin(arm.load);
            const double torque = 0.4 * inertia;
            TwistDriveDefinition brake = arm.definitions.front();
            const auto set_brake = [&](Arm& of, double most) {
                brake.motor_max_force = static_cast<float>(most);
                of.scene.set_joint(of.drives.front(), brake);
            };
            Solver solver(exact_limits(substeps, {})), free_solver(exact_limits(substeps, {}));
            // Motors act once sweeps have found that they do: the arm becomes rigid in its first step.
            set_brake(arm, 0);
            testing::run(arm.scene, solver, 0.1);
            Arm free = arm;
            set_brake(arm, torque);
            for (int step = 1; step <= 30; ++step) {
                ASSERT_EQ(solver.step(arm.scene, frame_time).status, StepStatus::done);
                ASSERT_EQ(free_solver.step(free.scene, frame_time).status, StepStatus::done);
                const auto told =
                    std::abs(static_cast<double>(arm.scene.joint_report(arm.drives.front()).torque.z));
                EXPECT_NEAR(told / torque, 1, 1e-4)
                    << substeps << " substeps, " << links << " links, step " << step;
                const double lost = static_cast<double>(free.scene.state(free.load).angular_velocity.z -
                                                        arm.scene.state(arm.load).angular_velocity.z);
                EXPECT_NEAR(lost / (0.4 * step / 60), 1, 0.04 / substeps)
                    << substeps << " substeps, " << links << " links, step " << step;
            }
            set_brake(arm, 1e6);
            testing::run(arm.scene, solver, 1);
            EXPECT_LT(std::abs(arm.scene.state(arm.load).angular_velocity.z), 1e-6F) << links;
        }
    }
}

TEST(ExactLimits, LetGoWithinASubstep)
{
    for (const int substeps : {1, 4}) {
        Arm arm = arm_of(1, 10, range(0, 1), false);
        Solver solver(exact_limits(substeps, {}));
        const double inertia = 0.021 + 0.0625 + 10 * 0.25 + 0.1;
        const auto push = [&](double torque) {
            arm.scene.set_force(arm.load, {}, {0, 0, static_cast<float>(torque)});
        };
        push(-1000);
        testing::run(arm.scene, solver, 0.5);
        ASSERT_NEAR(arm.angle(), 0, 1e-6);
        push(2);
        testing::run(arm.scene, solver, 0.5);
        const double late = 0.5 - std::sqrt(2 * arm.angle() * inertia / 2);
        // Velocities change before positions do, so that all is half a substep early.
        const double substep = static_cast<double>(frame_time) / substeps;
        EXPECT_GE(late, -0.51 * substep) << substeps;
        EXPECT_LE(late, 1.01 * substep) << substeps;
    }
}

TEST(ExactLimits, MotorsStopAtThemAndComeBack)
{
    for (const int substeps : {1, 4}) {
        TwistDriveDefinition drive = range(-0.3F, 0.3F);
        drive.motor_max_force = 1e5F;
        drive.motor_speed = 0.5F;
        Arm arm = arm_of(1, 100, drive);
        Solver solver(exact_limits(substeps));
        testing::run(arm.scene, solver, 2);
        EXPECT_NEAR(arm.angle(), 0.3, 1e-5) << substeps;
        EXPECT_LT(std::abs(arm.scene.state(arm.load).angular_velocity.z), 1e-4F);
        drive = arm.definitions.front();
        drive.motor_speed = -0.5F;
        arm.scene.set_joint(arm.drives.front(), drive);
        testing::run(arm.scene, solver, 0.6);
        EXPECT_NEAR(arm.angle(), 0, 0.02) << substeps;
        testing::run(arm.scene, solver, 2);
        EXPECT_NEAR(arm.angle(), -0.3, 1e-5) << substeps;
    }
}

TEST(ExactLimits, TakeNoMomentum)
{
    // A free chain whose links spin towards their limits and are stopped by them.
    for (const int substeps : {1, 4}) {
        Scene scene;
        std::vector<BodyId> links;
        std::vector<ConstraintId> limits;
        for (int i = 0; i < 6; ++i) {
            BodyDefinition link = testing::box({0.5 * i, 0, 0}, 1 + static_cast<float>(i));
            link.linear_velocity = {0.3F, -0.2F, 0.1F};
            link.angular_velocity = {0.2F, -0.4F, i % 2 == 0 ? 3.0F : -3.0F};
            links.push_back(scene.add_body(link));
            if (i == 0) continue;
            HingeDefinition hinge{links[links.size() - 2], links.back(), {{0.25F, 0, 0}}, {{-0.25F, 0, 0}}};
            hinge.frame_a.rotation = hinge.frame_b.rotation = testing::axis_along(2);
            scene.add_joint(hinge);
            TwistDriveDefinition drive = range(-0.2F, 0.2F);
            drive.body_a = hinge.body_a, drive.body_b = hinge.body_b;
            drive.frame_a = hinge.frame_a, drive.frame_b = hinge.frame_b;
            // Every second motor drives into its limit, the others pull their links about.
            drive.motor_speed = i % 2 == 0 ? 2.0F : -0.1F;
            drive.motor_max_force = 5;
            limits.push_back(scene.add_joint(drive));
        }
        const auto momenta = [&] {
            Vec3<double> p{}, l{};
            for (std::size_t i = 0; i < links.size(); ++i) {
                const double m = 1 + static_cast<double>(i);
                const BodyState state = scene.state(links[i]);
                p = p + m * convert<double>(state.linear_velocity);
                l = l + testing::angular_momentum(state, m, {0.1 * m, 0.2 * m, 0.25 * m});
            }
            return std::pair(p, l);
        };
        SolverSettings settings = exact_limits(substeps, {});
        Solver solver(settings);
        // A first, very short step removes what velocity error the joints have.
        ASSERT_EQ(solver.step(scene, 1e-6F).status, StepStatus::done);
        const auto [p, l] = momenta();
        int touched = 0;
        for (int step = 0; step < 120; ++step) {
            ASSERT_EQ(solver.step(scene, frame_time).status, StepStatus::done);
            for (const ConstraintId limit : limits)
                touched += testing::length(convert<double>(scene.joint_report(limit).torque)) > 1 ? 1 : 0;
        }
        const auto [p_now, l_now] = momenta();
        EXPECT_LT(testing::length(p_now - p), 1e-5 * testing::length(p)) << substeps;
        EXPECT_LT(testing::length(l_now - l), 1e-4 * testing::length(l)) << substeps;
        EXPECT_GT(touched, 50);
    }
}

/// Sixteen arms are solved in lockstep. One has the same bits whether the motors of the others are strong enough or not.
TEST(ExactLimits, OfAFigureDoNotDependOnTheOtherLanes)
{
    const auto run = [](float others) {
        return testing::states_of_watched([&](int i) {
            return motor(0, i == testing::watched_arm ? 700 : others * static_cast<float>(1 + i));
        });
    };
    testing::expect_equal(run(1e6F), run(50));
}

/// Ragdolls that fall: on a floor, each a lane; and on a floor that moves, swept by colour.
TEST(ExactLimits, HaveTheSameBitsForEveryInstructionSetAndThreadCount)
{
    for (const bool sweeps : {false, true}) {
        const auto run = [&](const SolverOptions& options) {
            testing::FallenFigures fallen({.copies = 32 + 5, .all_touches = sweeps, .turntable = sweeps});
            Solver solver(sweeps ? testing::swept(exact_limits(2)) : exact_limits(2), options);
            std::vector<std::uint64_t> hashes;
            for (int step = 0; step < testing::long_run(150, 20); ++step) {
                if (sweeps) fallen.turn();
                EXPECT_EQ(solver.step(fallen.scene, frame_time, fallen.contacts()).status, StepStatus::done);
                hashes.push_back(fallen.scene.state_hash());
            }
            return hashes;
        };
        testing::expect_same_bits(run);
    }
}

}  // namespace
}  // namespace motley
