// Capsules at turnstiles, at belts and at walls that give way. Independent evidence: free motion, closed forms of sliding
// and rolling, differences of forces, and the sides of points.
#include <gtest/gtest.h>

#include <cmath>

#include "rig.h"
#include "shape_crowd.h"

namespace motley {
namespace {

constexpr float dt = 1.0F / 60;
constexpr float radius = 0.12F;

/// A person seen from above as a capsule along x, 0.4 m between the ends of its axis.
BodyId add_torso(Scene& scene, const Vec2<double>& at, float friction = 0)
{
    const BodyId torso = scene.add_body({.model = BodyModel::planar,
                                         .position = {at.x, at.y, 0},
                                         .mass = 80,
                                         .inertia = {1, 0, 0, 1, 0, 2.5F}});
    scene.add_capsule(
        {.body = torso, .from = {-0.2F, 0, 0}, .to = {0.2F, 0, 0}, .radius = radius, .friction = friction});
    return torso;
}

void run(Solver& solver, Scene& scene, int steps)
{
    for (int step = 0; step < steps; ++step) {
        const StepReport report = solver.step(scene, dt);
        ASSERT_EQ(report.status, StepStatus::done) << report.error;
    }
}

/// Nobody pushes who passes a turnstile, even turning in it, so the motion is that of a free body.
TEST(ShapeWalls, ATorsoPassesATurnstileFreelyAndHasNoWayBack)
{
    Scene scene;
    const Vec2<double> ends[] = {{0, -5}, {0, 5}};  // the left side is that of negative x
    scene.add_wall({.points = ends, .one_way = true});
    const BodyId torso = add_torso(scene, {1, 0}), free = scene.add_body({.model = BodyModel::planar,
                                                                          .position = {1, 0, 0},
                                                                          .mass = 80,
                                                                          .inertia = {1, 0, 0, 1, 0, 2.5F}});
    for (const BodyId body : {torso, free}) scene.set_velocity(body, {-0.7F, 0.3F, 0}, {0, 0, 1.5F});
    Solver solver(SolverSettings{});
    run(solver, scene, 60);
    ASSERT_NEAR(scene.state(torso).position.x, 0.3, 0.01) << "in the turnstile";
    run(solver, scene, 120);
    ASSERT_LT(scene.state(torso).position.x, -0.5);
    EXPECT_EQ(scene.state(torso).position.x, scene.state(free).position.x);
    EXPECT_EQ(scene.state(torso).linear_velocity.x, scene.state(free).linear_velocity.x);
    EXPECT_EQ(scene.state(torso).yaw, scene.state(free).yaw);
    EXPECT_TRUE(scene.shape_contacts().empty());

    scene.set_pose(torso, {-1, 0, 0}, {0, 0, 0, 1}, 1.5707963267948966);
    scene.set_velocity(torso, {}, {});
    scene.set_force(torso, {200, 0, 0}, {});
    run(solver, scene, 240);
    EXPECT_NEAR(scene.state(torso).position.x, -0.12, 0.002) << "flat against the wall";
    float force = 0;
    for (const ShapeContact& contact : scene.shape_contacts()) force += contact.normal_force;
    EXPECT_NEAR(force, 200, 1);
}

/// A body that goes back half-way through a turnstile was never held, and leaves as it came.
TEST(ShapeWalls, WhoTurnsBackInATurnstileMovesFreely)
{
    Scene scene;
    const Vec2<double> ends[] = {{0, -5}, {0, 5}};
    scene.add_wall({.points = ends, .one_way = true});
    const BodyId torso = add_torso(scene, {0.5, 0});
    Solver solver(SolverSettings{});
    scene.set_velocity(torso, {-0.6F, 0, 0}, {});
    run(solver, scene, 60);
    EXPECT_NEAR(scene.state(torso).position.x, -0.1, 1e-5);
    scene.set_velocity(torso, {0.6F, 0, 0}, {});
    run(solver, scene, 60);
    EXPECT_NEAR(scene.state(torso).position.x, 0.5, 1e-5);
}

/// What is held stays held, pressed into the wall as deep as contacts give way, when a wall before it in the list goes,
/// in a copy, and in a scene from a file.
TEST(ShapeWalls, ATurnstileRemembersWhomItHolds)
{
    Scene scene;
    const Vec2<double> elsewhere[] = {{50, 0}, {51, 0}, {52, 0}}, ends[] = {{0, -5}, {0, 5}};
    const WallId other = scene.add_wall({.points = elsewhere, .one_way = true});
    scene.add_wall({.points = ends, .one_way = true});
    const BodyId torso = add_torso(scene, {-0.5, 0});
    scene.set_force(torso, {3000, 0, 0}, {});
    Solver solver(SolverSettings{});
    run(solver, scene, 120);
    ASSERT_GT(scene.state(torso).position.x, -0.32 + 1e-4) << "overlapping, or this shows nothing";
    Scene loaded = load_scene(save_scene(scene)), copy = scene;
    scene.remove_wall(other);
    for (Scene* each : {&scene, &loaded, &copy}) {
        run(solver, *each, 120);
        EXPECT_NEAR(each->state(torso).position.x, -0.32, 0.01);
        EXPECT_EQ(each->shape_contacts().size(), 1U);
    }
    EXPECT_EQ(loaded.state_hash(), copy.state_hash());
}

/// Torsos and discs thrown about at up to 20 m/s: who is to the left of the turnstiles never comes back.
TEST(ShapeWalls, NobodyComesBackThroughATurnstile)
{
    Scene scene;
    testing::Random random;
    constexpr double side = 8;
    const Vec2<double> corners[] = {{0, 0}, {side, 0}, {side, side}, {0, side}};
    scene.add_wall({.points = corners, .closed = true});
    const Vec2<double> across[] = {{side / 2, -1}, {side / 2, side + 1}};
    scene.add_wall({.points = across, .one_way = true});
    std::vector<BodyId> people;
    for (int i = 0; i < 48; ++i) {
        const Vec2<double> at{0.6 + 0.97 * (i % 8), 0.8 + 1.2 * static_cast<double>(i / 8)};
        people.push_back(add_torso(scene, at, 0.2F));
    }
    Solver solver(SolverSettings{});
    std::vector<bool> has_passed(people.size());
    int passed = 0;
    for (int step = 0; step < testing::long_run(3000); ++step) {
        for (int k = 0; k < 4; ++k) {
            const auto speed = [&] { return 20 * static_cast<float>(random.symmetric()); };
            BodyId who = people[static_cast<std::size_t>(random.below(48))];
            const float x = speed(), y = speed(), turns = speed();
            scene.set_velocity(who, {x, y, 0}, {0, 0, turns});
        }
        run(solver, scene, 1);
        for (std::size_t i = 0; i < people.size(); ++i) {
            const Vec3<double> at = scene.state(people[i]).position;
            ASSERT_TRUE(at.x > 0 && at.x < side && at.y > 0 && at.y < side)
                << "person " << i << ", step " << step;
            if (has_passed[i]) {
                ASSERT_LT(at.x, side / 2) << "person " << i << ", step " << step;
            } else if (at.x < side / 2 - 0.33) {
                has_passed[i] = true;
                ++passed;
            }
        }
    }
    EXPECT_GT(passed, testing::long_run(40));
}

class SurfacesOfWalls : public ::testing::TestWithParam<Method> {};

/// A torso pressed flat on a belt slides with mu N / m until it is as fast as the belt. Friction acts at one radius from
/// its middle, so that the point in front bears more: N/2 + mu N r / d of the two, d apart, while it slides.
TEST_P(SurfacesOfWalls, ABeltTakesATorsoAlong)
{
    for (const double side : {1.0, -1.0}) {
        Scene scene;
        const Vec2<double> ends[] = {{-10, 0}, {10, 0}};
        scene.add_wall({.points = ends, .friction = 0.5F, .surface_speed = 1});
        const BodyId torso = add_torso(scene, {0, side * static_cast<double>(radius)}, 0.5F);
        scene.set_force(torso, {0, static_cast<float>(-100 * side), 0}, {});
        Solver solver({.method = GetParam()});
        run(solver, scene, 60);
        EXPECT_NEAR(scene.state(torso).linear_velocity.x, 0.5 * 100 / 80, 0.01);
        std::vector<ShapeContact> contacts = scene.shape_contacts();
        ASSERT_EQ(contacts.size(), 2U);
        for (const ShapeContact& contact : contacts) {
            const float ahead = contact.arm_b.x > 0 ? 1.0F : -1.0F;
            EXPECT_NEAR(contact.normal_force, 50 - ahead * 0.5F * 100 * radius / 0.4F, 2);
            EXPECT_NEAR(contact.friction_force.x, 0.5F * contact.normal_force, 0.5);
        }
        run(solver, scene, 120);
        EXPECT_NEAR(scene.state(torso).linear_velocity.x, 1, 1e-3);
        // Which of two points that stick bears how much of the friction is open; together they bear none.
        float friction = 0;
        for (const ShapeContact& contact : scene.shape_contacts()) friction += contact.friction_force.x;
        EXPECT_NEAR(friction, 0, 0.5);
        EXPECT_NEAR(scene.state(torso).yaw, 0, 1e-3);
    }
}

/// A solid ball pressed on a belt of speed u slides until it rolls, after t = 2 u m / (7 mu N): then v = 2 u / 7 and
/// w r = 5 u / 7. The belt is slanted, so that it runs along both tangents of the contact.
TEST_P(SurfacesOfWalls, ABeltMakesABallRoll)
{
    for (const float u : {2.0F, -2.0F}) {
        Scene scene;
        const Vec2<double> along{0.8, 0.6}, out{-0.6, 0.8};
        const Vec2<double> ends[] = {-10.0 * along, 10.0 * along};
        scene.add_wall({.points = ends, .friction = 0.5F, .surface_speed = u});
        const float moment = 0.4F * 3 * 0.2F * 0.2F;
        const BodyId ball = scene.add_body({.position = {0.2 * out.x, 0.2 * out.y, 1},
                                            .mass = 3,
                                            .inertia = {moment, 0, 0, moment, 0, moment}});
        scene.add_capsule({.body = ball, .radius = 0.2F, .friction = 0.5F});
        scene.set_force(ball, {-30 * static_cast<float>(out.x), -30 * static_cast<float>(out.y), 0}, {});
        Solver solver({.method = GetParam()});
        const auto speed = [&] {
            const Vec3<float> v = scene.state(ball).linear_velocity;
            EXPECT_NEAR(v.z, 0, 1e-5);
            return static_cast<float>(along.x) * v.x + static_cast<float>(along.y) * v.y;
        };
        run(solver, scene, 3);
        EXPECT_NEAR(speed(), std::copysign(0.5 * 30 / 3 * 3 / 60, u), 0.01) << "it slides for 0.11 s";
        run(solver, scene, 60);
        EXPECT_NEAR(speed(), 2 * u / 7, 0.01);
        EXPECT_NEAR(scene.state(ball).angular_velocity.z * 0.2F, 5 * u / 7, 0.02);
    }
}

/// A torso lies along a wall at two points, which together push with no more than the wall's force.
TEST_P(SurfacesOfWalls, PushATorsoWithNoMoreThanTheirForce)
{
    Scene scene;
    const Vec2<double> ends[] = {{-5, 0}, {5, 0}};
    scene.add_wall({.points = ends, .max_force = 300});
    const BodyId torso = add_torso(scene, {0, static_cast<double>(radius)});
    const auto pushed = [&] {
        float force = 0;
        for (const ShapeContact& contact : scene.shape_contacts()) force += contact.normal_force;
        return force;
    };
    Solver solver({.method = GetParam()});
    scene.set_force(torso, {0, -200, 0}, {});
    run(solver, scene, 120);
    EXPECT_NEAR(scene.state(torso).position.y, 0.12, 0.002);
    ASSERT_EQ(scene.shape_contacts().size(), 2U);
    EXPECT_NEAR(pushed(), 200, 1);
    scene.set_force(torso, {0, -400, 0}, {});
    const float before = scene.state(torso).linear_velocity.y;
    for (int step = 0; step < 12; ++step) {
        run(solver, scene, 1);
        EXPECT_NEAR(pushed(), 300, 0.3);
    }
    EXPECT_NEAR(scene.state(torso).linear_velocity.y - before, -0.2 * (400 - 300) / 80, 0.002);
    run(solver, scene, 120);
    EXPECT_LT(scene.state(torso).position.y, -1) << "who pushes harder passes";
}

/// Nor does a blow get more out of it, with a ball that would bounce.
TEST_P(SurfacesOfWalls, ABlowIsAnsweredWithNoMoreThanTheirForce)
{
    Scene scene;
    const Vec2<double> ends[] = {{0, -5}, {0, 5}};
    scene.add_wall({.points = ends, .max_force = 500});
    BodyDefinition thrown{.position = {-1, 0, 0}, .mass = 2};
    thrown.linear_velocity = {7, 0, 0};
    const BodyId ball = scene.add_body(thrown);
    scene.add_capsule({.body = ball, .radius = 0.2F, .restitution = 0.8F});
    Solver solver({.method = GetParam()});
    float fastest_change = 0;
    for (int step = 0; step < 60; ++step) {
        const float before = scene.state(ball).linear_velocity.x;
        run(solver, scene, 1);
        fastest_change = std::max(fastest_change, std::abs(scene.state(ball).linear_velocity.x - before));
    }
    EXPECT_NEAR(fastest_change, 500.0F / 2 * dt, 1e-3F) << "the wall did all that it can";
}

std::string name_of(const ::testing::TestParamInfo<Method>& method)
{
    constexpr const char* names[] = {"soft_step", "sequential_impulse", "direct"};
    return names[static_cast<int>(method.param)];
}
INSTANTIATE_TEST_SUITE_P(Methods, SurfacesOfWalls,
                         ::testing::Values(Method::soft_step, Method::sequential_impulse, Method::direct),
                         name_of);

/// The crowd of figures, torsos, discs and particles with a turnstile, a belt and a wall that gives way: bits are those of
/// every instruction set, method and number of threads.
TEST(ShapeWalls, HaveTheSameBitsInEveryLaneAndThread)
{
    for (const Method method : {Method::soft_step, Method::sequential_impulse}) {
        std::uint64_t expected = 0;
        for (const Isa isa : available_isas()) {
            for (const int threads : {1, 3}) {
                testing::ShapeCrowd crowd;
                const Vec2<double> turnstile[] = {{4, 0.5}, {4.2, 4}, {4, 7.5}}, belt[] = {{2, 1}, {2.5, 7}},
                                   barrier[] = {{6, 1}, {5.5, 7}};
                crowd.scene.add_wall({.points = turnstile, .friction = 0.2F, .one_way = true});
                crowd.scene.add_wall({.points = belt, .friction = 0.6F, .surface_speed = 1.5F});
                crowd.scene.add_wall({.points = barrier, .max_force = 40});
                Solver solver({.method = method, .gravity = {0, 0, -9.81F}},
                              {.threads = threads, .alone_below = 0, .isa = isa});
                run(solver, crowd.scene, testing::long_run(100));
                if (expected == 0) expected = crowd.scene.state_hash();
                EXPECT_EQ(crowd.scene.state_hash(), expected)
                    << isa_name(isa) << ", " << threads << " threads";
            }
        }
    }
}

}  // namespace
}  // namespace motley
