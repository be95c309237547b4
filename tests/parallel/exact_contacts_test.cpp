// SolverSettings::exact_contacts against statics: what stands, what each contact bears, what slides and how fast. The
// evidence is closed forms, not another solver; masonry_test.cpp has
// what stands.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "disc_crowd.h"
#include "masonry.h"

namespace motley {
namespace {

constexpr float dt = testing::frame_time;
constexpr double g = 9.81;
using testing::length;
using testing::Masonry;

/// Balls of half a metre on each other, or discs of 0.2 m in a row that lean on a wall at x = 0 with 50 N each.
struct Column {
    Scene scene;
    std::vector<BodyId> bodies;
    Vec3<double> along;
    double radius;
    std::vector<Contact> contacts;

    Column(int count, float top) : along{0, 1, 0}, radius(0.5)
    {
        for (int i = 0; i < count; ++i) {
            BodyDefinition ball = testing::box({0, (2 * i + 1) * radius, 0}, i + 1 == count ? top : 1);
            bodies.push_back(scene.add_body(ball));
        }
    }
    explicit Column(int count) : along{1, 0, 0}, radius(0.2)
    {
        for (int i = 0; i < count; ++i) {
            BodyDefinition person;
            person.model = BodyModel::planar;
            person.position = {(2 * i + 1) * radius, 0, 0};
            person.mass = 80;
            bodies.push_back(scene.add_body(person));
        }
    }
    StepReport step(Solver& solver)
    {
        contacts.clear();
        for (std::size_t i = 0; i < bodies.size(); ++i) {
            const Vec3<double> place = scene.state(bodies[i]).position;
            Contact contact;
            contact.key = i + 1;
            contact.normal = convert<float>(along);
            contact.body_a = i == 0 ? scene.ground() : bodies[i - 1];
            contact.body_b = bodies[i];
            const double before = i == 0 ? 0 : dot(along, scene.state(bodies[i - 1]).position) + radius;
            contact.separation = static_cast<float>(dot(along, place) - radius - before);
            contact.arm_b = convert<float>(-radius * along);
            contact.arm_a = i == 0 ? Vec3<float>{} : convert<float>(radius * along);
            contacts.push_back(contact);
        }
        const StepReport report = solver.step(scene, dt, contacts);
        EXPECT_EQ(report.status, StepStatus::done) << report.error;
        return report;
    }
};

TEST(ExactContacts, BallsSinkIntoEachOtherByNothing)
{
    struct Case {
        int count;
        float top;     ///< kg
        double bound;  ///< radii
    };
    // Under 1,000 t the first steps leave more than under 1 t.
    for (const auto& [count, top, bound] : {Case{200, 1, 1e-3}, {2, 1000, 1e-3}, {2, 1e6F, 1e-2}}) {
        Column balls(count, top);
        Solver solver(testing::exact_contacts());
        for (int step = 0; step < testing::long_run(300); ++step) balls.step(solver);
        const double sunk =
            (2 * count - 1) * balls.radius - balls.scene.state(balls.bodies.back()).position.y;
        EXPECT_LT(std::abs(sunk) / balls.radius, bound) << count << " balls under " << top << " kg";
    }
}

/// Contact k from the back bears k F: from half a second on, at every step, where sweeps take many seconds.
TEST(ExactContacts, ALeaningRowBearsWhatIsBehind)
{
    constexpr double force = 50;
    for (const int count : {100, 300}) {
        Column row(count);
        Solver solver(testing::exact_contacts({0, 0, 0}));
        double worst = 0;
        for (int step = 0; step < 180; ++step) {
            for (const BodyId body : row.bodies)
                row.scene.set_force(body, {-static_cast<float>(force), 0, 0}, {0, 0, 0});
            row.step(solver);
            if (step < 30) continue;
            double squares = 0;
            for (int k = 0; k < count; ++k) {
                const double borne =
                    static_cast<double>(row.scene.contact_impulses()[static_cast<std::size_t>(k)].normal) /
                    static_cast<double>(dt);
                const double off = (borne - (count - k) * force) / (count * force);
                squares += off * off;
            }
            worst = std::max(worst, std::sqrt(squares / count));
        }
        EXPECT_LT(worst, 5e-3) << count;
    }
}

/// The same of discs, whose contacts the library finds, and with friction.
TEST(ExactContacts, ALeaningRowOfDiscsBearsWhatIsBehind)
{
    constexpr double force = 50;
    constexpr int count = 100;
    for (const float friction : {0.0F, 0.3F}) {
        Scene scene;
        std::vector<BodyId> people;
        std::vector<DiscDefinition> discs;
        for (int i = 0; i < count; ++i) {
            BodyDefinition person;
            person.model = BodyModel::planar;
            person.position = {0.2 + 0.4 * i, 0, 0};
            person.mass = 80;
            people.push_back(scene.add_body(person));
            discs.push_back({.radius = 0.2F, .friction = friction});
        }
        scene.set_discs(people, StridedSpan<const DiscDefinition>(discs));
        const Vec2<double> ends[] = {{0, -5}, {0, 5}};
        scene.add_wall({.points = ends});
        Solver solver(testing::exact_contacts({0, 0, 0}));
        double worst = 0;
        for (int step = 0; step < 120; ++step) {
            for (const BodyId body : people)
                scene.set_force(body, {-static_cast<float>(force), 0, 0}, {0, 0, 0});
            const StepReport report = solver.step(scene, dt);
            ASSERT_EQ(report.status, StepStatus::done) << report.error;
            EXPECT_EQ(report.exact_contact_islands, 1);
            if (step < 30) continue;
            std::vector<BodyLoad> loads(people.size());
            scene.read_loads(people, {}, StridedSpan<BodyLoad>(loads));
            for (int k = 0; k < count; ++k) {
                // Each is pushed from behind and by what is in front.
                const double borne = static_cast<double>(loads[static_cast<std::size_t>(k)].normal_force);
                worst = std::max(worst, std::abs(borne - (2 * (count - k) - 1) * force) / (count * force));
            }
        }
        EXPECT_LT(worst, 1e-2) << "friction " << friction;
    }
}

/// A heap that is thrown together: what each body gains is what its contacts report, and friction stays in its cone.
TEST(ExactContacts, ReportWhatActs)
{
    Masonry boxes = testing::tower(6);
    boxes.friction = 0.3F;
    for (std::size_t i = 0; i < boxes.blocks.size(); ++i)
        boxes.scene.set_velocity(boxes.blocks[i], {i % 2 == 0 ? 1.0F : -1.0F, -1, 0.3F}, {0, 0, 0});
    Solver solver(testing::exact_contacts());
    for (int step = 0; step < 20; ++step) {
        std::vector<Vec3<double>> gained(boxes.blocks.size());
        const auto speed = [&](std::size_t i) {
            return convert<double>(boxes.scene.state(boxes.blocks[i]).linear_velocity);
        };
        for (std::size_t i = 0; i < gained.size(); ++i) gained[i] = -1.0 * speed(i);
        boxes.step(solver);
        for (std::size_t i = 0; i < gained.size(); ++i)
            gained[i] = gained[i] + speed(i) - Vec3<double>{0, -g * static_cast<double>(dt), 0};
        for (std::size_t c = 0; c < boxes.contacts.size(); ++c) {
            const Contact& contact = boxes.contacts[c];
            const ContactImpulse& impulse = boxes.scene.contact_impulses()[c];
            EXPECT_LE(length(convert<double>(impulse.friction)),
                      0.3 * static_cast<double>(impulse.normal) * (1 + 1e-5) + 1e-7);
            const Vec3<double> push = static_cast<double>(impulse.normal) * convert<double>(contact.normal) +
                                      convert<double>(impulse.friction);
            for (std::size_t i = 0; i < boxes.blocks.size(); ++i) {
                if (contact.body_a == boxes.blocks[i]) gained[i] = gained[i] + push;
                if (contact.body_b == boxes.blocks[i]) gained[i] = gained[i] - push;
            }
        }
        for (const Vec3<double>& left : gained) EXPECT_LT(length(left), 2e-5);
    }
}

std::vector<std::uint64_t> hashes(Masonry bricks, const SolverOptions& options,
                                  const SolverSettings& settings)
{
    // A blow, so that contacts begin, end and slide.
    bricks.scene.set_velocity(bricks.blocks.back(), {2, -1, 0.5F}, {0, 0, 0});
    Solver solver(settings, options);
    std::vector<std::uint64_t> all;
    for (int step = 0; step < 12; ++step) {
        bricks.step(solver);
        all.push_back(bricks.scene.state_hash());
    }
    return all;
}

TEST(ExactContacts, HaveEqualBitsOnEveryInstructionSetAndNumberOfThreads)
{
    SolverSettings settings = testing::exact_contacts();
    for (const int substeps : {1, 3}) {
        if (testing::is_sanitized && substeps == 1) continue;
        settings.substeps = substeps;
        const auto scalar = hashes(testing::wall(4), {.isa = Isa::scalar}, settings);
        for (const Isa isa : available_isas()) {
            for (const int threads : {1, 2, 3}) {
                EXPECT_EQ(
                    hashes(testing::wall(4), {.threads = threads, .alone_below = 0, .isa = isa}, settings),
                    scalar)
                    << isa_name(isa) << ", " << threads << " threads";
            }
        }
    }
}

TEST(ExactContacts, OfDiscsHaveEqualBitsAndKeepMomentum)
{
    const auto run = [](const SolverOptions& options, Vec3<double>& gained) {
        testing::DiscCrowd crowd(
            {.people = 200, .friction = 0.4F, .speed = 1, .spacing = 0.41, .walls = false});
        const auto momentum = [&] {
            const SceneErrors errors = crowd.scene.errors();
            return Vec3<double>{errors.momentum[0], errors.momentum[1], errors.momentum[2]};
        };
        gained = -1.0 * momentum();
        Solver solver(testing::exact_contacts({0, 0, 0}), options);
        std::vector<std::uint64_t> all;
        bool any = false;
        for (int step = 0; step < 30; ++step) {
            const StepReport report = solver.step(crowd.scene, dt);
            EXPECT_EQ(report.status, StepStatus::done) << report.error;
            any = any || report.exact_contact_islands > 0;
            all.push_back(crowd.scene.state_hash());
        }
        EXPECT_TRUE(any);
        gained = gained + momentum();
        return all;
    };
    Vec3<double> gained;
    const auto scalar = run({.isa = Isa::scalar}, gained);
    EXPECT_LT(length(gained), 0.02);  // of 200 people of 60 to 100 kg at 1 m/s, N s: rounding
    for (const Isa isa : available_isas()) {
        for (const int threads : {1, 3})
            EXPECT_EQ(run({.threads = threads, .alone_below = 0, .isa = isa}, gained), scalar)
                << isa_name(isa) << ", " << threads << " threads";
    }
}

/// A solver that has never seen the scene goes on with the same bits.
TEST(ExactContacts, DependOnTheSceneAlone)
{
    Masonry bricks = testing::wall(4);
    bricks.scene.set_velocity(bricks.blocks.back(), {2, -1, 0.5F}, {0, 0, 0});
    Solver solver(testing::exact_contacts());
    for (int step = 0; step < 6; ++step) bricks.step(solver);
    Masonry copy = bricks;
    Solver other(testing::exact_contacts());
    for (int step = 0; step < 6; ++step) {
        bricks.step(solver);
        copy.step(other);
        EXPECT_EQ(bricks.scene.state_hash(), copy.scene.state_hash()) << step;
    }
}

/// A pack of many is left to the sweeps, with the bits of a step that does not ask for more, and is counted.
TEST(ExactContacts, LeaveDensePacksToTheSweeps)
{
    const auto pack = [](bool asks, StepReport& report) {
        Scene scene;
        std::vector<BodyId> balls;
        constexpr int side = 14;
        for (int i = 0; i < side * side * side; ++i) {
            const Vec3<double> place{1.0 * (i % side), 0.5 + i / side / side, 1.0 * (i / side % side)};
            balls.push_back(scene.add_body(testing::box(place, 1)));
        }
        std::vector<Contact> contacts;
        const auto touch = [&](BodyId a, BodyId b, Vec3<float> n) {
            Contact contact;
            contact.key = contacts.size() + 1;
            contact.body_a = a;
            contact.body_b = b;
            contact.normal = n;
            contact.arm_a =
                a == scene.ground() ? convert<float>(scene.state(b).position) - 0.5F * n : 0.5F * n;
            contact.arm_b = -0.5F * n;
            contacts.push_back(contact);
        };
        for (int i = 0; i < side * side * side; ++i) {
            const auto at = [&](int k) { return balls[static_cast<std::size_t>(k)]; };
            if (i % side + 1 < side) touch(at(i), at(i + 1), {1, 0, 0});
            if (i / side % side + 1 < side) touch(at(i), at(i + side), {0, 0, 1});
            if (i / side / side == 0) touch(scene.ground(), at(i), {0, 1, 0});
            if (i / side / side + 1 < side) touch(at(i), at(i + side * side), {0, 1, 0});
        }
        SolverSettings settings = testing::exact_contacts();
        settings.exact_contacts = asks;
        Solver solver(settings);
        for (int step = 0; step < 2; ++step) report = solver.step(scene, dt, contacts);
        EXPECT_EQ(report.status, StepStatus::done) << report.error;
        return scene.state_hash();
    };
    StepReport asked, plain;
    EXPECT_EQ(pack(true, asked), pack(false, plain));
    EXPECT_EQ(asked.exact_contacts_refused, 1);
    EXPECT_EQ(asked.exact_contact_islands, 0);
    EXPECT_EQ(plain.exact_contacts_refused, 0);
}

}  // namespace
}  // namespace motley
