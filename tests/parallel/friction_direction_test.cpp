// Coulomb's law where the bodies answer one direction more than another: friction at its bound points against the slip.
// Independent evidence: the law itself. The slip that is left is computed here in double from the velocities that a step
// leaves, the friction is what the step reports, and neither is compared with another solver. The comparison with
// core/reference (reference_comparison_test.cpp) shares the formula of a sweep with the lanes, and is no evidence for it.
#include "mixed_scene.h"
#include "rig.h"

namespace motley {
namespace {

using testing::frame_time;
using Vector = Vec3<double>;

double length(const Vector& v)
{
    return std::sqrt(dot(v, v));
}
/// What of v is across a unit vector.
Vector across(const Vector& v, const Vector& n)
{
    return v - dot(n, v) * n;
}
/// Velocity of the point at `arm` from the centre of mass.
Vector velocity_at(const BodyState& state, const Vec3<float>& arm)
{
    return convert<double>(state.linear_velocity) +
           cross(convert<double>(state.angular_velocity), convert<double>(arm));
}
/// Degrees between two vectors, by the sine where it is small.
double degrees_between(const Vector& u, const Vector& v)
{
    return std::atan2(length(cross(u, v)), dot(u, v)) * 180 / 3.14159265358979;
}

/// Rigid constraints alone, in one step without correction of positions.
SolverSettings plain_sweeps(int iterations)
{
    SolverSettings settings = testing::with_gravity({0, -9.81F, 0});
    settings.method = Method::sequential_impulse;
    settings.drift_correction = DriftCorrection::none;
    settings.substeps = 1;
    settings.iterations = iterations;
    return settings;
}

/// A rod of 1 m and 1 kg that slides on its lower end, `tilt` rad from upright, neither along its tilt nor across it.
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
    /// Across the floor, after a step.
    [[nodiscard]] Vector slip() const { return across(velocity_at(scene.state(rod), arm), {0, 1, 0}); }
};

// Below this friction is against the slip, in degrees. A step in float leaves some 1e-5.
constexpr double most_degrees = 0.05;

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
    // Friction, torsion and rolling friction all at their bounds.
    SlidingRod rod(GetParam(), {3, 6, 2});
    ManifoldDefinition contact = end_of(rod);
    contact.torsional_radius = 0.005F;
    contact.rolling_radius = 0.005F;
    const ConstraintId joint = rod.scene.add_joint(contact);
    ASSERT_EQ(Solver(plain_sweeps(100)).step(rod.scene, frame_time).status, StepStatus::done);
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
    // A motor that is to stop a point off the centre of a tilted rod, and cannot.
    SlidingRod rod(0.6, {1, -2, 0.5F});
    PointServoDefinition servo{rod.scene.ground(), rod.rod, {}, {0, -0.5F, 0}};
    servo.hertz = 0;
    servo.max_force = 20;
    const ConstraintId joint = rod.scene.add_joint(servo);
    SolverSettings settings = plain_sweeps(100);
    settings.gravity = {};
    ASSERT_EQ(Solver(settings).step(rod.scene, frame_time).status, StepStatus::done);
    const Vector force = convert<double>(rod.scene.joint_report(joint).force);
    const Vector left = velocity_at(rod.scene.state(rod.rod), rod.arm);
    ASSERT_GT(length(left), 0.1);
    EXPECT_NEAR(length(force), 20, 1e-3);
    EXPECT_LT(degrees_between(force, -left), most_degrees);
}

TEST(Servo, WithoutStrengthEnoughTurnsAgainstTheSpinThatIsLeft)
{
    // Frames apart by a radian, so that rows and torques are not the same. A step so short that no row turns.
    constexpr float instant = 1e-4F;
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

/// Nine columns of three slabs, each on four corners of the one below, leaning on their neighbours, everything moving: some
/// contacts stick, most slide, some part. Masses grow `ratio` times from slab to slab.
struct HeapOfBoxes {
    Scene scene;
    std::vector<BodyId> boxes;
    std::vector<Contact> contacts;

    explicit HeapOfBoxes(float ratio)
    {
        testing::Random random(7);
        const auto r = [&] { return static_cast<float>(random.symmetric()); };
        const Vec3<float> half{0.5F, 0.15F, 0.3F};
        for (int i = 0; i < 27; ++i) {
            const int x = i % 3, z = i / 3 % 3, level = i / 9;
            BodyDefinition box;
            box.position = {2.0 * static_cast<double>(half.x) * x,
                            static_cast<double>(half.y) * (2 * level + 1),
                            2.0 * static_cast<double>(half.z) * z};
            box.mass = (i % 2 == 0 ? 1.0F : ratio) * (1 + 0.3F * r());
            const float third = box.mass / 3;
            box.inertia = {
                third * (half.y * half.y + half.z * half.z), 0, 0,
                third * (half.x * half.x + half.z * half.z), 0, third * (half.x * half.x + half.y * half.y)};
            box.linear_velocity = {r(), 0.3F * r(), r()};
            box.angular_velocity = {r(), r(), r()};
            boxes.push_back(scene.add_body(box));
        }
        for (int i = 0; i < 27; ++i) {
            for (const float x : {-1.0F, 1.0F}) {
                for (const float z : {-1.0F, 1.0F}) {
                    touch(i < 9 ? -1 : i - 9, i, {0.1F * r(), 1, 0.1F * r()},
                          {x * half.x, -half.y, z * half.z});
                }
            }
            if (i % 3 > 0) touch(i - 1, i, {1, 0.1F * r(), 0.1F * r()}, {-half.x, 0.1F * r(), 0.2F * r()});
            if (i / 3 % 3 > 0)
                touch(i - 3, i, {0.1F * r(), 0.1F * r(), 1}, {0.4F * r(), 0.1F * r(), -half.z});
        }
    }
    /// Below 0 is the ground.
    void touch(int a, int b, const Vec3<float>& normal, const Vec3<float>& arm_b)
    {
        Contact contact;
        contact.body_b = boxes[static_cast<std::size_t>(b)];
        contact.body_a = a < 0 ? scene.ground() : boxes[static_cast<std::size_t>(a)];
        contact.key = contacts.size() + 1;
        contact.normal = 1 / std::sqrt(dot(normal, normal)) * normal;
        contact.arm_b = arm_b;
        const Vector between =
            scene.state(contact.body_b).position - (a < 0 ? Vector{} : scene.state(contact.body_a).position);
        contact.arm_a = convert<float>(between + convert<double>(arm_b));
        contact.friction = 0.4F;
        contacts.push_back(contact);
    }
    [[nodiscard]] double mass_of(BodyId body) const
    {
        return body == scene.ground() ? 1e30
                                      : 1 / static_cast<double>(scene.bodies().inverse_masses[body.slot]);
    }
    [[nodiscard]] Vector speed(const Contact& c) const
    {
        const Vector a = c.body_a == scene.ground() ? Vector{} : velocity_at(scene.state(c.body_a), c.arm_a);
        return velocity_at(scene.state(c.body_b), c.arm_b) - a;
    }
    /// The fastest that points move against each other.
    [[nodiscard]] double fastest() const
    {
        double most = 0;
        for (const Contact& c : contacts) most = std::max(most, length(speed(c)));
        return most;
    }
    /// How far the last step is from Coulomb's law, m/s: the largest part of the natural map lambda - P(lambda - m w) over m,
    /// P the nearest point of the cone's section and of the half line, m of a pair of points of these masses.
    [[nodiscard]] double residual() const
    {
        double most = 0;
        for (std::size_t i = 0; i < contacts.size(); ++i) {
            const Contact& c = contacts[i];
            const Vector n = convert<double>(c.normal), w = speed(c);
            const double m = 1 / (1 / mass_of(c.body_a) + 1 / mass_of(c.body_b));
            const auto push = static_cast<double>(scene.contact_impulses()[i].normal);
            const Vector friction = convert<double>(scene.contact_impulses()[i].friction);
            most = std::max(most, std::abs(push - std::max(push - m * dot(n, w), 0.0)) / m);
            Vector nearest = friction - m * across(w, n);
            const double bound = static_cast<double>(c.friction) * push;
            if (length(nearest) > bound) nearest = bound / length(nearest) * nearest;
            most = std::max(most, length(friction - nearest) / m);
        }
        return most;
    }
};

/// Residuals over the fastest free slip, after so many sweeps.
double share_left(float ratio, int iterations, Method method = Method::sequential_impulse)
{
    HeapOfBoxes heap(ratio);
    const double free = heap.fastest();
    SolverSettings settings = plain_sweeps(iterations);
    settings.method = method;
    EXPECT_EQ(Solver(settings).step(heap.scene, frame_time, heap.contacts).status, StepStatus::done);
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
    // And so does the solution of all at once, which no sweep has touched.
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
