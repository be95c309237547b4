// Light links with drives: a level arm that bears a load, and a chain afloat, for tests of exact limits, motors, springs and rotors.
#pragma once

#include <utility>
#include <vector>

#include "every_way.h"
#include "rig.h"

namespace motley::testing {

inline constexpr double half_link = 0.25, g = 9.81;

inline SolverSettings by_default(int substeps, Vec3<float> gravity = {0, -9.81F, 0})
{
    SolverSettings settings = with_gravity(gravity);
    settings.substeps = substeps;
    return settings;
}
inline SolverSettings exact_joints(int substeps, Vec3<float> gravity = {0, -9.81F, 0})
{
    SolverSettings settings = by_default(substeps, gravity);
    settings.exact_joints = true;
    return settings;
}
inline SolverSettings exact_limits(int substeps, Vec3<float> gravity = {0, -9.81F, 0})
{
    SolverSettings settings = exact_joints(substeps, gravity);
    settings.exact_limits = true;
    return settings;
}

/// Links of 1 kg and 0.5 m along x from the ground, hinged about z, and a load fixed to the end of the last one.
struct Arm {
    Scene scene;
    std::vector<BodyId> links;
    BodyId load{};
    std::vector<ConstraintId> drives;
    std::vector<TwistDriveDefinition> definitions;
    double mass = 0;

    [[nodiscard]] double length() const { return 2 * half_link * static_cast<double>(links.size()); }
    [[nodiscard]] double angle() const
    {
        const Vec3<double> at = scene.state(load).position;
        return std::atan2(at.y, at.x);
    }
    /// The torque about z that holds what is beyond a joint, with the arm along x.
    [[nodiscard]] double torque_at(std::size_t joint) const
    {
        const double beyond = static_cast<double>(links.size() - joint);
        return g * (mass * 2 * half_link * beyond + half_link * beyond * beyond);
    }
};

/// A drive for each joint, of which `drive` says the limits and the motor about z. `turned`: joints have the outer body as
/// their body a, which turns the sign of their coordinate.
inline void add_arm(Arm& arm, int count, double mass, TwistDriveDefinition drive, bool turned, double z)
{
    arm.mass = mass;
    arm.links.clear();
    arm.drives.clear();
    arm.definitions.clear();
    const auto about_z = axis_along(2);
    if (turned) {
        drive.motor_speed = -drive.motor_speed;
        std::swap(drive.lower, drive.upper);
        drive.lower = -drive.lower;
        drive.upper = -drive.upper;
    }
    BodyId before = arm.scene.ground();
    for (int i = 0; i < count; ++i) {
        BodyDefinition link;
        link.position = {half_link * (2 * i + 1), 0, z};
        link.mass = 1;
        link.inertia = {0.001F, 0, 0, 0.021F, 0, 0.021F};
        const BodyId body = arm.scene.add_body(link);
        JointFrame inner{{static_cast<float>(half_link), 0, 0}, about_z};
        if (i == 0) inner.position = {0, 0, static_cast<float>(z)};
        const JointFrame outer{{-static_cast<float>(half_link), 0, 0}, about_z};
        HingeDefinition hinge{before, body, inner, outer};
        drive.body_a = before, drive.body_b = body;
        drive.frame_a = inner, drive.frame_b = outer;
        if (turned) {
            std::swap(hinge.body_a, hinge.body_b), std::swap(hinge.frame_a, hinge.frame_b);
            std::swap(drive.body_a, drive.body_b), std::swap(drive.frame_a, drive.frame_b);
        }
        arm.scene.add_joint(hinge);
        arm.drives.push_back(arm.scene.add_joint(drive));
        arm.definitions.push_back(drive);
        arm.links.push_back(body);
        before = body;
    }
    BodyDefinition load;
    load.position = {arm.length(), 0, z};
    load.mass = static_cast<float>(mass);
    const float inertia = 0.01F * load.mass;
    load.inertia = {inertia, 0, 0, inertia, 0, inertia};
    arm.load = arm.scene.add_body(load);
    arm.scene.add_joint(FixedDefinition{before, arm.load, {{static_cast<float>(half_link), 0, 0}}, {}});
}
inline Arm arm_of(int count, double mass, const TwistDriveDefinition& drive, bool turned = false)
{
    Arm arm;
    add_arm(arm, count, mass, drive, turned, 0);
    return arm;
}

/// Limits hold the arm along x, with the torques of statics.
inline void expect_held_level(const Arm& arm, const ::testing::Message& what)
{
    const Vec3<double> at = arm.scene.state(arm.load).position;
    EXPECT_LT(length(at - Vec3<double>{arm.length(), 0, 0}), 1e-6) << what;
    for (std::size_t joint = 0; joint < arm.drives.size(); ++joint) {
        const double torque =
            std::abs(static_cast<double>(arm.scene.joint_report(arm.drives[joint]).torque.z));
        EXPECT_NEAR(torque / arm.torque_at(joint), 1, 1e-3) << what << ", joint " << joint;
    }
}

/// For a second, the states of the load of one of sixteen arms, which must be solved in lockstep. drive_of(which) are their drives.
inline constexpr int watched_arm = 5;
template <class DriveOf>
std::vector<BodyState> states_of_watched(const DriveOf& drive_of)
{
    Arm arms;
    BodyId watched{};
    for (int i = 0; i < 16; ++i) {
        add_arm(arms, 3, 100, drive_of(i), false, 5.0 * i);
        if (i == watched_arm) watched = arms.load;
    }
    Solver solver(exact_limits(4));
    std::vector<BodyState> states;
    for (int step = 0; step < 60; ++step) {
        const StepReport report = solver.step(arms.scene, frame_time);
        EXPECT_GT(report.joints_in_lockstep, 0);
        states.push_back(arms.scene.state(watched));
    }
    return states;
}
/// The height and the speed of the body, to the bit.
inline void expect_equal(const std::vector<BodyState>& one, const std::vector<BodyState>& other)
{
    ASSERT_EQ(one.size(), other.size());
    for (std::size_t step = 0; step < one.size(); ++step) {
        EXPECT_EQ(one[step].position.y, other[step].position.y) << step;
        EXPECT_EQ(one[step].linear_velocity.y, other[step].linear_velocity.y) << step;
    }
}

/// Arms with these drives have the same bits for every instruction set and thread count, in lockstep and swept by colour.
template <class DriveOf>
void expect_same_bits_of_arms(const DriveOf& drive_of)
{
    for (const bool sweeps : {false, true}) {
        const auto run = [&](const SolverOptions& options) {
            Arm arms;
            for (int i = 0; i < 21; ++i) add_arm(arms, 3, 30 * (1 + i), drive_of(i), i % 2 == 0, 5.0 * i);
            Solver solver(sweeps ? swept(exact_limits(2)) : exact_limits(2), options);
            std::vector<std::uint64_t> hashes;
            for (int step = 0; step < long_run(120, 20); ++step) {
                EXPECT_EQ(solver.step(arms.scene, frame_time).status, StepStatus::done);
                hashes.push_back(arms.scene.state_hash());
            }
            return hashes;
        };
        expect_same_bits(run);
    }
}

/// Boxes of 50 and 1 kg in turn, hinged about z, afloat and spinning.
class ChainAfloat {
  public:
    Scene scene;

    template <class DriveOf>
    explicit ChainAfloat(const DriveOf& drive_of)
    {
        for (int i = 0; i < 5; ++i) {
            BodyDefinition link = box({0.5 * i, 0, 0}, static_cast<float>(mass_of(i)));
            link.linear_velocity = {0.3F, -0.2F, 0.1F};
            link.angular_velocity = {0, 0, i % 2 == 0 ? 1.0F : -1.0F};
            links_.push_back(scene.add_body(link));
            if (i == 0) continue;
            HingeDefinition hinge{
                links_[links_.size() - 2], links_.back(), {{0.25F, 0, 0}}, {{-0.25F, 0, 0}}};
            hinge.frame_a.rotation = hinge.frame_b.rotation = axis_along(2);
            scene.add_joint(hinge);
            TwistDriveDefinition drive = drive_of(i);
            drive.body_a = hinge.body_a, drive.body_b = hinge.body_b;
            drive.frame_a = hinge.frame_a, drive.frame_b = hinge.frame_b;
            scene.add_joint(drive);
            rotors_.push_back(static_cast<double>(drive.armature));
        }
    }
    struct Sums {
        Vec3<double> p{}, l{};
        double energy = 0;  ///< kinetic, of bodies and rotors
    };
    [[nodiscard]] Sums sums() const
    {
        Sums sum;
        double before = 0;
        for (std::size_t i = 0; i < links_.size(); ++i) {
            const double m = mass_of(static_cast<int>(i));
            const BodyState state = scene.state(links_[i]);
            const Vec3<double> v = convert<double>(state.linear_velocity);
            sum.p = sum.p + m * v;
            sum.l = sum.l + angular_momentum(state, m, {0.1 * m, 0.2 * m, 0.25 * m});
            const auto w = static_cast<double>(state.angular_velocity.z);
            sum.energy += 0.5 * m * dot(v, v) + 0.5 * 0.25 * m * w * w;
            if (i > 0) sum.energy += 0.5 * rotors_[i - 1] * (w - before) * (w - before);
            before = w;
        }
        return sum;
    }

  private:
    std::vector<BodyId> links_;
    std::vector<double> rotors_;
    static double mass_of(int link) { return link % 2 == 0 ? 50 : 1; }
};

/// Such a chain keeps its momenta and gains no energy in four seconds.
template <class DriveOf>
void expect_momenta_and_no_energy(const SolverSettings& settings, const DriveOf& drive_of)
{
    ChainAfloat chain(drive_of);
    Solver solver(settings);
    ASSERT_EQ(solver.step(chain.scene, 1e-6F).status, StepStatus::done);
    const ChainAfloat::Sums before = chain.sums();
    for (int step = 0; step < 240; ++step) {
        ASSERT_EQ(solver.step(chain.scene, frame_time).status, StepStatus::done);
        EXPECT_LT(chain.sums().energy, 1.001 * before.energy)
            << settings.substeps << " substeps, step " << step;
    }
    const ChainAfloat::Sums now = chain.sums();
    EXPECT_LT(length(now.p - before.p), 1e-5 * length(before.p)) << settings.substeps;
    EXPECT_LT(length(now.l - before.l), 1e-4 * length(before.l)) << settings.substeps;
}

}  // namespace motley::testing
