// The simultaneous solution in double is the limit of the sequential methods as their iterations grow, from the same
// step. Independent evidence: one linear complementarity problem over the whole scene, solved by active sets on
// Eigen.
#include <gtest/gtest.h>

#include "twin.h"

namespace motley {
namespace {

using testing::Twin;

constexpr float dt = 1.0F / 60;

SolverSettings sequential(int iterations)
{
    SolverSettings settings;
    settings.method = Method::sequential_impulse;
    settings.substeps = 1;
    settings.iterations = iterations;
    settings.gravity = {0.3F, -9.81F, 0.2F};
    return settings;
}

BodyDefinition link(double x, double y, float mass)
{
    BodyDefinition body;
    body.position = {x, y, 0};
    body.mass = mass;
    body.inertia = {0.02F * mass, 0, 0, 0.1F * mass, 0, 0.1F * mass};
    return body;
}

void add_ball_socket(Twin& twin, int a, int b, Vec3<float> at_a, Vec3<float> at_b)
{
    const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b);
    twin.add_joint(BallSocketDefinition{twin.ids[i], twin.ids[j], at_a, at_b});
}

/// A hinge about z.
void add_hinge(Twin& twin, int a, int b, Vec3<float> at_a, Vec3<float> at_b)
{
    const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b);
    const Quat<float> turn{0, -0.70710678F, 0, 0.70710678F};
    twin.add_joint(HingeDefinition{twin.ids[i], twin.ids[j], {at_a, turn}, {at_b, turn}});
}

/// A static body and a level chain of links that hangs on it; the last link has `last_mass` kg.
Twin chain(int links, float last_mass)
{
    Twin twin;
    BodyDefinition post;
    post.motion = BodyMotion::static_body;
    twin.add(post);
    for (int i = 1; i <= links; ++i) {
        twin.add(link(0.5 * i - 0.25, 0, i == links ? last_mass : 1));
        add_ball_socket(twin, i - 1, i, i == 1 ? Vec3<float>{} : Vec3<float>{0.25F, 0, 0}, {-0.25F, 0, 0});
    }
    return twin;
}

/// The largest difference in position and velocity after one step of lanes and one direct step from the same start.
double distance_to_direct(const Twin& start, const SolverSettings& settings,
                          const std::vector<std::pair<std::pair<int, int>, Contact>>& touches = {})
{
    Twin twin = start;
    std::vector<Contact> contacts;
    std::vector<reference::ContactPoint> points;
    for (const auto& [ends, contact] : touches) {
        contacts.push_back(contact);
        contacts.back().body_a = twin.ids[static_cast<std::size_t>(ends.first)];
        contacts.back().body_b = twin.ids[static_cast<std::size_t>(ends.second)];
        points.push_back({ends.first, ends.second, contact});
    }
    Solver solver(settings);
    EXPECT_EQ(solver.step(twin.scene, dt, contacts).status, StepStatus::done);
    EXPECT_LT(twin.world.step_directly(static_cast<double>(dt), settings, points).violation, 1e-9);
    return twin.difference();
}

/// Checks that each tenfold of iterations makes the distance smaller, until it is below `bound`.
void expect_convergence(const char* name, const Twin& twin, double bound,
                        const std::vector<std::pair<std::pair<int, int>, Contact>>& touches = {})
{
    double before = 1e9, distance = 0;
    std::printf("%s: distance to the direct solution (m/s, rad/s)\n", name);
    for (int iterations = 1; iterations <= 10000; iterations *= 10) {
        distance = distance_to_direct(twin, sequential(iterations), touches);
        std::printf("  %6d iterations  %.3g\n", iterations, distance);
        EXPECT_LT(distance, std::max(before, bound)) << name << ", " << iterations << " iterations";
        before = distance;
    }
    EXPECT_LT(distance, bound) << name;
}

TEST(Direct, ChainsConvergeToItAlsoWithAHeavyEnd)
{
    // Floats converge to their rounding times the condition of J M^-1 J^T, which grows with the links and the mass
    // ratio.
    expect_convergence("chain of 6", chain(6, 1), 1e-4);
    expect_convergence("chain of 4, the last 30 times heavier", chain(4, 30), 1e-3);
}

TEST(Direct, AStackOfBallsConvergesToIt)
{
    Twin twin;
    BodyDefinition ground;
    ground.motion = BodyMotion::static_body;
    twin.add(ground);
    std::vector<std::pair<std::pair<int, int>, Contact>> touches;
    for (int i = 1; i <= 5; ++i) {
        twin.add(link(0, i - 0.5, 1));
        Contact contact;
        contact.key = static_cast<std::uint64_t>(i);
        contact.normal = {0, 1, 0};
        contact.separation = i == 4 ? 0.001F : -0.0001F * static_cast<float>(i);  // one has a gap
        contact.arm_a = i == 1 ? Vec3<float>{} : Vec3<float>{0, 0.5F, 0};
        contact.arm_b = {0, -0.5F, 0};
        touches.push_back({{i - 1, i}, contact});
    }
    expect_convergence("stack of 5", twin, 1e-5, touches);
}

TEST(Direct, ADoorOnTwoHingesAndAFourBarLinkageHaveAnAnswer)
{
    // Redundant rows: ten on a door that may turn about one axis, and 20 on a loop of four hinges, whose 18 degrees
    // of freedom leave it one motion. The solution of least norm shares the load, and the velocities satisfy every
    // row.
    Twin door;
    BodyDefinition post;
    post.motion = BodyMotion::static_body;
    door.add(post);
    BodyDefinition leaf = link(0.5, 0, 20);
    leaf.linear_velocity = {0, 0.5F, 0};
    leaf.angular_velocity = {0.5F, 0.2F, 1};
    door.add(leaf);
    add_hinge(door, 0, 1, {0, 0, 0.8F}, {-0.5F, 0, 0.8F});
    add_hinge(door, 0, 1, {0, 0, -0.8F}, {-0.5F, 0, -0.8F});
    Twin swung = door;
    EXPECT_LT(swung.world.step_directly(static_cast<double>(dt), sequential(1), {}).violation, 1e-9);
    const reference::Vector6 v = swung.world.bodies[1].velocity;
    EXPECT_TRUE(v.allFinite());
    EXPECT_NEAR(v(3), 0, 1e-9);  // it turns about z only
    EXPECT_NEAR(v(4), 0, 1e-9);
    EXPECT_GT(v(5), 0.5);
    // The hinges share one load: both carry the same force along z, against gravity across the door.
    EXPECT_NEAR(swung.world.joints[0].impulses[0](2), swung.world.joints[1].impulses[0](2), 1e-6);
    expect_convergence("door on two hinges", door, 2e-4);

    Twin loop;
    loop.add(post);
    BodyDefinition crank = link(0, 0.5, 1), rod = link(0.5, 1, 2), rocker = link(1, 0.5, 1);
    crank.orientation = rocker.orientation = {0, 0, 0.70710678, 0.70710678};
    crank.angular_velocity = rocker.angular_velocity = {0, 0, -1};
    crank.linear_velocity = rocker.linear_velocity = {0.5F, 0, 0};
    rod.linear_velocity = {1, 0, 0};
    for (const BodyDefinition& bar : {crank, rod, rocker}) loop.add(bar);
    add_hinge(loop, 0, 1, {}, {-0.5F, 0, 0});
    add_hinge(loop, 1, 2, {0.5F, 0, 0}, {-0.5F, 0, 0});
    add_hinge(loop, 2, 3, {0.5F, 0, 0}, {0.5F, 0, 0});
    add_hinge(loop, 3, 0, {-0.5F, 0, 0}, {1, 0, 0});
    Twin moved = loop;
    EXPECT_LT(moved.world.step_directly(static_cast<double>(dt), sequential(1), {}).violation, 1e-9);
    EXPECT_TRUE(moved.world.bodies[2].velocity.allFinite());
    EXPECT_NEAR(moved.world.bodies[1].velocity(5), moved.world.bodies[3].velocity(5),
                1e-9);  // a parallelogram
    EXPECT_NEAR(moved.world.bodies[2].velocity(5), 0, 1e-9);
}

TEST(Direct, ALimitThatHoldsAndAMotorAtItsBound)
{
    for (const float force : {0.0F, 2.0F}) {
        Twin twin;
        BodyDefinition post;
        post.motion = BodyMotion::static_body;
        twin.add(post);
        twin.add(link(0.5, 0, 1));
        add_hinge(twin, 0, 1, {}, {-0.5F, 0, 0});
        const Quat<float> turn{0, -0.70710678F, 0, 0.70710678F};
        TwistDriveDefinition drive{.body_a = twin.ids[0],
                                   .body_b = twin.ids[1],
                                   .frame_a = {{}, turn},
                                   .frame_b = {{-0.5F, 0, 0}, turn}};
        drive.lower = 0;
        drive.motor_speed = 5;
        drive.motor_max_force = force;
        twin.add_joint(drive);
        expect_convergence(force > 0 ? "bar at its limit, motor at its bound" : "bar at its limit", twin,
                           1e-5);
    }
}

}  // namespace
}  // namespace motley
