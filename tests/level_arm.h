// A level arm of light links that bears a load by drives, for tests of exact limits, motors and springs.
#pragma once

#include <utility>
#include <vector>

#include "rig.h"

namespace motley::testing {

inline constexpr double half_link = 0.25, g = 9.81;

inline SolverSettings exact_limits(int substeps, Vec3<float> gravity = {0, -9.81F, 0})
{
    SolverSettings settings = with_gravity(gravity);
    settings.exact_joints = settings.exact_limits = true;
    settings.substeps = substeps;
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

/// The states of a body of these arms, which must be solved in lockstep, for a second.
inline std::vector<BodyState> states_in_lockstep(Arm& arms, BodyId watched)
{
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

}  // namespace motley::testing
