// Contacts of discs in measures, tolerances, islands and the direct method. Independent evidence: residuals and penetrations in double
// from what a host reads (positions, velocities, forces) and every pair tried, statics, a disc that rolls, conservation of momentum.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>

#include "disc_crowd.h"
#include "rig.h"

namespace motley {
namespace {

using testing::person_at;

constexpr float dt = 1.0F / 60, radius = 0.25F, mass = 80;

/// People without friction, pressed into the corner of two walls.
struct Corner {
    Scene scene;
    std::vector<BodyId> people;

    explicit Corner(int a_side)
    {
        std::mt19937 random(5);
        std::uniform_real_distribution<double> off(-0.005, 0.005);
        for (int i = 0; i < a_side * a_side; ++i) {
            // One after the other: as arguments of one call, compilers would choose their order.
            const double x = 0.26 + 0.51 * (i % a_side) + off(random);
            const double y = 0.26 + 0.51 * (i / a_side) + off(random);
            people.push_back(scene.add_body(person_at(x, y)));
        }
        const std::vector<DiscDefinition> discs(people.size(), {.radius = radius});
        scene.set_discs(people, discs);
        const Vec2<double> corner[] = {{0, 40}, {0, 0}, {40, 0}};
        scene.add_wall({.points = corner});
    }
    void push()
    {
        for (const BodyId body : people) scene.set_force(body, {-200, -120, 0}, {});
    }
};

/// By how much solving a contact without friction would change the speed at it, m/s: 0 where its impulse and its opening speed are
/// complementary.
double left_of(double separation, double opening, double inverse_masses, double force)
{
    const double h = static_cast<double>(dt), lambda = h * force;
    const double speed = opening + std::max(separation, 0.0) / h;
    return std::abs(inverse_masses * (std::max(lambda - speed / inverse_masses, 0.0) - lambda));
}

struct Expected {
    double residual_squares = 0, residual_max = 0, penetration_squares = 0, penetration_max = 0;
    int surely_overlapping = 0, may_overlap = 0;
    void note(double separation, double opening, double inverse_masses, double force)
    {
        const double left = left_of(separation, opening, inverse_masses, force);
        residual_squares += left * left;
        residual_max = std::max(residual_max, left);
        // Of contacts that just touch, rounding decides whether they overlap.
        surely_overlapping += separation < -1e-7 ? 1 : 0;
        may_overlap += separation < 1e-7 ? 1 : 0;
        if (separation >= 0) return;
        penetration_squares += separation * separation;
        penetration_max = std::max(penetration_max, -separation);
    }
};

SolverSettings measured_sweeps(int iterations)
{
    SolverSettings settings = testing::weightless_sweeps(iterations);
    settings.measures = true;
    return settings;
}

TEST(DiscMeasures, AreThoseOfWhatAHostReads)
{
    for (const int iterations : {1, 3, 10}) {
        Corner corner(7);
        Scene& scene = corner.scene;
        Solver solver(measured_sweeps(iterations));
        for (int step = 0; step < 12; ++step) {
            corner.push();
            std::vector<Vec3<double>> before;
            for (const BodyId body : corner.people)
                before.push_back(convert<double>(scene.state(body).position));
            const StepReport report = solver.step(scene, dt);
            ASSERT_EQ(report.status, StepStatus::done) << report.error;
            const std::vector<DiscContact> contacts = scene.disc_contacts();
            const auto force_between = [&](BodyId a, BodyId b, double normal_x) {
                for (const DiscContact& contact : contacts) {
                    const bool is_pair =
                        (contact.a == a && contact.b == b) || (contact.a == b && contact.b == a);
                    const bool is_of_wall = contact.wall != WallId{} && a == BodyId{} && contact.b == b &&
                                            std::abs(static_cast<double>(contact.normal.x) - normal_x) < 1e-3;
                    if (is_pair || is_of_wall) return static_cast<double>(contact.normal_force);
                }
                return 0.0;
            };
            Expected expected;
            const double r = static_cast<double>(radius), w = 1 / static_cast<double>(mass);
            for (std::size_t i = 0; i < before.size(); ++i) {
                const BodyId b = corner.people[i];
                const Vec3<float> v = scene.state(b).linear_velocity;
                for (std::size_t k = 0; k < i; ++k) {
                    const Vec3<double> between = before[i] - before[k];
                    const double distance = std::sqrt(dot(between, between));
                    const Vec3<double> speed =
                        convert<double>(v - scene.state(corner.people[k]).linear_velocity);
                    expected.note(distance - 2 * r, dot(between, speed) / distance, 2 * w,
                                  force_between(corner.people[k], b, 0));
                }
                expected.note(before[i].x - r, static_cast<double>(v.x), w, force_between({}, b, 1));
                expected.note(before[i].y - r, static_cast<double>(v.y), w, force_between({}, b, 0));
            }
            const StepMeasures& measured = report.measures;
            // Separations are distances of 0.5 m in float: both differences, the root and the subtraction round by up to 3e-8 m each.
            // Over the step that is a speed of 6e-6 m/s.
            EXPECT_NEAR(measured.residual_max, expected.residual_max, 1e-3 * expected.residual_max + 6e-6);
            EXPECT_NEAR(measured.residual_rms,
                        std::sqrt(expected.residual_squares / static_cast<double>(report.contacts)),
                        1e-3 * measured.residual_rms + 6e-6);
            EXPECT_NEAR(measured.penetration_max, expected.penetration_max, 1e-7);
            const auto rms = [&](int of) {
                return std::sqrt(expected.penetration_squares / static_cast<double>(std::max(1, of)));
            };
            EXPECT_GE(measured.penetration_rms, rms(expected.may_overlap) - 1e-7);
            EXPECT_LE(measured.penetration_rms, rms(expected.surely_overlapping) + 1e-7);
            if (step == 11) {
                EXPECT_GT(measured.penetration_max, 1e-4);
                EXPECT_GT(measured.residual_max, iterations < 10 ? 1e-3 : 1e-5);
            }
        }
    }
}

/// Two crowds far apart and somebody alone, all pushed. The crowd in the corner is pressed, the other one walks freely.
TEST(DiscMeasures, AToleranceEndsTheSweepsOfEachIsland)
{
    Corner corner(6);
    Scene& scene = corner.scene;
    for (int i = 0; i < 3; ++i) {
        corner.people.push_back(scene.add_body(person_at(100 + 0.51 * i, 100)));
        scene.set_disc(corner.people.back(), {.radius = radius});
    }
    corner.people.push_back(scene.add_body(person_at(300, 300)));
    scene.set_disc(corner.people.back(), {.radius = radius});
    for (const float tolerance : {1e-2F, 1e-3F, 1e-4F}) {
        SolverSettings settings = measured_sweeps(10'000);
        settings.tolerance = tolerance;
        Solver solver(settings);
        std::int64_t most = 0;
        for (int step = 0; step < 30; ++step) {
            corner.push();
            const StepReport report = solver.step(scene, dt);
            ASSERT_EQ(report.status, StepStatus::done) << report.error;
            EXPECT_EQ(report.islands, 2);  // who stands alone has no contact
            EXPECT_EQ(report.islands_above_tolerance, 0);
            // The measures are those of one more sweep.
            EXPECT_LE(report.measures.residual_max, static_cast<double>(tolerance));
            most = std::max<std::int64_t>(most, report.iterations);
        }
        EXPECT_LT(most, 1000) << tolerance;
        EXPECT_GT(most, 2) << tolerance;
    }
}

/// The same bits on every instruction set and number of threads, with islands that end at different times.
TEST(DiscMeasures, HaveTheSameBitsEverywhere)
{
    std::optional<std::pair<std::uint64_t, double>> expected;
    for (const Isa isa : available_isas()) {
        for (const int threads : {1, 2}) {
            Corner corner(12);
            SolverSettings settings;
            settings.iterations = 20;
            settings.tolerance = 1e-3F;
            settings.measures = true;
            SolverOptions options;
            options.threads = threads;
            options.isa = isa;
            options.alone_below = 0;
            Solver solver(settings, options);
            StepReport report;
            for (int step = 0; step < 30; ++step) {
                corner.push();
                corner.scene.set_island_iterations(corner.people[0], step % 2 == 0 ? 25 : 1);
                report = solver.step(corner.scene, dt);
                ASSERT_EQ(report.status, StepStatus::done) << report.error;
            }
            const std::pair<std::uint64_t, double> got{corner.scene.state_hash(),
                                                       report.measures.residual_rms};
            if (!expected) expected = got;
            EXPECT_EQ(got, *expected) << isa_name(isa) << ", " << threads << " threads";
        }
    }
}

/// Each of n people is driven by F into a wall. A wish for many sweeps makes the chain exact in a single step.
TEST(DiscIslands, HaveAsManySweepsAsTheHostWants)
{
    constexpr int n = 40;
    constexpr float force = 200;
    Scene scene;
    const Vec2<double> ends[] = {{0, -2}, {0, 2}};
    scene.add_wall({.points = ends});
    const std::vector<BodyId> people = testing::add_queue(scene, n, radius, force);
    Scene without = scene;
    scene.set_island_iterations(people[3], 5000);
    SolverSettings settings = measured_sweeps(2);
    settings.warm_start = false;
    const auto borne = [&](Scene& of) {
        Solver solver(settings);
        EXPECT_EQ(solver.step(of, dt).error, "");
        for (const DiscContact& contact : of.disc_contacts_of(people[0])) {
            if (contact.wall != WallId{}) return contact.normal_force;
        }
        return 0.0F;
    };
    EXPECT_NEAR(borne(scene), n * force, 1e-3F * n * force);
    EXPECT_LT(borne(without), 0.9F * n * force);
}

/// A wish of a joint for more sweeps, whose bodies touch nothing, changes nothing of a crowd beside it.
TEST(DiscIslands, AreSolvedWhereAJointElsewhereWantsMoreSweeps)
{
    std::uint64_t hash[2];
    for (int wish = 0; wish < 2; ++wish) {
        Corner corner(5);
        const BodyId ball = corner.scene.add_body({.position = {1, 0, 500}, .mass = 2});
        const ConstraintId joint = corner.scene.add_joint(
            BallSocketDefinition{corner.scene.ground(), ball, {0, 0, 500}, {-1, 0, 0}});
        if (wish == 1) corner.scene.set_iterations(joint, 1);
        Solver solver;
        for (int step = 0; step < 30; ++step) {
            corner.push();
            ASSERT_EQ(solver.step(corner.scene, dt).error, "");
        }
        hash[wish] = corner.scene.state_hash();
    }
    EXPECT_EQ(hash[0], hash[1]);
}

SolverSettings direct()
{
    SolverSettings settings;
    settings.method = Method::direct;
    return settings;
}

/// Each of n people is driven by F into a wall: contact k from the back carries k F, in the very first step.
TEST(DiscsDirectly, AQueueBearsWhatIsBehindItAtOnce)
{
    constexpr int n = 60;
    constexpr float force = 214;
    Scene scene;
    const Vec2<double> ends[] = {{0, -1}, {0, 1}};
    const WallId wall = scene.add_wall({.points = ends});
    testing::add_queue(scene, n, radius, force);
    Solver solver(direct());
    for (int step = 0; step < 3; ++step) {
        const StepReport report = solver.step(scene, dt);
        ASSERT_EQ(report.error, "");
        EXPECT_EQ(report.direct_unsolved, 0);
        EXPECT_EQ(report.contacts, n);
        const std::vector<DiscContact> contacts = scene.disc_contacts();
        ASSERT_EQ(contacts.size(), std::size_t{n});
        for (const DiscContact& contact : contacts) {
            const double b = scene.state(contact.b).position.x, r = static_cast<double>(radius);
            const double at = contact.wall == wall ? 0 : (scene.state(contact.a).position.x + b) / 2;
            const auto ahead = static_cast<float>(std::lround(at / (2 * r)));
            EXPECT_NEAR(contact.normal_force, (n - ahead) * force, 1e-5F * n * force);
        }
    }
}

/// A disc is pressed against a wall by N and pulled along it by F. While it rolls, its acceleration is F / (m (1 + I / (m r^2)))
/// and friction is what is missing of F; beyond mu N it slides, and friction is mu N.
TEST(DiscsDirectly, RollAndSlideAsCoulombSays)
{
    constexpr float press = 500, mu = 0.4F, inertia = 2;
    const float roll = 1 + inertia / (mass * radius * radius);
    for (const float pull : {100.0F, 2000.0F}) {
        Scene scene;
        const Vec2<double> ends[] = {{-50, 0}, {50, 0}};
        scene.add_wall({.points = ends, .friction = mu});
        BodyDefinition person = person_at(0, radius);
        person.inertia = {inertia, 0, 0, inertia, 0, inertia};
        const BodyId body = scene.add_body(person);
        scene.set_disc(body, {.radius = radius, .friction = mu});
        Solver solver(direct());
        constexpr int steps = 30;
        for (int step = 0; step < steps; ++step) {
            scene.set_force(body, {pull, -press, 0}, {});
            ASSERT_EQ(solver.step(scene, dt).error, "");
        }
        const float friction = std::min(pull - pull / roll, mu * press);
        const std::vector<DiscContact> contacts = scene.disc_contacts();
        ASSERT_EQ(contacts.size(), 1U);
        EXPECT_NEAR(contacts[0].normal_force, press, 1e-3F);
        EXPECT_NEAR(std::abs(contacts[0].friction_force), friction, 1e-3F);
        EXPECT_NEAR(scene.state(body).linear_velocity.x, (pull - friction) / mass * steps * dt, 1e-4);
        EXPECT_NEAR(std::abs(scene.state(body).angular_velocity.z), friction * radius / inertia * steps * dt,
                    1e-3);
        if (pull < 1000) {
            EXPECT_LT(friction, mu * press);  // it rolls
            EXPECT_NEAR(scene.state(body).linear_velocity.x + radius * scene.state(body).angular_velocity.z,
                        0, 1e-5);
        } else {
            EXPECT_EQ(friction, mu * press);
        }
    }
}

/// Two crowds that collide keep linear and angular momentum, and friction never adds energy.
TEST(DiscsDirectly, KeepMomenta)
{
    Scene scene;
    std::vector<BodyId> people;
    std::mt19937 random(11);
    std::uniform_real_distribution<double> off(-0.05, 0.05);
    for (int i = 0; i < 32; ++i) {
        const double x = 0.62 * (i % 8) + off(random) + (i % 8 < 4 ? 0 : 0.4);
        const double y = 0.62 * (i / 8) + off(random);
        BodyDefinition person = person_at(x, y);
        person.linear_velocity = {i % 8 < 4 ? 1.5F : -1.0F, 0, 0};
        people.push_back(scene.add_body(person));
        scene.set_disc(people.back(), {.radius = radius, .friction = 0.5F});
    }
    struct Momenta {
        double x = 0, y = 0, turn = 0, energy = 0;
    };
    const auto momenta = [&] {
        Momenta all;
        for (const BodyId body : people) {
            const BodyState state = scene.state(body);
            const double m = static_cast<double>(mass),
                         inertia = static_cast<double>(person_at(0, 0).inertia.zz);
            const double x = static_cast<double>(state.linear_velocity.x),
                         y = static_cast<double>(state.linear_velocity.y),
                         w = static_cast<double>(state.angular_velocity.z);
            all.x += m * x;
            all.y += m * y;
            all.turn += m * (state.position.x * y - state.position.y * x) + inertia * w;
            all.energy += (m * (x * x + y * y) + inertia * w * w) / 2;
        }
        return all;
    };
    // With one substep impulses act where the bodies are when the step begins; normals stay through a step.
    SolverSettings settings = direct();
    settings.substeps = 1;
    Solver solver(settings);
    const Momenta began = momenta();
    double energy = began.energy;
    std::int64_t touched = 0;
    for (int step = 0; step < 40; ++step) {
        const StepReport report = solver.step(scene, dt);
        ASSERT_EQ(report.error, "");
        EXPECT_EQ(report.direct_unsolved, 0);
        touched += static_cast<std::int64_t>(scene.disc_contacts().size());
        const Momenta now = momenta();
        EXPECT_NEAR(now.x, began.x, 2e-3);
        EXPECT_NEAR(now.y, began.y, 2e-3);
        EXPECT_NEAR(now.turn, began.turn, 5e-3);
        EXPECT_LE(now.energy, energy * (1 + 1e-6));
        energy = now.energy;
    }
    EXPECT_GT(touched, 100);
    EXPECT_LT(energy, 0.7 * began.energy);
}

/// A turnstile lets people through one way only, directly as well: its left side, from which nobody passes, is that of negative x.
TEST(DiscsDirectly, PassAOneWayWallOneWay)
{
    for (const float way : {1.0F, -1.0F}) {
        Scene scene;
        const Vec2<double> ends[] = {{0, -2}, {0, 2}};
        scene.add_wall({.points = ends, .one_way = true});
        BodyDefinition person = person_at(static_cast<double>(-way), 0);
        person.linear_velocity = {2 * way, 0, 0};
        const BodyId body = scene.add_body(person);
        scene.set_disc(body, {.radius = radius});
        Solver swept, solver(direct());
        Scene twin = scene;
        for (int step = 0; step < 60; ++step) {
            ASSERT_EQ(solver.step(scene, dt).error, "");
            ASSERT_EQ(swept.step(twin, dt).error, "");
        }
        const double x = scene.state(body).position.x;
        EXPECT_NEAR(x, twin.state(body).position.x, 1e-2);
        EXPECT_NEAR(x, way < 0 ? -1 : -static_cast<double>(radius), 1e-2);
    }
}

/// Sweeps approach what the direct method finds at once, also where the host lists a contact beside those of discs.
TEST(DiscsDirectly, AreWhatManySweepsApproach)
{
    Corner swept(5), solved(5);
    SolverSettings settings = measured_sweeps(10'000);
    Solver sweeps(settings);
    SolverSettings at_once = direct();
    at_once.drift_correction = DriftCorrection::none;
    at_once.substeps = 1;
    Solver solver(at_once);
    for (int step = 0; step < 20; ++step) {
        swept.push();
        solved.push();
        const Vec3<float> before = solved.scene.state(solved.people.back()).linear_velocity;
        std::vector<Contact> contacts[2];
        Corner* const corners[] = {&swept, &solved};
        for (int i = 0; i < 2; ++i) {
            // The host holds the last person back, under a key that contacts of discs might be given too.
            const BodyId last = corners[i]->people.back();
            const double x = corners[i]->scene.state(last).position.x;
            contacts[i].push_back({.body_a = corners[i]->scene.ground(),
                                   .body_b = last,
                                   .key = 0,
                                   .normal = {1, 0, 0},
                                   .separation = static_cast<float>(x - 2.25),
                                   .arm_b = {-radius, 0, 0}});
        }
        ASSERT_EQ(sweeps.step(swept.scene, dt, contacts[0]).error, "");
        ASSERT_EQ(solver.step(solved.scene, dt, contacts[1]).error, "");
        // Each contact has its own impulse: together they are what changed the velocity of the last body.
        const BodyId last = solved.people.back();
        Vec3<float> impulse{solved.scene.contact_impulses()[0].normal - 200 * dt, -120 * dt, 0};
        for (const DiscContact& contact : solved.scene.disc_contacts_of(last)) {
            const float along = (contact.b == last ? dt : -dt) * contact.normal_force;
            impulse = impulse + along * Vec3<float>{contact.normal.x, contact.normal.y, 0};
        }
        const Vec3<float> gained = solved.scene.state(last).linear_velocity - before;
        EXPECT_NEAR(mass * gained.x, impulse.x, 1e-4);
        EXPECT_NEAR(mass * gained.y, impulse.y, 1e-4);
        for (std::size_t i = 0; i < swept.people.size(); ++i) {
            const Vec3<float> a = swept.scene.state(swept.people[i]).linear_velocity,
                              b = solved.scene.state(solved.people[i]).linear_velocity;
            EXPECT_NEAR(a.x, b.x, 1e-5);
            EXPECT_NEAR(a.y, b.y, 1e-5);
        }
    }
}

}  // namespace
}  // namespace motley
