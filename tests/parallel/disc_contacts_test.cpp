// Contacts of discs and walls that the library finds: what they do. Independent evidence: closed forms (the pushed
// chain, the inelastic pulse, a disc that slides until it rolls), conservation of momentum, and the search of every
// pair by brute force.
#include <gtest/gtest.h>

#include <cmath>

#include "disc_crowd.h"
#include "momentum_rounding.h"
#include "rig.h"
#include "scene/scene_core.h"

namespace motley {
namespace {

using testing::DiscCrowd;
using testing::person_at;

constexpr float dt = 1.0F / 60;

void take_steps(Solver& solver, Scene& scene, int steps)
{
    for (int i = 0; i < steps; ++i) {
        const StepReport report = solver.step(scene, dt);
        ASSERT_EQ(report.status, StepStatus::done) << report.error;
        ASSERT_EQ(report.bodies_contained, 0);
    }
}

/// Each of n people is driven by F into a wall: contact k from the back carries k F.
TEST(DiscContacts, OfAPushedChainCarryTheSumOfWhatIsBehind)
{
    constexpr int n = 30;
    constexpr float force = 214;
    Scene scene;
    const Vec2<double> ends[] = {{0, -1}, {0, 1}};
    const WallId wall = scene.add_wall({.points = ends});
    const std::vector<BodyId> people = testing::add_queue(scene, n, 0.2F, force);
    SolverSettings settings;
    settings.contact_hertz = 30;
    Solver solver(settings);
    take_steps(solver, scene, 600);
    const std::vector<DiscContact> contacts = scene.disc_contacts();
    ASSERT_EQ(contacts.size(), std::size_t{n});
    for (const DiscContact& contact : contacts) {
        std::size_t behind = 0;  // people from this contact to the back
        if (contact.wall == wall) {
            behind = n;
            EXPECT_NEAR(contact.normal.x, 1, 1e-6);
        } else {
            const double a = scene.state(contact.a).position.x, b = scene.state(contact.b).position.x;
            behind = static_cast<std::size_t>(n - std::lround((a + b) / 2 / 0.4));
        }
        EXPECT_NEAR(contact.normal_force, force * static_cast<float>(behind), 0.01F * force * n);
        // A soft contact sinks by F / (m w^2), m being the effective mass of the pair.
        if (contact.wall == wall) continue;
        const float w = 2 * 3.14159265F * settings.contact_hertz;
        const float sunk = contact.normal_force / (40 * w * w);
        EXPECT_NEAR(-contact.separation, sunk, 0.05F * sunk + 1e-5F);
    }
    std::vector<BodyLoad> loads(people.size());
    scene.read_loads(people, {}, std::span(loads));
    for (int i = 0; i < n; ++i) {
        const float front = force * static_cast<float>(n - i), back = front - force;
        EXPECT_NEAR(loads[static_cast<std::size_t>(i)].normal_force, front + back, 0.01F * force * n);
        EXPECT_NEAR(loads[static_cast<std::size_t>(i)].net_force.x, force, 0.01F * force * n);
    }
    EXPECT_EQ(scene.disc_contacts_of(people[0]).size(), std::size_t{2});
}

/// Restitution 0, gaps g, the first body at v: body n is hit at t = g n (n + 1) / (2 v).
TEST(DiscContacts, PassAPulseOnAtTheTimesOfPlasticImpacts)
{
    constexpr int n = 20;
    constexpr double gap = 0.1, v = 1.5;
    Scene scene;
    std::vector<BodyId> people;
    for (int i = 0; i < n; ++i) {
        BodyDefinition body = person_at((0.4 + gap) * i, 0);
        if (i == 0) body.linear_velocity.x = static_cast<float>(v);
        people.push_back(scene.add_body(body));
        scene.set_disc(people.back(), {.radius = 0.2F});
    }
    Solver solver(SolverSettings{});
    std::vector<double> hit(n, -1);
    double time = 0;
    constexpr float step = 1.0F / 240;
    for (int i = 0; i < 4000; ++i) {
        ASSERT_EQ(solver.step(scene, step).status, StepStatus::done);
        time += static_cast<double>(step);
        for (std::size_t k = 0; k < n; ++k) {
            if (hit[k] < 0 && scene.state(people[k]).linear_velocity.x > 1e-3F) hit[k] = time;
        }
    }
    for (int k = 1; k < n; ++k) {
        const double expected = gap * k * (k + 1) / (2 * v);
        EXPECT_NEAR(hit[static_cast<std::size_t>(k)], expected,
                    0.01 * expected + 2 * static_cast<double>(step))
            << "body " << k;
    }
}

/// A disc (I = m r^2 / 2) pressed on a wall slides until it rolls, at two thirds of its speed and after v / (3 mu a)
/// with the acceleration a towards the wall.
TEST(DiscContacts, SlideUntilTheyRoll)
{
    constexpr float mu = 0.3F, v = 3, a = 9.81F;
    Scene scene;
    const Vec2<double> ends[] = {{-100, 0}, {100, 0}};
    scene.add_wall({.points = ends, .friction = mu});
    const BodyId disc = scene.add_body(person_at(0, 0.2));
    scene.set_disc(disc, {.radius = 0.2F, .friction = mu});
    scene.set_velocity(disc, {v, 0, 0}, {});
    Solver solver(SolverSettings{.gravity = {0, -a, 0}});
    const float rolls_at = v / (3 * mu * a);
    const int before = static_cast<int>(0.5F * rolls_at / dt);
    take_steps(solver, scene, before);
    EXPECT_NEAR(scene.state(disc).linear_velocity.x, v - mu * a * dt * static_cast<float>(before), 0.01F);
    take_steps(solver, scene, 120);
    const BodyState state = scene.state(disc);
    EXPECT_NEAR(state.linear_velocity.x, 2 * v / 3, 0.01F);
    EXPECT_NEAR(state.angular_velocity.z, -state.linear_velocity.x / 0.2F, 0.01F);
    const std::vector<DiscContact> contacts = scene.disc_contacts();
    ASSERT_EQ(contacts.size(), std::size_t{1});
    EXPECT_NEAR(contacts[0].normal_force, 80 * a, 1);
    EXPECT_NEAR(contacts[0].friction_force, 0, 1);
}

struct Momenta {
    double x = 0, y = 0;  ///< kg m/s
    double angular = 0;   ///< kg m2/s, about the origin
    double squares = 0;   ///< (kg m/s)2, sum over the people
};

Momenta momenta_of(const DiscCrowd& crowd)
{
    Momenta sum;
    for (std::size_t i = 0; i < crowd.people.size(); ++i) {
        const BodyState s = crowd.scene.state(crowd.people[i]);
        const auto m =
            1 / static_cast<double>(core_of(crowd.scene).bodies.inverse_masses[crowd.people[i].slot]);
        const auto r = static_cast<double>(crowd.discs[i].radius);
        const double x = m * static_cast<double>(s.linear_velocity.x),
                     y = m * static_cast<double>(s.linear_velocity.y);
        sum.x += x;
        sum.y += y;
        sum.angular +=
            s.position.x * y - s.position.y * x + 0.5 * m * r * r * static_cast<double>(s.angular_velocity.z);
        sum.squares += x * x + y * y;
    }
    return sum;
}

/// Friction between two discs is an inner force: momentum stays, up to the rounding of stored velocities. Normals and
/// arms stay as they were when a step began, so that angular momentum about the origin is lost to first order in the
/// step: less than half as much in steps of a quarter. What one run loses is a sum of either sign, so that the mean
/// square of several runs is compared.
TEST(DiscContacts, ConserveMomentumAndAngularMomentum)
{
    const auto lost_at = [](float speed, float seconds) {
        DiscCrowd crowd({.people = 400, .friction = 0.5F, .speed = speed, .spacing = 0.41, .walls = false});
        const Momenta before = momenta_of(crowd);
        Solver solver(SolverSettings{});
        const int steps = static_cast<int>(std::lround(2 / seconds));
        for (int i = 0; i < steps; ++i) EXPECT_EQ(solver.step(crowd.scene, seconds).status, StepStatus::done);
        const Momenta after = momenta_of(crowd);
        // Four substeps of a solve and a relaxation, in which a person has at most six neighbours.
        const double bound =
            testing::rounding_of_momenta(steps * 4 * testing::stores_of(6, 2), before.squares);
        EXPECT_NEAR(after.x, before.x, bound);
        EXPECT_NEAR(after.y, before.y, bound);
        return after.angular - before.angular;
    };
    const auto lost_in_steps_of = [&](float seconds) {
        double squares = 0;
        constexpr int runs = testing::is_sanitized ? 2 : 12;
        for (int run = 0; run < runs; ++run) {
            const double lost = lost_at(2 + 0.01F * static_cast<float>(run), seconds);
            squares += lost * lost / runs;
        }
        return std::sqrt(squares);
    };
    const double coarse = lost_in_steps_of(dt), fine = lost_in_steps_of(dt / 4);
    EXPECT_LT(coarse, 2e-5 * 400 * 80.0 * 2 * 8);  // of 400 people of 80 kg at 2 m/s, 8 m from the origin
    EXPECT_LT(fine, coarse / 2);
}

/// A crowd of whom the last one was contained has a search without discs before it, and lives on when it is revived.
TEST(DiscContacts, OfACrowdThatIsContainedAreNone)
{
    DiscCrowd crowd({.people = 1});
    const std::uint32_t row = core_of(crowd.scene).bodies.row_of(crowd.people[0]).row();
    core_of(crowd.scene).bodies.rows(BodyKind::planar).velocity[std::size_t{4} * row] = NAN;
    Solver solver(SolverSettings{});
    EXPECT_EQ(solver.step(crowd.scene, dt).bodies_contained, 1);
    for (int step = 0; step < 3; ++step) {
        const StepReport report = solver.step(crowd.scene, dt);
        EXPECT_EQ(report.status, StepStatus::done) << report.error;
        EXPECT_EQ(report.disc_contacts, 0);
    }
    crowd.scene.set_velocity(crowd.people[0], {}, {});
    crowd.scene.set_pose(crowd.people[0], {0.1, 0.2, 0}, {0, 0, 0, 1}, 0);
    EXPECT_EQ(solver.step(crowd.scene, dt).status, StepStatus::done);
}

/// Somebody runs at 400 people on one spot, too many to add one by one. What was not added must not count as found.
TEST(DiscContacts, OfARunnerAtTooManyAreSearchedForAgain)
{
    DiscCrowd crowd({.people = 401, .speed = 0, .walls = false});
    for (std::size_t i = 0; i < crowd.people.size(); ++i)
        crowd.scene.set_pose(crowd.people[i], {i == 0 ? 0.0 : 0.72, 0, 0}, {0, 0, 0, 1}, 0);
    crowd.scene.set_velocity(crowd.people[0], {13, 0, 0}, {});
    Solver solver(SolverSettings{});
    EXPECT_EQ(solver.step(crowd.scene, dt).status, StepStatus::done);
    EXPECT_TRUE(core_of(crowd.scene).discs.is_stale);
}

TEST(DiscContacts, MissNoOverlapWhateverTheSpeedAndSize)
{
    for (const float speed : {0.0F, 2.0F, 20.0F}) {
        DiscCrowd crowd({.people = 900, .speed = speed, .spacing = 0.5});
        // A few much larger discs, which reach further than the others.
        for (const std::size_t large : {std::size_t{100}, std::size_t{470}, std::size_t{700}}) {
            crowd.discs[large].radius = 0.9F;
            crowd.scene.set_disc(crowd.people[large], crowd.discs[large]);
        }
        Solver solver(SolverSettings{}, {.threads = 2, .alone_below = 0});
        take_steps(solver, crowd.scene, 240);  // the large ones push their neighbours away
        EXPECT_LT(crowd.deepest_overlap(), 0.01 * 0.2) << "at " << speed << " m/s";
    }
}

TEST(DiscContacts, ActWithListedContactsAndJoints)
{
    Scene scene;
    const BodyId a = scene.add_body(person_at(0, 0)), b = scene.add_body(person_at(0.39, 0));
    BodyDefinition ball;
    ball.position = {0.78, 0, 0};
    ball.mass = 80;
    const BodyId c = scene.add_body(ball);
    for (const BodyId disc : {a, b}) scene.set_disc(disc, {.radius = 0.2F});
    scene.add_joint(BallSocketDefinition{scene.ground(), a, {}, {}});
    scene.set_force(c, {-100, 0, 0}, {});
    Solver solver(SolverSettings{});
    for (int i = 0; i < 300; ++i) {
        const double gap = scene.state(c).position.x - scene.state(b).position.x - 0.4;
        Contact contact;
        contact.body_a = b;
        contact.body_b = c;
        contact.key = 1;
        contact.normal = {1, 0, 0};
        contact.separation = static_cast<float>(gap);
        contact.arm_a = {0.2F, 0, 0};
        contact.arm_b = {-0.2F, 0, 0};
        ASSERT_EQ(solver.step(scene, dt, {&contact, 1}).status, StepStatus::done);
    }
    ASSERT_EQ(scene.disc_contacts().size(), std::size_t{1});
    EXPECT_NEAR(scene.disc_contacts()[0].normal_force, 100, 1);
    EXPECT_NEAR(scene.state(c).position.x, 0.8, 0.002);
}

TEST(DiscContacts, OnlyOfThoseWhoseCategoriesMeet)
{
    Scene scene;
    const BodyId ghost = scene.add_body(person_at(0, 0)), person = scene.add_body(person_at(1, 0));
    scene.set_disc(ghost, {.radius = 0.2F, .category = 2, .mask = 4});
    scene.set_disc(person, {.radius = 0.2F});
    scene.set_velocity(ghost, {1, 0, 0}, {});
    const Vec2<double> ends[] = {{2, -1}, {2, 1}};
    scene.add_wall({.points = ends, .category = 4});
    Solver solver(SolverSettings{});
    take_steps(solver, scene, 240);
    EXPECT_EQ(scene.state(person).position.x, 1);
    EXPECT_NEAR(scene.state(ghost).position.x, 1.8, 0.01);
}

/// Evidence: who was there in the last step.
TEST(DiscContacts, OfARemovedBodyAreNotThoseOfTheNextInItsPlace)
{
    Scene scene;
    std::vector<BodyId> people;
    for (int i = 0; i < 3; ++i) {
        people.push_back(scene.add_body(person_at(0.39 * i, 0)));
        scene.set_disc(people.back(), {.radius = 0.2F});
    }
    Solver solver(SolverSettings{});
    take_steps(solver, scene, 1);
    ASSERT_EQ(scene.disc_contacts().size(), std::size_t{2});
    scene.remove_body(people[0]);
    const BodyId heir = scene.add_body(person_at(0, 5));
    scene.set_disc(heir, {.radius = 0.2F});
    scene.set_pose(heir, {0, 6, 0}, {0, 0, 0, 1}, 0);
    ASSERT_EQ(heir.slot, people[0].slot);
    ASSERT_EQ(scene.disc_contacts().size(), std::size_t{1});
    EXPECT_EQ(scene.disc_contacts()[0].a, people[1]);
    EXPECT_EQ(scene.disc_contacts()[0].b, people[2]);
    EXPECT_TRUE(scene.disc_contacts_of(heir).empty());
    BodyLoad load;
    scene.read_loads({&heir, 1}, {}, StridedSpan<BodyLoad>(&load, 1));
    EXPECT_EQ(load.normal_force, 0);
}

}  // namespace
}  // namespace motley
