// SolverSettings::exact_contacts against statics: what stands, what each contact bears, what slides and how fast. The
// evidence is closed forms and the theory of arches (J. Heyman, The Stone Skeleton, 1966), not another solver.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "disc_crowd.h"
#include "rig.h"

namespace motley {
namespace {

constexpr float dt = testing::frame_time;
constexpr double g = 9.81;

SolverSettings exact(Vec3<float> gravity = {0, -9.81F, 0})
{
    SolverSettings settings;
    settings.gravity = gravity;
    settings.exact_contacts = true;
    settings.substeps = 1;
    return settings;
}

double length(const Vec3<double>& v)
{
    return std::sqrt(dot(v, v));
}

/// The place of a point of a body, m, world.
Vec3<double> place_of(const Scene& scene, BodyId body, const Vec3<double>& local)
{
    const BodyState state = scene.state(body);
    return state.position + rotate(state.orientation, local);
}

/// A face of body a on corners of body b.
struct Joint {
    BodyId a, b;
    Vec3<double> normal, on_face;       ///< in the frame of a
    std::vector<Vec3<double>> corners;  ///< in the frame of b
};

/// Blocks that stand on each other, with contacts at the corners.
struct Masonry {
    Scene scene;
    std::vector<BodyId> blocks;
    std::vector<Vec3<double>> start;
    std::vector<Joint> joints;
    float friction = 0.6F;
    std::vector<Contact> contacts;

    BodyId add(const Vec3<double>& position, const Vec3<double>& half, float mass)
    {
        const auto third = mass / 3;
        const Vec3<float> h = convert<float>(half);
        BodyDefinition body;
        body.position = position;
        body.mass = mass;
        body.inertia = {third * (h.y * h.y + h.z * h.z), 0, 0,
                        third * (h.x * h.x + h.z * h.z), 0, third * (h.x * h.x + h.y * h.y)};
        blocks.push_back(scene.add_body(body));
        start.push_back(position);
        return blocks.back();
    }
    /// The face y = `top` of a under the corners of a rectangle of b, half lengths x and z, centre at `centre`.
    void lay(BodyId a, const Vec3<double>& on_face, BodyId b, const Vec3<double>& centre, double x, double z)
    {
        Joint joint{a, b, {0, 1, 0}, on_face, {}};
        for (const double i : {-1.0, 1.0}) {
            for (const double k : {-1.0, 1.0})
                joint.corners.push_back(centre + Vec3<double>{i * x, 0, k * z});
        }
        joints.push_back(joint);
    }
    std::vector<Contact>& find()
    {
        contacts.clear();
        std::uint64_t key = 0;
        for (const Joint& joint : joints) {
            const Vec3<double> n = rotate(scene.state(joint.a).orientation, joint.normal);
            const Vec3<double> face = place_of(scene, joint.a, joint.on_face);
            for (const Vec3<double>& corner : joint.corners) {
                const Vec3<double> point = place_of(scene, joint.b, corner);
                Contact contact;
                contact.key = ++key;
                contact.body_a = joint.a;
                contact.body_b = joint.b;
                contact.normal = convert<float>(n);
                const double apart = dot(n, point - face);
                contact.separation = static_cast<float>(apart);
                contact.arm_a = convert<float>(point - apart * n - scene.state(joint.a).position);
                contact.arm_b = convert<float>(point - scene.state(joint.b).position);
                contact.friction = friction;
                if (apart < 0.2) contacts.push_back(contact);
            }
        }
        return contacts;
    }
    StepReport step(Solver& solver)
    {
        const StepReport report = solver.step(scene, dt, find());
        EXPECT_EQ(report.status, StepStatus::done) << report.error;
        return report;
    }
    [[nodiscard]] double farthest() const
    {
        double most = 0;
        for (std::size_t i = 0; i < blocks.size(); ++i)
            most = std::max(most, length(scene.state(blocks[i]).position - start[i]));
        return most;
    }
};

/// Boxes of 1 m and 1 kg on each other, each up to 1 mm aside; the uppermost has the mass `top`, kg.
Masonry tower(int count, float top = 1)
{
    Masonry tower;
    for (int i = 0; i < count; ++i) {
        const double x = 1e-3 * std::sin(12.9898 * i), z = 1e-3 * std::cos(78.233 * i);
        const BodyId box = tower.add({x, 0.5 + i, z}, {0.5, 0.5, 0.5}, i + 1 == count ? top : 1);
        if (i == 0) {
            tower.lay(tower.scene.ground(), {0, 0, 0}, box, {0, -0.5, 0}, 0.5, 0.5);
        } else {
            tower.lay(tower.blocks[static_cast<std::size_t>(i) - 1], {0, 0.5, 0}, box, {0, -0.5, 0}, 0.499,
                      0.499);
        }
    }
    return tower;
}

TEST(ExactContacts, ATowerOfFiftyBoxesStandsAndBearsItsWeight)
{
    Masonry boxes = tower(50);
    Solver solver(exact());
    for (int step = 0; step < testing::long_run(600); ++step) boxes.step(solver);
    EXPECT_LT(boxes.farthest(), 1e-3);
    // Joint k, of four contacts, bears what stands on it.
    const auto impulses = boxes.scene.contact_impulses();
    ASSERT_EQ(impulses.size(), 200U);
    for (int k = 0; k < 50; ++k) {
        double borne = 0;
        for (std::size_t i = 0; i < 4; ++i)
            borne += static_cast<double>(impulses[static_cast<std::size_t>(4 * k) + i].normal);
        EXPECT_NEAR(borne / static_cast<double>(dt), (50 - k) * g, 2e-4 * (50 - k) * g) << "joint " << k;
    }
}

TEST(ExactContacts, TenBoxesBearATonne)
{
    Masonry boxes = tower(10, 1000);
    Solver solver(exact());
    for (int step = 0; step < testing::long_run(600); ++step) boxes.step(solver);
    EXPECT_LT(boxes.farthest(), 1e-3);  // asked: 5e-3
}

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
        Solver solver(exact());
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
        Solver solver(exact({0, 0, 0}));
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
        Solver solver(exact({0, 0, 0}));
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

/// A stack on a slope of 30 degrees: tan 30 is 0.577.
TEST(ExactContacts, AStackHoldsOnASlopeUpToTheAngleOfFriction)
{
    const double angle = std::acos(-1.0) / 6;
    const Vec3<float> down{static_cast<float>(g * std::sin(angle)), static_cast<float>(-g * std::cos(angle)),
                           0};
    for (const float friction : {0.6F, 0.5F}) {
        Masonry slabs;
        slabs.friction = friction;
        for (int i = 0; i < 5; ++i) {
            const BodyId slab = slabs.add({0, 0.1 + 0.2 * i, 0}, {0.5, 0.1, 0.5}, 20);
            slabs.lay(i == 0 ? slabs.scene.ground() : slabs.blocks[static_cast<std::size_t>(i) - 1],
                      {0, i == 0 ? 0 : 0.1, 0}, slab, {0, -0.1, 0}, 0.5, 0.5);
        }
        Solver solver(exact(down));
        // Cold contacts slip for some steps, until every corner has found its share.
        for (int step = 0; step < 60; ++step) slabs.step(solver);
        std::vector<BodyState> before;
        for (const BodyId slab : slabs.blocks) before.push_back(slabs.scene.state(slab));
        EXPECT_LT(static_cast<double>(friction) > std::tan(angle) ? slabs.farthest() : 0, 5e-3);
        for (int step = 0; step < testing::long_run(300); ++step) slabs.step(solver);
        const double seconds = testing::long_run(300) * static_cast<double>(dt);
        const double pull =
            std::max(0.0, g * (std::sin(angle) - static_cast<double>(friction) * std::cos(angle)));
        for (std::size_t i = 0; i < slabs.blocks.size(); ++i) {
            const BodyState after = slabs.scene.state(slabs.blocks[i]);
            const double gained = static_cast<double>(after.linear_velocity.x - before[i].linear_velocity.x);
            EXPECT_NEAR(gained / seconds, pull, 2e-3 * pull + 1e-5) << "slab " << i << ", mu " << friction;
            EXPECT_NEAR(after.position.y, before[i].position.y, 1e-4);
            if (pull == 0) {
                EXPECT_NEAR(after.position.x, before[i].position.x, 1e-4);
            }
        }
    }
}

/// A semicircle of 15 stones, 1 m thick at a radius of 5 m: thicker than the 0.1075 radii that a line of thrust needs. It
/// stands if friction holds the stones, and not by friction of 0.2.
Masonry arch()
{
    Masonry arch;
    constexpr int stones = 15;
    constexpr double inner = 4.5, outer = 5.5, half_depth = 0.5;
    const double pi = std::acos(-1.0);
    const auto radial = [](double angle) { return Vec3<double>{std::cos(angle), std::sin(angle), 0}; };
    std::vector<Vec3<double>> centres;
    for (int i = 0; i < stones; ++i) {
        const Vec3<double> centre = 5.0 * radial(pi * (i + 0.5) / stones);
        const double volume = pi / (2 * stones) * (outer * outer - inner * inner) * 2 * half_depth;
        arch.add(centre, {0.5, 0.5, half_depth}, static_cast<float>(2000 * volume));
        centres.push_back(centre);
    }
    for (int i = 0; i <= stones; ++i) {
        const double angle = pi * i / stones;
        const Vec3<double> across{-std::sin(angle), std::cos(angle), 0};  // from stone i - 1 to stone i
        const auto at = [&](int stone) {
            return stone < 0 || stone >= stones ? Vec3<double>{} : centres[static_cast<std::size_t>(stone)];
        };
        const auto body = [&](int stone) {
            return stone < 0 || stone >= stones ? arch.scene.ground()
                                                : arch.blocks[static_cast<std::size_t>(stone)];
        };
        // The last joint is on the ground: its normal points from the ground.
        const bool last = i == stones;
        const int below = last ? stones : i - 1, above = last ? stones - 1 : i;
        Joint joint{
            body(below), body(above), last ? -1.0 * across : across, 5.0 * radial(angle) - at(below), {}};
        for (const double r : {inner, outer}) {
            for (const double z : {-half_depth, half_depth})
                joint.corners.push_back(r * radial(angle) + Vec3<double>{0, 0, z} - at(above));
        }
        arch.joints.push_back(joint);
    }
    return arch;
}

TEST(ExactContacts, AnArchStandsByFriction)
{
    Masonry stone = arch();
    Solver solver(exact());
    for (int step = 0; step < testing::long_run(300); ++step) stone.step(solver);
    EXPECT_LT(stone.farthest(), 1e-3);

    Masonry glass = arch();
    glass.friction = 0.2F;
    Solver other(exact());
    for (int step = 0; step < 120; ++step) glass.step(other);
    EXPECT_GT(glass.farthest(), 0.1);
}

/// Bricks of 1 m in courses of ten, each on two of the course below.
Masonry wall(int courses)
{
    Masonry wall;
    constexpr int bricks = 10;
    for (int i = 0; i < courses; ++i) {
        for (int j = 0; j < bricks; ++j) {
            const double x = j + (i % 2 == 0 ? 0.0 : 0.5);
            const BodyId brick = wall.add({x, 0.25 + 0.5 * i, 0}, {0.5, 0.25, 0.25}, 1);
            if (i == 0) {
                wall.lay(wall.scene.ground(), {0, 0, 0}, brick, {0, -0.25, 0}, 0.5, 0.25);
                continue;
            }
            const int left = i % 2 == 0 ? j - 1 : j;
            for (const int below : {left, left + 1}) {
                if (below < 0 || below >= bricks) continue;
                const double side = below == left ? -0.25 : 0.25;
                wall.lay(wall.blocks[static_cast<std::size_t>((i - 1) * bricks + below)], {0, 0.25, 0}, brick,
                         {side, -0.25, 0}, 0.25, 0.25);
            }
        }
    }
    return wall;
}

TEST(ExactContacts, AWallOfBricksStandsAndTheGroundBearsIt)
{
    Masonry bricks = wall(10);
    Solver solver(exact());
    for (int step = 0; step < testing::long_run(120); ++step)
        EXPECT_EQ(bricks.step(solver).exact_contact_islands, 1);
    EXPECT_LT(bricks.farthest(), 1e-3);
    double borne = 0;
    for (std::size_t i = 0; i < bricks.contacts.size(); ++i) {
        if (bricks.contacts[i].body_a == bricks.scene.ground())
            borne += static_cast<double>(bricks.scene.contact_impulses()[i].normal);
    }
    EXPECT_NEAR(borne / static_cast<double>(dt), 100 * g, 1e-4 * 100 * g);
}

/// A heap that is thrown together: what each body gains is what its contacts report, and friction stays in its cone.
TEST(ExactContacts, ReportWhatActs)
{
    Masonry boxes = tower(6);
    boxes.friction = 0.3F;
    for (std::size_t i = 0; i < boxes.blocks.size(); ++i)
        boxes.scene.set_velocity(boxes.blocks[i], {i % 2 == 0 ? 1.0F : -1.0F, -1, 0.3F}, {0, 0, 0});
    Solver solver(exact());
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
    SolverSettings settings = exact();
    for (const int substeps : {1, 3}) {
        settings.substeps = substeps;
        const auto scalar = hashes(wall(4), {.isa = Isa::scalar}, settings);
        for (const Isa isa : available_isas()) {
            for (const int threads : {1, 2, 3}) {
                EXPECT_EQ(hashes(wall(4), {.threads = threads, .alone_below = 0, .isa = isa}, settings),
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
        Solver solver(exact({0, 0, 0}), options);
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
    Masonry bricks = wall(4);
    bricks.scene.set_velocity(bricks.blocks.back(), {2, -1, 0.5F}, {0, 0, 0});
    Solver solver(exact());
    for (int step = 0; step < 6; ++step) bricks.step(solver);
    Masonry copy = bricks;
    Solver other(exact());
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
        SolverSettings settings = exact();
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
