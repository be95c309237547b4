// The steering models of the program's hosts. Independent evidence: closed forms, and brute force over velocities.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "worlds/crowd.h"
#include "worlds/neighbours.h"
#include "worlds/random.h"
#include "worlds/steering/half_planes.h"
#include "worlds/steering/orca.h"
#include "worlds/steering/social_force.h"

namespace motley::bench {
namespace {

constexpr float dt = 1.0F / 60;

Agent walker(Vec2<double> goal)
{
    Agent agent;
    agent.goal = goal;
    return agent;
}

TEST(Neighbours, AreThoseOfBruteForceAcrossTheSeam)
{
    Scene scene;
    Crowd crowd;
    Random random(7);
    crowd.period_y = 12;
    for (int i = 0; i < 200; ++i) crowd.add(scene, {}, {8 * random.uniform(), 12 * random.uniform()});
    Solver solver(SolverSettings{});
    crowd.observe(scene, solver.executor());
    Neighbours neighbours;
    neighbours.find(crowd, 0.5F, solver.executor());
    for (std::size_t i = 0; i < 200; ++i) {
        std::vector<std::int32_t> expected, found(neighbours.of(i).begin(), neighbours.of(i).end());
        for (std::size_t j = 0; j < 200; ++j) {
            double y = std::abs(crowd.positions[i].y - crowd.positions[j].y);
            y = std::min(y, 12 - y);
            if (i != j && std::hypot(crowd.positions[i].x - crowd.positions[j].x, y) < 0.9)
                expected.push_back(static_cast<std::int32_t>(j));
        }
        std::sort(found.begin(), found.end());
        EXPECT_EQ(found, expected) << "person " << i;
    }
}

TEST(SocialForce, IsTheFormulaOfThePaper)
{
    Scene scene;
    Crowd crowd;
    crowd.add(scene, walker({10, 0}), {0, 0});
    crowd.add(scene, walker({0.5, 0}), {0.5, 0});
    crowd.walls.push_back({{-5, -0.3}, {5, -0.3}});
    Solver solver(SolverSettings{});
    crowd.observe(scene, solver.executor());
    std::vector<Vec3<float>> forces(2);
    SocialForce().find_forces(crowd, forces, solver.executor());
    // Both gaps are 0.1 m.
    const double repulsion = 2000 * std::exp(-0.1 / 0.08);
    EXPECT_NEAR(forces[0].x, 80 * 1.34 / 0.5 - repulsion, 0.01);
    EXPECT_NEAR(forces[0].y, repulsion, 0.01);
    EXPECT_NEAR(forces[1].x, repulsion, 0.01);
}

TEST(HalfPlanes, AllowTheVelocityThatBruteForceFinds)
{
    Random random(3);
    for (int trial = 0; trial < 100; ++trial) {
        std::vector<HalfPlane> planes;
        for (int i = 0; i < 4; ++i) {
            const double angle = 6.283185 * random.uniform();
            const Vec2<float> normal{static_cast<float>(std::cos(angle)),
                                     static_cast<float>(std::sin(angle))};
            planes.push_back({static_cast<float>(random.symmetric()) * normal, normal});
        }
        const Vec2<float> wish{static_cast<float>(random.symmetric()),
                               static_cast<float>(random.symmetric())};
        // How far a velocity is from what the planes allow, and from the wish, on a grid of 5 mm/s.
        const auto beyond = [&](Vec2<float> v) {
            float most = 0;
            for (const HalfPlane& plane : planes) most = std::max(most, dot(plane.normal, plane.point - v));
            return most;
        };
        float least_beyond = 1e9F, least_off = 1e9F;
        for (int x = -200; x <= 200; ++x) {
            for (int y = -200; y <= 200; ++y) {
                const Vec2<float> v{0.005F * static_cast<float>(x), 0.005F * static_cast<float>(y)};
                if (dot(v, v) > 1) continue;
                least_beyond = std::min(least_beyond, beyond(v));
                const Vec2<float> off = v - wish;
                if (beyond(v) <= 0) least_off = std::min(least_off, std::sqrt(dot(off, off)));
            }
        }
        const Vec2<float> velocity = nearest_allowed(planes, 0, 1, wish);
        EXPECT_LE(dot(velocity, velocity), 1.0001F);
        // The grid is at most 3.6 mm/s off. Where it has no allowed velocity there is no wish to compare.
        EXPECT_NEAR(beyond(velocity), least_beyond, 0.005) << trial;
        const Vec2<float> off = velocity - wish;
        // The grid's best may be farther from the wish than the true one, never nearer.
        if (least_beyond <= 0) {
            EXPECT_LE(std::sqrt(dot(off, off)), least_off + 1e-4F) << trial;
        }
    }
}

TEST(HalfPlanes, ThatAreHardHoldWhenNotAllCan)
{
    const HalfPlane planes[] = {{{0, 0.5F}, {0, 1}}, {{0, -0.5F}, {0, -1}}};
    // The first wants y >= 0.5, the second y <= -0.5. Neither is hard: they meet halfway; the first is: it holds.
    EXPECT_NEAR(nearest_allowed(planes, 0, 1, {}).y, 0, 1e-3);
    EXPECT_NEAR(nearest_allowed(planes, 1, 1, {}).y, 0.5, 1e-3);
}

/// Whether two people collide within the horizon if their relative velocity stays: by the least distance on the way.
bool collide(Vec2<double> offset, double radii, Vec2<double> relative)
{
    const double speed2 = dot(relative, relative);
    const double time = std::clamp(speed2 > 0 ? dot(relative, offset) / speed2 : 0.0, 0.0,
                                   static_cast<double>(Orca::horizon));
    const Vec2<double> left = offset - time * relative;
    return dot(left, left) < radii * radii;
}

TEST(Orca, TheWayOutOfAnObstacleIsTheShortest)
{
    Random random(5);
    for (int trial = 0; trial < 300; ++trial) {
        const Vec2<double> offset{2 * random.symmetric(), 2 * random.symmetric()};
        const double radii = 0.4;
        if (dot(offset, offset) < 0.2) continue;
        const Vec2<double> relative{2 * random.symmetric(), 2 * random.symmetric()};
        const auto narrow = [](Vec2<double> v) {
            return Vec2<float>{static_cast<float>(v.x), static_cast<float>(v.y)};
        };
        const HalfPlane out = way_out(narrow(offset), static_cast<float>(radii), narrow(relative));
        const Vec2<double> point{static_cast<double>(out.point.x), static_cast<double>(out.point.y)};
        const Vec2<double> normal{static_cast<double>(out.normal.x), static_cast<double>(out.normal.y)};
        EXPECT_TRUE(collide(offset, radii, point - 1e-4 * normal)) << trial;
        EXPECT_FALSE(collide(offset, radii, point + 1e-4 * normal)) << trial;
        // Nothing nearer is on the other side of the border.
        const Vec2<double> change = point - relative;
        const double near = 0.999 * std::sqrt(dot(change, change));
        for (int k = 0; k < 64; ++k) {
            const double angle = 6.283185307 * k / 64;
            const Vec2<double> other = relative + near * Vec2<double>{std::cos(angle), std::sin(angle)};
            EXPECT_EQ(collide(offset, radii, other), collide(offset, radii, relative)) << trial;
        }
    }
}

struct Meeting {
    double touched = 0;   ///< N s, of all contacts
    double farthest = 0;  ///< m, of the least distances to the goals
};

/// Two walk at each other, and two cross their way.
Meeting meet(SteeringModel model)
{
    Scene scene;
    Crowd crowd;
    crowd.steering = make_steering(model);
    const Vec2<double> starts[] = {{-4, 0.05}, {4, -0.05}, {0.3, -5}, {-0.3, 5}};
    for (const Vec2<double>& at : starts) crowd.add(scene, walker({-at.x, -at.y}), at);
    crowd.hand_over(scene);
    Solver solver(SolverSettings{});
    Meeting meeting;
    double nearest[] = {10, 10, 10, 10};  // m, to the goal
    for (int step = 0; step < 60 * 10; ++step) {
        crowd.observe(scene, solver.executor());
        crowd.steer(scene, solver.executor());
        EXPECT_EQ(solver.step(scene, dt).status, StepStatus::done);
        for (const Touch& touch : crowd.touches(scene))
            meeting.touched += touch.force * static_cast<double>(dt);
        for (std::size_t i = 0; i < 4; ++i)
            nearest[i] = std::min(nearest[i], std::hypot(crowd.positions[i].x - crowd.agents[i].goal.x,
                                                         crowd.positions[i].y - crowd.agents[i].goal.y));
    }
    for (const double distance : nearest) meeting.farthest = std::max(meeting.farthest, distance);
    return meeting;
}

TEST(Orca, PeopleWhoMeetGiveWay)
{
    const Meeting orca = meet(SteeringModel::orca), plain = meet(SteeringModel::plain);
    EXPECT_LT(orca.farthest, 0.2) << "all arrive";
    // They pass with no room between them and take up a velocity in 0.1 s, so that they may brush each other. Bound: a
    // hundredth of the momentum of one of them.
    EXPECT_LT(orca.touched, 0.01 * 80 * 1.34);
    EXPECT_GT(plain.touched, 80 * 1.34) << "without giving way they run into each other";
}

}  // namespace
}  // namespace motley::bench
