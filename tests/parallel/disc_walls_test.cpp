// Walls: nobody changes sides, doors push, and what is refused. Independent evidence: the sides of points, and closed
// forms.
#include <gtest/gtest.h>

#include <cmath>

#include "disc_crowd.h"
#include "rig.h"

namespace motley {
namespace {

using testing::DiscCrowd;
using testing::person_at;
using testing::Random;

constexpr float dt = 1.0F / 60;

/// People thrown about in a box with a wall across its middle, at up to 20 m/s.
TEST(DiscWalls, NobodyChangesSides)
{
    DiscCrowd crowd({.people = 400, .speed = 20, .spacing = 0.6});
    const double middle = crowd.side / 2;
    const Vec2<double> across[] = {
        {middle + 0.3, -1}, {middle - 0.2, middle}, {middle + 0.3, crowd.side + 1}};
    crowd.scene.add_wall({.points = across});
    const auto side_of = [&](const Vec3<double>& p) {
        const double wall = middle + 0.3 - 0.5 * (1 - std::abs(p.y - middle) / (middle + 1));
        return p.x < wall;
    };
    std::vector<bool> side;
    std::vector<Vec3<double>> at(crowd.people.size());
    crowd.scene.read_positions(crowd.people, std::span(at));
    // Those who stand on the wall at the start are pushed to the side of their centre.
    for (const Vec3<double>& p : at) side.push_back(side_of(p));
    Random random;
    Solver solver(SolverSettings{}, {.threads = 2, .alone_below = 0});
    for (int step = 0; step < testing::long_run(3000); ++step) {
        for (int k = 0; k < 20; ++k) {
            const auto who = static_cast<std::size_t>(random.below(static_cast<int>(crowd.people.size())));
            crowd.scene.set_velocity(
                crowd.people[who],
                {20 * static_cast<float>(random.symmetric()), 20 * static_cast<float>(random.symmetric()), 0},
                {});
        }
        ASSERT_EQ(solver.step(crowd.scene, dt).status, StepStatus::done);
        crowd.scene.read_positions(crowd.people, std::span(at));
        for (std::size_t i = 0; i < at.size(); ++i) {
            ASSERT_EQ(side_of(at[i]), side[i]) << "person " << i << " in step " << step;
            ASSERT_TRUE(at[i].x > 0 && at[i].x < crowd.side && at[i].y > 0 && at[i].y < crowd.side)
                << "person " << i << " in step " << step;
        }
    }
}

/// A disc whose centre is drawn beyond a wall is brought back to its side when it is let go.
TEST(DiscWalls, RememberTheSideOfACentreDrawnBeyond)
{
    Scene scene;
    const Vec2<double> ends[] = {{0, -5}, {0, 5}};
    scene.add_wall({.points = ends});
    const BodyId person = scene.add_body(person_at(0.2, 0));
    scene.set_disc(person, {.radius = 0.2F});
    Solver solver(SolverSettings{});
    ASSERT_EQ(solver.step(scene, dt).status, StepStatus::done);
    const ConstraintId rope =
        scene.add_joint(BallSocketDefinition{scene.ground(), person, {-0.5F, 0, 0}, {}});
    for (int step = 0; step < 60; ++step) ASSERT_EQ(solver.step(scene, dt).status, StepStatus::done);
    ASSERT_LT(scene.state(person).position.x, -0.01) << "the joint was to draw the centre beyond the wall";
    scene.remove_joint(rope);
    for (int step = 0; step < 120; ++step) ASSERT_EQ(solver.step(scene, dt).status, StepStatus::done);
    EXPECT_GT(scene.state(person).position.x, 0.198);
}

TEST(DiscWalls, OnAKinematicBodyPushAndCarry)
{
    Scene scene;
    BodyDefinition paddle;
    paddle.motion = BodyMotion::kinematic_body;
    paddle.position = {-1, 0, 0};
    paddle.linear_velocity = {0.5F, 0, 0};
    const BodyId door = scene.add_body(paddle);
    const Vec2<double> ends[] = {{0, -1}, {0, 1}};
    scene.add_wall({.points = ends, .body = door});
    const BodyId person = scene.add_body(person_at(0, 0.1));
    scene.set_disc(person, {.radius = 0.2F});
    Solver solver(SolverSettings{});
    for (int step = 0; step < 240; ++step) ASSERT_EQ(solver.step(scene, dt).status, StepStatus::done);
    EXPECT_NEAR(scene.state(door).position.x, 1, 1e-5);
    EXPECT_NEAR(scene.state(person).position.x, 1.2, 0.002);
    EXPECT_NEAR(scene.state(person).linear_velocity.x, 0.5, 0.001);
    // A door that turns: its edge at 1 m from the hinge moves people at the speed of the point that touches them.
    scene.set_velocity(door, {}, {0, 0, 0.5F});
    scene.set_pose(person, {1.2, 0.8, 0}, {0, 0, 0, 1}, 0);
    scene.set_velocity(person, {}, {});
    for (int step = 0; step < 30; ++step) ASSERT_EQ(solver.step(scene, dt).status, StepStatus::done);
    EXPECT_LT(scene.state(person).position.x, 1.2 + 1e-6);
    scene.set_velocity(door, {}, {0, 0, -0.5F});
    for (int step = 0; step < 60; ++step) ASSERT_EQ(solver.step(scene, dt).status, StepStatus::done);
    EXPECT_GT(scene.state(person).position.x, 1.3);
}

TEST(DiscWalls, ThatAreRemovedLetPeoplePass)
{
    Scene scene;
    const Vec2<double> near_ends[] = {{1, -1}, {1, 1}}, far_ends[] = {{2, -1}, {2, 1}};
    const WallId near_wall = scene.add_wall({.points = near_ends}),
                 far_wall = scene.add_wall({.points = far_ends});
    const BodyId person = scene.add_body(person_at(0, 0));
    scene.set_disc(person, {.radius = 0.2F});
    scene.set_force(person, {50, 0, 0}, {});
    Solver solver(SolverSettings{});
    for (int step = 0; step < 300; ++step) ASSERT_EQ(solver.step(scene, dt).status, StepStatus::done);
    EXPECT_NEAR(scene.state(person).position.x, 0.8, 0.002);
    scene.remove_wall(near_wall);
    EXPECT_FALSE(scene.is_alive(near_wall));
    EXPECT_TRUE(scene.is_alive(far_wall));
    for (int step = 0; step < 300; ++step) ASSERT_EQ(solver.step(scene, dt).status, StepStatus::done);
    EXPECT_NEAR(scene.state(person).position.x, 1.8, 0.002);
    ASSERT_EQ(scene.disc_contacts().size(), std::size_t{1});
    EXPECT_EQ(scene.disc_contacts()[0].wall, far_wall);
    EXPECT_NEAR(scene.disc_contacts()[0].normal_force, 50, 0.5);
    scene.clear_disc(person);
    EXPECT_FALSE(scene.has_disc(person));
    for (int step = 0; step < 300; ++step) ASSERT_EQ(solver.step(scene, dt).status, StepStatus::done);
    EXPECT_GT(scene.state(person).position.x, 3);
}

/// Evidence: the path is prescribed, and clear of the wall.
TEST(DiscWalls, LetPeopleWalkAroundTheirEnds)
{
    Scene scene;
    const Vec2<double> ends[] = {{0, 0}, {0, 5}};
    scene.add_wall({.points = ends});
    const BodyId person = scene.add_body(person_at(0.25, 1));
    scene.set_disc(person, {.radius = 0.2F});
    Solver solver(SolverSettings{});
    Vec2<double> at{0.25, 1};
    for (const Vec2<double>& goal : {Vec2<double>{0.25, -0.25}, {-0.25, -0.25}, {-0.25, 1}}) {
        const Vec2<double> way = goal - at;
        for (int step = 0; step < 60; ++step) {
            scene.set_velocity(person, {static_cast<float>(way.x), static_cast<float>(way.y), 0}, {});
            ASSERT_EQ(solver.step(scene, dt).status, StepStatus::done);
            at = at + static_cast<double>(dt) * way;
            ASSERT_NEAR(scene.state(person).position.x, at.x, 1e-5) << "on the way to " << goal.y;
            ASSERT_NEAR(scene.state(person).position.y, at.y, 1e-5);
        }
    }
    scene.set_velocity(person, {}, {});
    scene.set_force(person, {50, 0, 0}, {});
    for (int step = 0; step < 120; ++step) ASSERT_EQ(solver.step(scene, dt).status, StepStatus::done);
    EXPECT_NEAR(scene.state(person).position.x, -0.2, 0.002) << "held on the side on which it is now";
}

/// A turnstile. Evidence: nobody pushes who passes it, so the motion is that of a free body.
TEST(DiscWalls, OneWayLetPassFromTheRight)
{
    Scene scene;
    const Vec2<double> ends[] = {{0, -5}, {0, 5}};  // the left side is that of negative x
    scene.add_wall({.points = ends, .one_way = true});
    const BodyId person = scene.add_body(person_at(1, 0)), free = scene.add_body(person_at(1, 0));
    scene.set_disc(person, {.radius = 0.2F});
    Solver solver(SolverSettings{});
    const auto go = [&](float force, int steps) {
        for (const BodyId body : {person, free}) scene.set_force(body, {force, 0, 0}, {});
        for (int step = 0; step < steps; ++step) {
            ASSERT_EQ(solver.step(scene, dt).status, StepStatus::done);
        }
    };
    go(-50, 60);
    ASSERT_NEAR(scene.state(person).position.x, 1 - 0.5 * 50 / 80, 0.01) << "beside the wall";
    go(50, 30);
    go(-50, 90);  // back and through
    EXPECT_LT(scene.state(person).position.x, -0.5);
    EXPECT_NEAR(scene.state(person).position.x, scene.state(free).position.x, 1e-6);
    EXPECT_NEAR(scene.state(person).linear_velocity.x, scene.state(free).linear_velocity.x, 1e-6);
    go(50, 400);
    EXPECT_NEAR(scene.state(person).position.x, -0.2, 0.002) << "no way back";
    EXPECT_GT(scene.state(free).position.x, 1);
}

/// A disc pressed on a belt slides until it rolls: v = u / 3 and w r = 2 u / 3 of the belt's speed u, as of a solid disc,
/// after t = u m / (3 mu N).
TEST(DiscWalls, WithASurfaceThatMovesTakePeopleAlong)
{
    for (int k = 0; k < 4; ++k) {
        const double side = k % 2 == 0 ? 1 : -1;
        Scene scene;
        const Vec2<double> ends[] = {{-10, 0}, {10, 0}};
        scene.add_wall({.points = ends, .friction = 0.5F, .surface_speed = 1});
        const BodyId person = scene.add_body(person_at(0, 0.2 * side));
        scene.set_disc(person, {.radius = 0.2F, .friction = 0.5F});
        scene.set_force(person, {0, static_cast<float>(-100 * side), 0}, {});
        Solver solver({.method = k < 2 ? Method::soft_step : Method::direct});
        for (int step = 0; step < 24; ++step) ASSERT_EQ(solver.step(scene, dt).status, StepStatus::done);
        EXPECT_NEAR(scene.state(person).linear_velocity.x, 0.4 * 0.5 * 100 / 80, 0.003);
        for (int step = 0; step < 60; ++step) ASSERT_EQ(solver.step(scene, dt).status, StepStatus::done);
        EXPECT_NEAR(scene.state(person).linear_velocity.x, 1.0 / 3, 0.002);
        EXPECT_NEAR(scene.state(person).angular_velocity.z * 0.2, 2.0 / 3 * side, 0.004);
    }
}

void expect_bounded_push(const SolverSettings& settings)
{
    Scene scene;
    const Vec2<double> ends[] = {{0, -5}, {0, 5}};
    scene.add_wall({.points = ends, .max_force = 300});
    const BodyId person = scene.add_body(person_at(0.2, 0));
    scene.set_disc(person, {.radius = 0.2F});
    scene.set_force(person, {-200, 0, 0}, {});
    Solver solver(settings);
    for (int step = 0; step < 120; ++step) ASSERT_EQ(solver.step(scene, dt).status, StepStatus::done);
    EXPECT_NEAR(scene.state(person).position.x, 0.2, 0.002);
    ASSERT_EQ(scene.disc_contacts().size(), std::size_t{1});
    EXPECT_NEAR(scene.disc_contacts()[0].normal_force, 200, 1);
    scene.set_force(person, {-400, 0, 0}, {});
    const float before = scene.state(person).linear_velocity.x;
    for (int step = 0; step < 12; ++step) {
        ASSERT_EQ(solver.step(scene, dt).status, StepStatus::done);
        ASSERT_EQ(scene.disc_contacts().size(), std::size_t{1});
        EXPECT_NEAR(scene.disc_contacts()[0].normal_force, 300, 0.3);
    }
    EXPECT_NEAR(scene.state(person).linear_velocity.x - before, -0.2 * (400 - 300) / 80, 0.002);
    for (int step = 0; step < 120; ++step) ASSERT_EQ(solver.step(scene, dt).status, StepStatus::done);
    EXPECT_LT(scene.state(person).position.x, -1) << "who pushes harder passes";
}

TEST(DiscWalls, PushWithNoMoreThanTheirForce)
{
    for (const Method method : {Method::soft_step, Method::sequential_impulse, Method::direct}) {
        for (const DriftCorrection drift : {DriftCorrection::baumgarte, DriftCorrection::projection})
            expect_bounded_push({.method = method, .drift_correction = drift});
    }
}

TEST(DiscWalls, RefuseWhatIsNoDiscOrWall)
{
    Scene scene;
    const BodyId ball = scene.add_body({});
    const BodyId person = scene.add_body(person_at(0, 0));
    const auto message_of = [](const auto& call) -> std::string {
        try {
            call();
        } catch (const InvalidInput& refused) {
            return refused.what();
        }
        return "accepted";
    };
    EXPECT_EQ(message_of([&] { scene.set_disc(person, {.radius = 0}); }),
              "DiscDefinition.radius is 0; expected 1e-6 to 1e6 (m)");
    EXPECT_EQ(message_of([&] { scene.set_disc(person, {.friction = NAN}); }),
              "DiscDefinition.friction is nan; expected 0 to 1e9");
    EXPECT_EQ(message_of([&] { scene.set_disc(ball, {}); }),
              "set_discs.bodies is a body that is not planar and dynamic; expected planar, dynamic bodies");
    EXPECT_EQ(message_of([&] { scene.clear_disc(person); }),
              "clear_disc.body is a body without a disc; expected a body with a disc");
    const Vec2<double> one[] = {{0, 0}};
    EXPECT_EQ(message_of([&] { scene.add_wall({.points = one}); }),
              "WallDefinition.points.size() is 1; expected 2 or more");
    const Vec2<double> two[] = {{0, 0}, {1, 0}}, twice[] = {{0, 0}, {1, 0}, {1, 0}};
    EXPECT_EQ(message_of([&] { scene.add_wall({.points = two, .closed = true}); }),
              "WallDefinition.points.size() is 2; expected 3 or more of a closed wall");
    EXPECT_EQ(message_of([&] { scene.add_wall({.points = twice}); }),
              "WallDefinition.points[1] is at the next point; expected neighbours at least 1e-6 m apart");
    EXPECT_EQ(message_of([&] { scene.add_wall({.points = two, .surface_speed = 1}); }),
              "WallDefinition.surface_speed is 1; expected 0 for a wall without friction");
    EXPECT_EQ(message_of([&] { scene.add_wall({.points = two, .friction = 1, .surface_speed = NAN}); }),
              "WallDefinition.surface_speed is nan; expected -1e6 to 1e6 (m/s)");
    for (const float force : {0.0F, -1.0F, NAN})
        EXPECT_NE(message_of([&] { scene.add_wall({.points = two, .max_force = force}); }), "accepted");
    EXPECT_EQ(message_of([&] { scene.add_wall({.points = two, .body = ball}); }),
              "WallDefinition.body is a dynamic body; expected a static or kinematic body");
    EXPECT_EQ(message_of([&] {
                  scene.remove_wall({3, 1});
              }),
              "remove_wall.wall is slot 3, not alive; expected a wall of this scene");
}

}  // namespace
}  // namespace motley
