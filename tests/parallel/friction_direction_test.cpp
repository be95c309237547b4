// Coulomb's law where bodies respond differently in different directions: friction at its bound must be opposite to
// the slip. Independent evidence: the law itself. The remaining slip is computed here in double from the velocities
// after a step, the friction is what the step reports, and neither is compared with another solver. The comparison
// with core/reference (reference_comparison_test.cpp) is no evidence here, because the reference uses the same
// formula in a sweep as the lanes.
#include "box_heap.h"

namespace motley {
namespace {

using testing::across;
using testing::degrees_between;
using testing::frame_time;
using testing::HeapOfBoxes;
using testing::length;
using testing::plain_sweeps;
using testing::Vector;
using testing::velocity_at;

/// A rod of 1 m and 1 kg that slides on its lower end, `tilt` rad from upright, in a direction oblique to its tilt.
struct SlidingRod {
    Scene scene;
    BodyId rod{};
    Vec3<float> arm{};  ///< from its middle to its lower end

    explicit SlidingRod(double tilt, Vec3<float> spin = {})
    {
        const double half = 0.5;
        arm = {static_cast<float>(-half * std::sin(tilt)), static_cast<float>(-half * std::cos(tilt)), 0};
        BodyDefinition body;
        body.mass = 1;
        body.inertia = {1.0F / 12, 0, 0, 2e-4F, 0, 1.0F / 12};  // along its own y
        body.position = {half * std::sin(tilt), half * std::cos(tilt), 0};
        body.orientation = {0, 0, -std::sin(tilt / 2), std::cos(tilt / 2)};
        body.linear_velocity = {2, 0, 1.5F};
        body.angular_velocity = spin;
        rod = scene.add_body(body);
    }
    /// Slip of the lower end across the floor, after a step.
    [[nodiscard]] Vector slip() const { return across(velocity_at(scene.state(rod), arm), {0, 1, 0}); }
};

// The largest angle between friction and the direction opposite to the slip, degrees. A step in float is off by about
// 1e-5.
constexpr double most_degrees = 0.05;
/// s: so short that rows do not turn, and spins do not change with the turn of their body.
constexpr float instant = 1e-4F;

class SlidingRodAtATilt : public ::testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Tilts, SlidingRodAtATilt, ::testing::Values(0.3, 0.6, 0.9));

TEST_P(SlidingRodAtATilt, IsBrakedAgainstItsSlipByAContact)
{
    for (const int iterations : {100, 1000}) {
        SlidingRod rod(GetParam());
        Contact contact;
        contact.body_a = rod.scene.ground();
        contact.body_b = rod.rod;
        contact.normal = {0, 1, 0};
        contact.arm_a = {};
        contact.arm_b = rod.arm;
        contact.friction = 0.3F;
        ASSERT_EQ(Solver(plain_sweeps(iterations)).step(rod.scene, frame_time, {&contact, 1}).status,
                  StepStatus::done);
        const ContactImpulse impulse = rod.scene.contact_impulses()[0];
        const Vector friction = convert<double>(impulse.friction);
        ASSERT_GT(length(rod.slip()), 0.1);
        ASSERT_NEAR(length(friction), 0.3 * static_cast<double>(impulse.normal), 1e-5);
        const double off = degrees_between(friction, -rod.slip());
        std::printf("tilt %.1f, %4d sweeps: friction %.2g degrees off\n", GetParam(), iterations, off);
        EXPECT_LT(off, most_degrees) << iterations << " sweeps";
    }
}

ManifoldDefinition end_of(const SlidingRod& rod)
{
    ManifoldDefinition contact{rod.scene.ground(), rod.rod};
    contact.normal = {0, 1, 0};
    contact.point_count = 1;
    contact.points[0] = {{0, 0, 0}, {0, -0.5F, 0}};
    contact.friction = 0.3F;
    return contact;
}

TEST_P(SlidingRodAtATilt, IsBrakedAgainstItsSlipByAManifold)
{
    for (const int iterations : {100, 1000}) {
        SlidingRod rod(GetParam());
        const ConstraintId joint = rod.scene.add_joint(end_of(rod));
        ASSERT_EQ(Solver(plain_sweeps(iterations)).step(rod.scene, frame_time).status, StepStatus::done);
        const Vector force = convert<double>(rod.scene.joint_report(joint).force);
        ASSERT_GT(length(rod.slip()), 0.1);
        EXPECT_LT(degrees_between(across(force, {0, 1, 0}), -rod.slip()), most_degrees)
            << iterations << " sweeps";
    }
}

TEST_P(SlidingRodAtATilt, IsBrakedAgainstItsSlipItsSpinAndItsRollByAManifold)
{
    // Friction, torsion and rolling friction are all at their bounds.
    SlidingRod rod(GetParam(), {3, 6, 2});
    ManifoldDefinition contact = end_of(rod);
    contact.torsional_radius = 0.005F;
    contact.rolling_radius = 0.005F;
    const ConstraintId joint = rod.scene.add_joint(contact);
    ASSERT_EQ(Solver(plain_sweeps(100)).step(rod.scene, instant).status, StepStatus::done);
    const JointReport report = rod.scene.joint_report(joint);
    const Vector up{0, 1, 0}, force = convert<double>(report.force), torque = convert<double>(report.torque),
                              spin = convert<double>(rod.scene.state(rod.rod).angular_velocity);
    ASSERT_GT(length(rod.slip()), 0.1);
    ASSERT_GT(length(across(spin, up)), 0.1);
    ASSERT_GT(std::abs(spin.y), 0.1);
    EXPECT_LT(degrees_between(across(force, up), -rod.slip()), most_degrees);
    EXPECT_LT(degrees_between(across(torque, up), -across(spin, up)), most_degrees);
    EXPECT_LT(torque.y * spin.y, 0);
    EXPECT_NEAR(std::abs(torque.y), 0.3 * 0.005 * force.y, 1e-4 * force.y);
    EXPECT_NEAR(length(across(torque, up)), 0.005 * force.y, 1e-4 * force.y);
}

TEST(Servo, WithoutStrengthEnoughPullsAgainstTheVelocityThatIsLeft)
{
    // A motor that should stop a point off the centre of a tilted rod, and is too weak.
    SlidingRod rod(0.6, {1, -2, 0.5F});
    PointServoDefinition servo{rod.scene.ground(), rod.rod, {}, {0, -0.5F, 0}};
    servo.hertz = 0;
    servo.max_force = 20;
    const ConstraintId joint = rod.scene.add_joint(servo);
    SolverSettings settings = plain_sweeps(100);
    settings.gravity = {};
    ASSERT_EQ(Solver(settings).step(rod.scene, instant).status, StepStatus::done);
    const Vector force = convert<double>(rod.scene.joint_report(joint).force);
    const Vector left = velocity_at(rod.scene.state(rod.rod), rod.arm);
    ASSERT_GT(length(left), 0.1);
    EXPECT_NEAR(length(force), 20, 1e-3);
    EXPECT_LT(degrees_between(force, -left), most_degrees);
}

TEST(Servo, WithoutStrengthEnoughTurnsAgainstTheSpinThatIsLeft)
{
    // Frames with the same orientation and frames a radian apart, for which rows and torques have different
    // directions.
    for (const double apart : {0.0, 1.0}) {
        SlidingRod rod(0.6, {3, 2, -1});
        AngularServoDefinition servo{rod.scene.ground(), rod.rod};
        servo.frame_a.rotation = {static_cast<float>(std::sin(apart / 2)), 0, 0,
                                  static_cast<float>(std::cos(apart / 2))};
        servo.hertz = 0;
        servo.max_torque = 2;
        const ConstraintId joint = rod.scene.add_joint(servo);
        SolverSettings settings = plain_sweeps(200);
        settings.gravity = {};
        ASSERT_EQ(Solver(settings).step(rod.scene, instant).status, StepStatus::done);
        const Vector torque = convert<double>(rod.scene.joint_report(joint).torque);
        const Vector left = convert<double>(rod.scene.state(rod.rod).angular_velocity);
        ASSERT_GT(length(left), 0.1);
        EXPECT_NEAR(length(torque), 2, 1e-3);
        EXPECT_LT(degrees_between(torque, -left), most_degrees) << apart;
    }
}

/// The residual after so many sweeps, as a share of the fastest slip without contacts, in a step so short that no box
/// turns.
double share_left(float ratio, int iterations, Method method = Method::sequential_impulse)
{
    HeapOfBoxes heap(ratio);
    const double free = heap.fastest();
    SolverSettings settings = plain_sweeps(iterations);
    settings.method = method;
    EXPECT_EQ(Solver(settings).step(heap.scene, 1e-6F, heap.contacts).status, StepStatus::done);
    const double left = heap.residual() / free;
    std::printf("masses 1 to %g, method %d, %5d sweeps: %.2g of %.2g m/s left\n", static_cast<double>(ratio),
                static_cast<int>(method), iterations, left, free);
    return left;
}

TEST(HeapOfBoxes, ComesToCoulombsLawAsSweepsGrow)
{
    EXPECT_LT(share_left(1, 100), 1e-2);
    EXPECT_LT(share_left(1, 1000), 1e-3);
    EXPECT_LT(share_left(1, 10000), 1e-5);
    // The direct method, which does not sweep, satisfies the law as well.
    EXPECT_LT(share_left(1, 1, Method::direct), 1e-5);
}

TEST(HeapOfBoxes, OfMassesAThousandTimesApartComesThereToo)
{
    const double few = share_left(1000, 100), many = share_left(1000, 1000), most = share_left(1000, 10000);
    EXPECT_LT(many, few / 1.5);
    EXPECT_LT(most, many / 5);
}

}  // namespace
}  // namespace motley
