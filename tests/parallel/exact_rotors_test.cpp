// Rotors of drives held with the locks (SolverSettings::exact_joints, and by default where light bodies bear heavy ones).
// Independent evidence: the equations of motion of the arm in its minimal coordinates, with the rotors' kinetic energy in them,
// integrated in steps of 0.1 ms; statics; and conservation.
#include <Eigen/Dense>
#include <cstdio>
#include <limits>

#include "level_arm.h"

namespace motley {
namespace {

using testing::arm_of;
using testing::by_default;
using testing::exact_joints;
using testing::exact_limits;
using testing::frame_time;
using testing::g;
using testing::half_link;

/// An arm in its minimal coordinates, the headings of its links, rad. In each joint a spring, N m/rad, a damper, N m s/rad, and
/// a rotor, kg m2, which act on the difference of two headings, or on the first.
struct ArmInHeadings {
    Eigen::VectorXd heading, speed;
    double load, rotor, stiffness = 0, damping = 0;

    ArmInHeadings(int links, double load_mass, double rotor_inertia)
        : heading(Eigen::VectorXd::Zero(links)),
          speed(Eigen::VectorXd::Zero(links)),
          load(load_mass),
          rotor(rotor_inertia)
    {
    }
    void run(double seconds)
    {
        const auto steps = static_cast<int>(std::lround(seconds / 1e-4));
        const double h = seconds / steps;
        for (int i = 0; i < steps; ++i) {
            // Runge and Kutta's method of fourth order.
            const Eigen::VectorXd k1 = acceleration(heading, speed),
                                  k2 = acceleration(heading + h / 2 * speed, speed + h / 2 * k1),
                                  k3 = acceleration(heading + h / 2 * speed + h * h / 4 * k1,
                                                    speed + h / 2 * k2),
                                  k4 = acceleration(heading + h * speed + h * h / 2 * k2, speed + h * k3);
            heading += h * speed + h * h / 6 * (k1 + k2 + k3);
            speed += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
        }
    }
    [[nodiscard]] Vec3<double> end() const
    {
        Vec3<double> at{};
        for (const double q : heading) at = at + (2 * half_link) * Vec3<double>{std::cos(q), std::sin(q), 0};
        return at;
    }

  private:
    /// Lagrange's equations: M q'' = f.
    [[nodiscard]] Eigen::VectorXd acceleration(const Eigen::VectorXd& q, const Eigen::VectorXd& w) const
    {
        const Eigen::Index n = q.size();
        Eigen::MatrixXd mass = Eigen::MatrixXd::Zero(n, n);
        Eigen::VectorXd force = Eigen::VectorXd::Zero(n);
        // The centre of body k is the sum of arm(i) in the direction of link i, for i up to the last link that carries it.
        const auto add_body = [&](Eigen::Index last, double m, double inertia, double last_arm) {
            const auto arm = [&](Eigen::Index i) { return i < last ? 2 * half_link : last_arm; };
            for (Eigen::Index i = 0; i <= last; ++i) {
                for (Eigen::Index j = 0; j <= last; ++j) {
                    mass(i, j) += m * arm(i) * arm(j) * std::cos(q[i] - q[j]);
                    force[i] -= m * arm(i) * arm(j) * std::sin(q[i] - q[j]) * w[j] * w[j];
                }
                force[i] -= m * g * arm(i) * std::cos(q[i]);
            }
            mass(last, last) += inertia;
        };
        for (Eigen::Index k = 0; k < n; ++k) add_body(k, 1, 0.021, half_link);
        add_body(n - 1, load, 0.01 * load, 2 * half_link);
        for (Eigen::Index k = 0; k < n; ++k) {
            const double bend = q[k] - (k > 0 ? q[k - 1] : 0), rate = w[k] - (k > 0 ? w[k - 1] : 0);
            const double torque = -stiffness * bend - damping * rate;
            mass(k, k) += rotor;
            force[k] += torque;
            if (k == 0) continue;
            mass(k - 1, k - 1) += rotor;
            mass(k, k - 1) -= rotor;
            mass(k - 1, k) -= rotor;
            force[k - 1] -= torque;
        }
        return mass.ldlt().solve(force);
    }
};

/// How far the end of an arm with these drives is at most from where minimal coordinates have it, in half a second from level.
double error_of(ArmInHeadings truth, const TwistDriveDefinition& drive, const SolverSettings& settings,
                bool turned)
{
    testing::Arm arm = arm_of(static_cast<int>(truth.heading.size()), truth.load, drive, turned);
    Solver solver(settings);
    double worst = 0;
    for (int step = 0; step < 30; ++step) {
        EXPECT_EQ(solver.step(arm.scene, frame_time).status, StepStatus::done);
        truth.run(static_cast<double>(frame_time));
        worst = std::fmax(worst, testing::length(arm.scene.state(arm.load).position - truth.end()));
    }
    return worst;
}

TEST(ExactRotors, FallAsTheirEquationsOfMotion)
{
    for (const double load : {1.0, 1e2, 1e4}) {
        for (const float rotor : {0.1F, 10.0F}) {
            for (const bool turned : {false, true}) {
                if (testing::is_sanitized && (load < 1e4 || turned)) continue;
                const ArmInHeadings start(5, load, static_cast<double>(rotor));
                const TwistDriveDefinition drive{.armature = rotor};
                const double coarse = error_of(start, drive, exact_joints(4), turned),
                             fine = error_of(start, drive, exact_joints(16), turned);
                // The end falls by 1 m and more. Bodies that are held are of first order in the substep.
                EXPECT_LT(coarse, 0.02) << load << " kg, rotors of " << rotor;
                EXPECT_NEAR(coarse / fine, 4, 0.8) << load << " kg, rotors of " << rotor;
                if (load > 10) {
                    EXPECT_EQ(error_of(start, drive, by_default(4), turned), coarse) << load << " kg";
                }
            }
        }
    }
}

TEST(ExactRotors, SwingOnSpringsAsTheirEquationsOfMotion)
{
    for (const int links : {1, 3}) {
        for (const double load : {1.0, 1e2, 1e4}) {
            for (const double share : {0.1, 3.0}) {
                if (testing::is_sanitized && load < 1e4) continue;
                // Rotors of a share of the load's inertia about the first joint, and springs that bear the load.
                const double reach = 2 * half_link * links, inertia = load * reach * reach;
                ArmInHeadings start(links, load, share * inertia);
                start.stiffness = 40 * inertia;
                start.damping = inertia;
                const TwistDriveDefinition drive{.spring_stiffness = static_cast<float>(start.stiffness),
                                                 .spring_damping = static_cast<float>(start.damping),
                                                 .armature = static_cast<float>(start.rotor)};
                const double coarse = error_of(start, drive, exact_limits(16), false),
                             fine = error_of(start, drive, exact_limits(64), false);
                EXPECT_LT(fine, 2e-3 * reach) << links << " links, " << load << " kg, " << share;
                EXPECT_NEAR(coarse / fine, 4, 0.8) << links << " links, " << load << " kg, " << share;
            }
        }
    }
}

/// Kinetic and potential energy of an arm, J, with its rotors. Velocities are those of the middle of the last substep, which moved
/// positions by them: so are the heights here.
double energy_of(const testing::Arm& arm, double rotor, double substep)
{
    double sum = 0, before = 0;
    const auto add_body = [&](BodyId body, double mass, double inertia) {
        const BodyState state = arm.scene.state(body);
        const Vec3<double> v = convert<double>(state.linear_velocity);
        const auto w = static_cast<double>(state.angular_velocity.z);
        const double height = state.position.y - substep * v.y / 2;
        sum += 0.5 * mass * dot(v, v) + 0.5 * inertia * w * w + mass * g * height;
        return w;
    };
    for (const BodyId link : arm.links) {
        const double w = add_body(link, 1, 0.021);
        sum += 0.5 * rotor * (w - before) * (w - before);
        before = w;
    }
    add_body(arm.load, arm.mass, 0.01 * arm.mass);
    return sum;
}

/// What falls for ten seconds never has more energy than at the start, but for a hundredth of that of the fall.
TEST(ExactRotors, GiveNoEnergyUnderAnyLoad)
{
    for (const double load : {1e2, 1e4, 1e6}) {
        for (const float rotor : {0.1F, 1.0F, 10.0F}) {
            for (const int substeps : {1, 4}) {
                if (testing::is_sanitized && load < 1e6) continue;
                testing::Arm arm = arm_of(5, load, {.armature = rotor});
                Solver solver(by_default(substeps));
                const double fall = load * g * arm.length();
                for (int step = 0; step < testing::long_run(600); ++step) {
                    ASSERT_EQ(solver.step(arm.scene, frame_time).status, StepStatus::done);
                    ASSERT_LT(energy_of(arm, static_cast<double>(rotor), 1.0 / (60 * substeps)), 0.01 * fall)
                        << load << " kg, rotors of " << rotor << ", " << substeps << " substeps, step "
                        << step;
                }
                EXPECT_LT(arm.scene.errors().joint_separation_max, 5e-3);
            }
        }
    }
}

/// How much energy links gain that have rotors of `ratio` times their inertia, start by turning against each other and fall for ten
/// seconds, as a share of that of the fall.
double gain_of(int links, double load, double ratio, const SolverSettings& settings)
{
    const double rotor = ratio * 0.021;
    testing::Arm arm = arm_of(links, load, {.armature = static_cast<float>(rotor)});
    for (std::size_t i = 0; i < arm.links.size(); ++i)
        arm.scene.set_velocity(arm.links[i], {}, {0, 0, i % 2 == 0 ? -3.0F : 3.0F});
    Solver solver(settings);
    EXPECT_EQ(solver.step(arm.scene, 1e-5F).status, StepStatus::done);
    const double at_start = energy_of(arm, rotor, 0), fall = load * g * arm.length() + std::abs(at_start);
    double most = at_start;
    for (int step = 0; step < testing::long_run(600); ++step) {
        EXPECT_EQ(solver.step(arm.scene, frame_time).status, StepStatus::done);
        most = std::fmax(most, energy_of(arm, rotor, 1.0 / (60 * settings.substeps)));
    }
    return (most - at_start) / fall;
}

TEST(ExactRotors, GiveNoEnergyWhateverTheyTurn)
{
    for (const double ratio : {2.0, 4.0, 5.0, 7.0, 10.0, 40.0, 400.0, 2000.0}) {
        double most = 0, most_by_sweeps = 0;
        for (const int links : {2, 5}) {
            for (const double load : {1.0, 9.0}) {
                for (const int substeps : {1, 2, 4}) {
                    if (testing::is_sanitized && (links < 5 || substeps < 4)) continue;
                    SolverSettings settings = by_default(substeps);
                    const double gain = gain_of(links, load, ratio, settings);
                    // As much as without rotors: velocities lag behind positions by half a substep.
                    EXPECT_LT(gain, 0.02) << links << " links, " << load << " kg, " << substeps
                                          << " substeps, rotors " << ratio << " times a link";
                    most = std::fmax(most, gain);
                    settings.exact_above_ratio = std::numeric_limits<float>::infinity();
                    most_by_sweeps = std::fmax(most_by_sweeps, gain_of(links, load, ratio, settings));
                }
            }
        }
        std::printf("rotors of %4g times a link gain %.2g of the fall at most, by sweeps %.2g\n", ratio, most,
                    most_by_sweeps);
    }
}

TEST(ExactRotors, LeaveWeightsToLimits)
{
    for (const int substeps : {1, 4}) {
        for (const bool turned : {false, true}) {
            for (const double load : {1.0, 1e2, 1e4}) {
                testing::Arm arm =
                    arm_of(5, load, {.lower = 0, .upper = 1, .armature = turned ? 5.0F : 0.05F}, turned);
                Solver solver(exact_limits(substeps));
                testing::run(arm.scene, solver, 2);
                testing::expect_held_level(arm, ::testing::Message() << load << " kg, turned " << turned);
            }
        }
    }
}

/// A motor of torque T turns a load of inertia I and a rotor of inertia R: the load gets T I / (I + R).
TEST(ExactRotors, TakeTheirShareOfAMotor)
{
    const double load = 100, reach = 2 * half_link,
                 inertia = 0.021 + half_link * half_link + load * reach * reach + 0.01 * load;
    for (const double share : {0.01, 1.0, 100.0}) {
        for (const int substeps : {4, 16}) {
            const double rotor = share * inertia, torque = 2 * (inertia + rotor);
            testing::Arm arm = arm_of(1, load,
                                      {.motor_speed = 2,
                                       .motor_max_force = static_cast<float>(torque),
                                       .armature = static_cast<float>(rotor)});
            Solver solver(exact_limits(substeps, {}));
            for (int step = 1; step <= 30; ++step) {
                ASSERT_EQ(solver.step(arm.scene, frame_time).status, StepStatus::done);
                const auto speed = static_cast<double>(arm.scene.state(arm.load).angular_velocity.z);
                EXPECT_NEAR(speed / (2 * step / 60.0), 1, 1e-3) << share << ", step " << step;
                const auto told = static_cast<double>(arm.scene.joint_report(arm.drives.front()).torque.z);
                // What is told is what the motor pushed less what the rotor took, whose speed has 24 bits. The first solve drives it
                // to the speed of the motor, before it is known that this would need more than the motor has.
                const double reached = step == 1 ? 2 : speed;
                const double rounding =
                    rotor * reached * 1.2e-7 / (static_cast<double>(frame_time) / substeps);
                EXPECT_NEAR(told / (2 * inertia), 1, 1e-3 + rounding / (2 * inertia))
                    << share << ", step " << step;
            }
        }
    }
}

TEST(ExactRotors, TakeNoMomentumAndGiveNoEnergy)
{
    for (const bool holds_limits : {false, true}) {
        for (const int substeps : {1, 4}) {
            testing::expect_momenta_and_no_energy(
                holds_limits ? exact_limits(substeps, {}) : exact_joints(substeps, {}),
                [](int) { return TwistDriveDefinition{.lower = -1, .upper = 1, .armature = 2}; });
        }
    }
}

/// Sixteen arms are solved in lockstep. One has the same bits whatever rotors, springs, motors and limits the others have.
TEST(ExactRotors, OfAFigureDoNotDependOnTheOtherLanes)
{
    const auto run = [](const TwistDriveDefinition& others) {
        return testing::states_of_watched([&](int i) {
            if (i != testing::watched_arm) return others;
            return TwistDriveDefinition{.lower = -0.2F,
                                        .motor_speed = 2,
                                        .motor_max_force = 300,
                                        .spring_stiffness = 2e4F,
                                        .armature = 3};
        });
    };
    const std::vector<BodyState> among = run({.armature = 1});
    testing::expect_equal(among, run({.lower = -0.1F, .upper = 0.1F, .armature = 50}));
    testing::expect_equal(among, run({.motor_speed = 3, .motor_max_force = 100, .armature = 0.01F}));
    testing::expect_equal(among, run({.spring_stiffness = 1e5F, .spring_max_force = 50, .armature = 2}));
}

TEST(ExactRotors, HaveTheSameBitsForEveryInstructionSetAndThreadCount)
{
    testing::expect_same_bits_of_arms([](int i) {
        TwistDriveDefinition drive{
            .lower = -0.1F, .upper = 0.5F, .armature = 0.1F * static_cast<float>(1 + i % 5)};
        if (i % 2 == 0) drive.spring_stiffness = 1e4F;
        if (i % 3 == 0) drive.motor_speed = 1, drive.motor_max_force = 500;
        return drive;
    });
}

}  // namespace
}  // namespace motley
