// Crowds that nobody would draw: a million people on one spot, and people thrown about among random walls and doors.
// Independent evidence: where people are, before and after each step.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>

#include "disc_crowd.h"
#include "rig.h"

namespace motley {
namespace {

using testing::person_at;
using testing::Random;

constexpr float dt = 1.0F / 60;

/// s, of a step of a million people who are all in each other's way: far more than it needs, and far less than looking at
/// every pair would take.
constexpr double longest_step = 120;

double seconds_since(std::chrono::steady_clock::time_point began)
{
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
}

std::vector<BodyId> people_on_one_spot(Scene& scene, int count)
{
    const std::vector<BodyDefinition> bodies(static_cast<std::size_t>(count), person_at(3, 4));
    std::vector<BodyId> people(bodies.size());
    scene.add_bodies(bodies, people);
    return people;
}
/// Across the shoulders, along y.
CapsuleDefinition torso_of(BodyId body)
{
    return {.body = body, .from = {0, -0.11F, 0}, .to = {0, 0.11F, 0}, .radius = 0.12F};
}

struct Extent {
    Vec2<double> low{1e300, 1e300}, high{-1e300, -1e300};
    bool is_finite = true;
};
Extent extent_of(const Scene& scene, std::span<const BodyId> people)
{
    std::vector<Vec3<double>> at(people.size());
    scene.read_positions(people, std::span(at));
    Extent extent;
    for (const Vec3<double>& p : at) {
        extent.is_finite = extent.is_finite && std::isfinite(p.x + p.y + p.z);
        extent.low = {std::min(extent.low.x, p.x), std::min(extent.low.y, p.y)};
        extent.high = {std::max(extent.high.x, p.x), std::max(extent.high.y, p.y)};
    }
    return extent;
}

/// The contacts of so many would not fit into memory: the step is refused, says how many they are, and changes nothing.
/// The crowd goes on once it has room.
TEST(CrowdExtremes, AMillionPeopleOnOneSpotAreRefusedByTheirPairs)
{
    if (testing::long_run(10) < 10) GTEST_SKIP() << "a smaller crowd accesses the same memory";
    constexpr int count = 1'000'000;
    Scene scene;
    const std::vector<BodyId> people = people_on_one_spot(scene, count);
    scene.set_discs(people, std::vector<DiscDefinition>(people.size()));
    Solver solver(SolverSettings{}, {.threads = 2});
    const std::uint64_t hash = scene.state_hash();
    for (int attempt = 0; attempt < 2; ++attempt) {
        const auto began = std::chrono::steady_clock::now();
        const StepReport report = solver.step(scene, dt);
        EXPECT_LT(seconds_since(began), longest_step);
        EXPECT_EQ(report.status, StepStatus::refused);
        EXPECT_EQ(
            report.error,
            "pairs of 1000000 discs that may touch is more than 26097152; expected fewer: discs that are "
            "not all in one place");
        EXPECT_EQ(scene.state_hash(), hash);
    }
    for (std::size_t i = 0; i < people.size(); ++i)
        scene.set_pose(people[i],
                       {0.5 * static_cast<double>(i % 1000), 0.5 * static_cast<double>(i / 1000), 0},
                       {0, 0, 0, 1}, 0);
    const StepReport report = solver.step(scene, dt);
    EXPECT_EQ(report.status, StepStatus::done) << report.error;
    EXPECT_EQ(scene.body_count(), static_cast<std::size_t>(count));
}

/// Each disc pushes at most 64 of those behind it in the order of places, so some thousands part, along x, since discs on
/// one spot have no direction between them. None is lost.
TEST(CrowdExtremes, ThousandsOnOneSpotPart)
{
    constexpr int count = testing::long_run(5000);
    Scene scene;
    const std::vector<BodyId> people = people_on_one_spot(scene, count);
    scene.set_discs(people, std::vector<DiscDefinition>(people.size()));
    Solver solver(SolverSettings{}, {.threads = 2});
    for (int step = 0; step < 60; ++step) {
        const auto began = std::chrono::steady_clock::now();
        const StepReport report = solver.step(scene, dt);
        ASSERT_EQ(report.status, StepStatus::done) << report.error;
        ASSERT_LT(seconds_since(began), longest_step);
        EXPECT_EQ(report.bodies_contained, 0);
    }
    const Extent extent = extent_of(scene, people);
    EXPECT_TRUE(extent.is_finite);
    EXPECT_GT(extent.high.x - extent.low.x, 10) << "they part";
    // Neighbours in the row part at no more than push_out_speed, so its ends may be as fast as all of them together.
    EXPECT_LT(extent.high.x - extent.low.x, count * static_cast<double>(SolverSettings{}.push_out_speed));
    EXPECT_EQ(scene.body_count(), static_cast<std::size_t>(count));
}

/// The same with torsos, of which every pair is found: with fewer people.
TEST(CrowdExtremes, TorsosOnOneSpotAreRefusedByTheirPairs)
{
    if (testing::long_run(10) < 10) GTEST_SKIP() << "a smaller crowd accesses the same memory";
    constexpr int count = 100'000;
    Scene scene;
    const std::vector<BodyId> people = people_on_one_spot(scene, count);
    std::vector<CapsuleDefinition> capsules;
    for (const BodyId body : people) capsules.push_back(torso_of(body));
    std::vector<ShapeId> shapes(capsules.size());
    scene.add_capsules(capsules, shapes);
    Solver solver(SolverSettings{}, {.threads = 2});
    const std::uint64_t hash = scene.state_hash();
    const auto began = std::chrono::steady_clock::now();
    const StepReport report = solver.step(scene, dt);
    EXPECT_LT(seconds_since(began), longest_step);
    EXPECT_EQ(report.status, StepStatus::refused);
    EXPECT_EQ(report.error,
              "pairs of 100000 capsules that may touch is more than 5794304; expected fewer: "
              "capsules that are not all in one place");
    EXPECT_EQ(scene.state_hash(), hash);
    for (std::size_t i = 0; i < people.size(); ++i)
        scene.set_pose(people[i], {0.7 * static_cast<double>(i % 300), 0.7 * static_cast<double>(i / 300), 0},
                       {0, 0, 0, 1}, 0);
    EXPECT_EQ(solver.step(scene, dt).status, StepStatus::done);
}

/// Hundreds of torsos on one spot are a heap as any other: they part, and the same for every number of threads.
TEST(CrowdExtremes, HundredsOfTorsosOnOneSpotPart)
{
    std::uint64_t hash = 0;
    for (const int threads : {1, 2}) {
        Scene scene;
        std::vector<BodyId> people;
        for (int i = 0; i < testing::long_run(500); ++i) {
            people.push_back(scene.add_body(person_at(3, 4)));
            scene.add_capsule(torso_of(people.back()));
        }
        Solver solver(SolverSettings{}, {.threads = threads});
        for (int step = 0; step < 5; ++step) {
            const auto began = std::chrono::steady_clock::now();
            const StepReport report = solver.step(scene, dt);
            ASSERT_EQ(report.status, StepStatus::done) << report.error;
            ASSERT_LT(seconds_since(began), longest_step);
        }
        const Extent extent = extent_of(scene, people);
        EXPECT_TRUE(extent.is_finite);
        EXPECT_GT(extent.high.x - extent.low.x, 0.05);
        if (hash == 0) hash = scene.state_hash();
        EXPECT_EQ(scene.state_hash(), hash);
    }
}

/// Whether a step from p to q crosses the segment from `from` to `to`.
bool crosses(const Vec2<double>& p, const Vec2<double>& q, const Vec2<double>& from, const Vec2<double>& to)
{
    const auto left = [](const Vec2<double>& a, const Vec2<double>& b, const Vec2<double>& c) {
        return cross(b - a, c - a);
    };
    return left(from, to, p) * left(from, to, q) < 0 && left(p, q, from) * left(p, q, to) < 0;
}

/// A walled room of 24 x 12 m with random walls in its outer thirds, and in the middle a door across all of it that goes
/// to and fro at up to 20 m/s.
class WildRoom {
  public:
    static constexpr double length = 24, width = 12, swing = 2, fastest = 20;
    Scene scene;
    std::vector<BodyId> people;

    WildRoom(std::uint64_t seed, bool are_torsos)
    {
        for (std::uint64_t i = 0; i < seed; ++i) random_.symmetric();
        const Vec2<double> corners[] = {{0, 0}, {length, 0}, {length, width}, {0, width}};
        scene.add_wall({.points = corners, .closed = true});
        for (int i = 0; i < 14; ++i) {
            const Vec2<double> from{i % 2 == 0 ? between(0.5, 7.5) : between(16.5, 23.5), between(0.5, 11.5)};
            Vec2<double> to{from.x + between(-4, 4), from.y + between(-4, 4)};
            to.x = i % 2 == 0 ? std::clamp(to.x, 0.3, 8.5) : std::clamp(to.x, 15.5, 23.7);
            to.y = std::clamp(to.y, 0.3, 11.7);
            walls_.push_back({from, to});
            scene.add_wall({.points = walls_.back(), .friction = i % 3 == 0 ? 0.4F : 0.0F});
        }
        BodyDefinition frame;
        frame.motion = BodyMotion::kinematic_body;
        frame.position = {length / 2, 0, 0};
        door_ = scene.add_body(frame);
        const Vec2<double> ends[] = {{0, -1}, {0, width + 1}};
        scene.add_wall({.points = ends, .body = door_});
        for (double x = 0.5; x < length; x += 0.75) {
            for (double y = 0.5; y < width; y += 0.75) {
                if (is_clear({x, y})) add_person({x, y}, are_torsos);
            }
        }
        at_.resize(people.size());
        scene.read_positions(people, std::span(at_));
        for (const Vec3<double>& p : at_) is_left_.push_back(p.x < length / 2);
    }

    /// Throws one in twenty, and steps. Returns what somebody did who is now where nobody can be, or empty.
    std::string step(Solver& solver)
    {
        const double rate = fastest / swing, time = static_cast<double>(dt) * ++steps_;
        // The door's speed is such that it is where the sine is at the end of the step.
        const double to = length / 2 + swing * std::sin(rate * time);
        scene.set_velocity(
            door_, {static_cast<float>((to - scene.state(door_).position.x) / static_cast<double>(dt)), 0, 0},
            {});
        for (std::size_t k = 0; k < people.size() / 20; ++k) {
            const auto who = static_cast<std::size_t>(random_.below(static_cast<int>(people.size())));
            const auto x = static_cast<float>(between(-20, 20)), y = static_cast<float>(between(-20, 20)),
                       turns = static_cast<float>(between(-5, 5));
            scene.set_velocity(people[who], {x, y, 0}, {0, 0, turns});
        }
        const StepReport report = solver.step(scene, dt);
        if (report.status != StepStatus::done) return report.error;
        const std::vector<Vec3<double>> before = at_;
        scene.read_positions(people, std::span(at_));
        const double door = scene.state(door_).position.x;
        for (std::size_t i = 0; i < at_.size(); ++i) {
            const Vec3<double>& p = at_[i];
            const std::string who = "person " + std::to_string(i) + " in step " + std::to_string(steps_);
            if (!(p.x > 0 && p.x < length && p.y > 0 && p.y < width)) return who + " left the room";
            if ((p.x < door) != is_left_[i]) return who + " went through the door";
            for (const auto& wall : walls_) {
                if (crosses({before[i].x, before[i].y}, {p.x, p.y}, wall[0], wall[1]))
                    return who + " went through a wall";
            }
        }
        return {};
    }

  private:
    Random random_;
    BodyId door_;
    std::vector<std::array<Vec2<double>, 2>> walls_;
    std::vector<bool> is_left_;
    std::vector<Vec3<double>> at_;
    int steps_ = 0;

    double between(double low, double high) { return low + (high - low) * 0.5 * (random_.symmetric() + 1); }
    [[nodiscard]] bool is_clear(const Vec2<double>& p) const
    {
        if (std::abs(p.x - length / 2) < 0.4) return false;
        for (const auto& [from, to] : walls_) {
            const Vec2<double> along = to - from;
            const double t = std::clamp(dot(along, p - from) / dot(along, along), 0.0, 1.0);
            const Vec2<double> off = p - from - t * along;
            if (dot(off, off) < 0.36 * 0.36) return false;
        }
        return true;
    }
    void add_person(const Vec2<double>& at, bool is_torso)
    {
        people.push_back(scene.add_body(person_at(at.x, at.y)));
        if (!is_torso)
            return scene.set_disc(people.back(),
                                  {.radius = 0.2F, .friction = people.size() % 3 == 0 ? 0.3F : 0.0F});
        scene.add_capsule(torso_of(people.back()));
    }
};

/// More than a million steps of a person, in rooms that are all different.
TEST(CrowdExtremes, NobodyChangesSidesAmongRandomWallsAndDoors)
{
    std::int64_t person_steps = 0;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        WildRoom room(seed, false);
        ASSERT_GT(room.people.size(), 200U);
        Solver solver(SolverSettings{}, {.threads = seed % 2 == 0 ? 1 : 2, .alone_below = 0});
        for (int step = 0; step < testing::long_run(200); ++step) {
            ASSERT_EQ(room.step(solver), "") << "room " << seed;
            person_steps += static_cast<std::int64_t>(room.people.size());
        }
    }
    EXPECT_GT(person_steps, testing::long_run(1'000'000));
}

TEST(CrowdExtremes, NorDoTorsos)
{
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
        WildRoom room(seed, true);
        Solver solver(SolverSettings{}, {.threads = seed % 2 == 0 ? 1 : 2, .alone_below = 0});
        for (int step = 0; step < testing::long_run(200); ++step)
            ASSERT_EQ(room.step(solver), "") << "room " << seed;
    }
}

}  // namespace
}  // namespace motley
