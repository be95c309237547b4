// What every method must get right: motions with known solutions, and conservation laws. Independent evidence: closed
// forms, stated at each test.
#include <gtest/gtest.h>

#include <cmath>

#include "mixed_scene.h"

namespace motley {
namespace {

constexpr double pi = 3.14159265358979;

SolverSettings soft(Vec3<float> gravity = {})
{
    SolverSettings settings;
    settings.gravity = gravity;
    return settings;
}

SolverSettings iterative(Vec3<float> gravity = {}, DriftCorrection correction = DriftCorrection::baumgarte)
{
    SolverSettings settings = soft(gravity);
    settings.method = Method::sequential_impulse;
    settings.drift_correction = correction;
    settings.iterations = 10;
    return settings;
}

BodyDefinition ball(BodyModel model, Vec3<double> position, float mass = 1, float radius = 0.5F)
{
    BodyDefinition body;
    body.model = model;
    body.position = position;
    body.mass = mass;
    const float i = 0.4F * mass * radius * radius;
    body.inertia = {i, 0, 0, i, 0, i};
    return body;
}

/// The contact of a ball with the static plane y = 0, which belongs to the ground at the origin.
Contact on_floor(const Scene& scene, BodyId body, double radius, std::uint64_t key = 1)
{
    const Vec3<double> p = scene.state(body).position;
    Contact contact;
    contact.body_a = scene.ground();
    contact.body_b = body;
    contact.key = key;
    contact.normal = {0, 1, 0};
    contact.separation = static_cast<float>(p.y - radius);
    contact.arm_a = {static_cast<float>(p.x), 0, static_cast<float>(p.z)};
    contact.arm_b = {0, -static_cast<float>(p.y), 0};
    return contact;
}

TEST(Pendulum, PeriodMatchesClosedFormWithinOnePercent)
{
    // Small swings of a point mass on a rod: T = 2 pi sqrt(L / g), and 1 + theta^2/16 for amplitude theta.
    Scene scene;
    const double length = 2, amplitude = 0.2;
    const BodyId bob = scene.add_body(
        ball(BodyModel::particle, {length * std::sin(amplitude), -length * std::cos(amplitude), 0}));
    DistanceDefinition rod;
    rod.body_a = scene.ground();
    rod.body_b = bob;
    rod.min_length = rod.max_length = static_cast<float>(length);
    scene.add_joint(rod);
    SolverSettings settings = soft({0, -9.81F, 0});
    settings.substeps = 16;
    Solver solver(settings);
    int crossings = 0;
    double first = 0, last = 0, before = scene.state(bob).position.x;
    for (int step = 0; step < 60 * 20; ++step) {
        solver.step(scene, 1.0F / 60);
        const double x = scene.state(bob).position.x;
        if (before > 0 && x <= 0) {
            const double t = (step + before / (before - x)) / 60;
            if (crossings++ == 0) first = t;
            last = t;
        }
        before = x;
    }
    ASSERT_GT(crossings, 3);
    const double exact = 2 * pi * std::sqrt(length / 9.81) * (1 + amplitude * amplitude / 16);
    EXPECT_NEAR((last - first) / (crossings - 1), exact, 0.01 * exact);
}

TEST(Spring, FrequencyAndDecayMatchClosedForm)
{
    // x'' + 2 zeta w x' + w^2 x = 0: zero crossings every pi / (w sqrt(1 - zeta^2)), peaks that fall by exp(-zeta w
    // t). The implicit spring adds damping of order w h, so h is small.
    Scene scene;
    const float hertz = 1, zeta = 0.05F;
    const BodyId bob = scene.add_body(ball(BodyModel::particle, {1.2, 0, 0}, 3));
    DistanceDefinition spring;
    spring.body_a = scene.ground();
    spring.body_b = bob;
    spring.min_length = 0;
    spring.max_length = std::numeric_limits<float>::infinity();
    spring.rest_length = 1;
    spring.spring_hertz = hertz;
    spring.spring_damping_ratio = zeta;
    scene.add_joint(spring);
    SolverSettings settings = soft();
    settings.substeps = 32;
    Solver solver(settings);
    double peak = 0, start_peak = 0, before = 0.2;
    int crossings = 0;
    double first = 0, last = 0;
    for (int step = 0; step < 300; ++step) {
        solver.step(scene, 1.0F / 60);
        const double x = scene.state(bob).position.x - 1;
        if (before > 0 && x <= 0) {
            const double t = (step + before / (before - x)) / 60;
            if (crossings++ == 0) first = t;
            last = t;
        }
        if (step < 90 && step > 30) start_peak = std::max(start_peak, x);  // the peak near t = 1 s
        if (step > 210 && step < 270) peak = std::max(peak, x);            // the peak near t = 4 s
        before = x;
    }
    const double w = 2 * pi * static_cast<double>(hertz);
    const double period = 2 * pi / (w * std::sqrt(1 - 0.05 * 0.05));
    EXPECT_NEAR((last - first) / (crossings - 1), period, 0.01 * period);
    EXPECT_NEAR(peak / start_peak, std::exp(-0.05 * w * 3), 0.08 * std::exp(-0.05 * w * 3));
}

TEST(Friction, ABoxOnASlopeOfTwentyDegreesStaysForAMinute)
{
    // tan 20 degrees = 0.36 < mu = 0.5: it must not creep. Gravity is tilted instead of the ground.
    Scene scene;
    const double hx = 0.5, hy = 0.25, hz = 0.5;
    BodyDefinition box;
    box.mass = 10;
    box.position = {0, hy, 0};
    const auto moment = [&](double u, double v) { return static_cast<float>(10.0 / 3 * (u * u + v * v)); };
    box.inertia = {moment(hy, hz), 0, 0, moment(hx, hz), 0, moment(hx, hy)};
    const BodyId body = scene.add_body(box);
    const double slope = 20 * pi / 180;
    Solver solver(
        soft({static_cast<float>(9.81 * std::sin(slope)), static_cast<float>(-9.81 * std::cos(slope)), 0}));
    std::vector<Contact> corners;
    for (int step = 0; step < 60 * 60; ++step) {
        corners.clear();
        const BodyState s = scene.state(body);
        for (int corner = 0; corner < 4; ++corner) {
            const Vec3<double> arm =
                rotate(s.orientation, Vec3<double>{corner % 2 == 0 ? hx : -hx, -hy, corner < 2 ? hz : -hz});
            const Vec3<double> point = s.position + arm;
            Contact contact;
            contact.body_a = scene.ground();
            contact.body_b = body;
            contact.key = static_cast<std::uint64_t>(corner);
            contact.normal = {0, 1, 0};
            contact.separation = static_cast<float>(point.y);
            contact.arm_a = {static_cast<float>(point.x), 0, static_cast<float>(point.z)};
            contact.arm_b = convert<float>(Vec3<double>{arm.x, arm.y - point.y, arm.z});
            contact.friction = 0.5F;
            corners.push_back(contact);
        }
        ASSERT_EQ(solver.step(scene, 1.0F / 60, corners).status, StepStatus::done);
    }
    const Vec3<double> p = scene.state(body).position;
    EXPECT_LT(std::hypot(p.x, p.z), 1e-3);
}

TEST(Rope, SlackHasNoForceAndTautHoldsTheWeight)
{
    Scene scene;
    const BodyId bob = scene.add_body(ball(BodyModel::rigid, {0, -0.5, 0}, 2));
    DistanceDefinition rope;
    rope.body_a = scene.ground();
    rope.body_b = bob;
    rope.min_length = 0;
    rope.max_length = 1;
    const ConstraintId joint = scene.add_joint(rope);
    Solver solver(soft({0, -10, 0}));
    solver.step(scene, 1.0F / 60);
    EXPECT_EQ(scene.joint_report(joint).force.y, 0);
    for (int step = 0; step < 300; ++step) solver.step(scene, 1.0F / 60);
    EXPECT_NEAR(scene.joint_report(joint).force.y, 20, 0.2);
    EXPECT_NEAR(scene.state(bob).position.y, -1, 1e-3);
}

TEST(Contact, AStandingBallIsHeldByItsWeight)
{
    for (const BodyModel model : {BodyModel::particle, BodyModel::planar, BodyModel::rigid}) {
        for (const Method method : {Method::soft_step, Method::sequential_impulse}) {
            Scene scene;
            const BodyId body = scene.add_body(ball(model, {0, 0.5, 0}, 4));
            SolverSettings settings =
                method == Method::soft_step ? soft({0, -10, 0}) : iterative({0, -10, 0});
            Solver solver(settings);
            Contact contact;
            for (int step = 0; step < 120; ++step) {
                contact = on_floor(scene, body, 0.5);
                solver.step(scene, 1.0F / 60, {&contact, 1});
            }
            EXPECT_NEAR(scene.contact_impulses()[0].normal / scene.last_step(), 40, 0.4);
            const JointReport report = scene.contact_report({&contact, 1}, 0);
            EXPECT_NEAR(dot(report.force, contact.normal), 40, 0.4);
            EXPECT_EQ(report.state, JointState::active);
            EXPECT_LT(report.error, 1e-3F);
            EXPECT_THROW((void)scene.contact_report({&contact, 1}, 1), InvalidInput);
            // At rest soft contacts sag by about g / omega^2; contacts with a gap have only rounding errors.
            EXPECT_NEAR(scene.state(body).position.y, 0.5, 1e-3);
            EXPECT_NEAR(scene.state(body).linear_velocity.y, 0, 1e-3);
        }
    }
}

TEST(Contact, SagsLessTheShorterTheSubstep)
{
    // Closed form: nothing penetrates a rigid floor. By default only the length of a substep makes a contact soft.
    double before = 0;
    for (const int substeps : {1, 4, 16, 64}) {
        Scene scene;
        const BodyId body = scene.add_body(ball(BodyModel::rigid, {0, 0.5, 0}, 4));
        SolverSettings settings = soft({0, -10, 0});
        settings.substeps = substeps;
        Solver solver(settings);
        for (int step = 0; step < 120; ++step) {
            const Contact contact = on_floor(scene, body, 0.5);
            solver.step(scene, 1.0F / 60, {&contact, 1});
        }
        const double sag = 0.5 - scene.state(body).position.y;
        EXPECT_GE(sag, 0);
        if (substeps > 1) {
            EXPECT_LT(sag, before / 8) << substeps;
        }
        before = sag;
    }
}

TEST(Contact, HeadOnImpactLeavesWithRestitution)
{
    // Newton's law of impact: v' = -e v, the normal impulse (1 + e) m v.
    for (const float e : {0.0F, 0.5F, 1.0F}) {
        Scene scene;
        BodyDefinition definition = ball(BodyModel::rigid, {0, 0.6, 0}, 2);
        definition.linear_velocity.y = -4;
        const BodyId body = scene.add_body(definition);
        Solver solver(soft());
        for (int step = 0; step < 4; ++step) {
            Contact contact = on_floor(scene, body, 0.5);
            contact.restitution = e;
            solver.step(scene, 1.0F / 60, {&contact, 1});
        }
        EXPECT_NEAR(scene.state(body).linear_velocity.y, 4 * e, 0.01) << "e = " << e;
    }
}

TEST(Contact, ABallThatBouncesKeepsItsEnergy)
{
    // Energy: a ball that falls at v rises at e v, whatever accelerates it, and at whatever time in a step it lands.
    for (const BodyModel model : {BodyModel::particle, BodyModel::planar, BodyModel::rigid}) {
        for (const bool by_gravity : {true, false}) {
            for (const float e : {1.0F, 0.9F}) {
                Scene scene;
                const BodyId body = scene.add_body(ball(model, {0, 1.5, 0}, 2));
                if (!by_gravity) scene.set_force(body, {0, -20, 0}, {});
                SolverSettings settings = soft(by_gravity ? Vec3<float>{0, -10, 0} : Vec3<float>{});
                settings.restitution_threshold = 0.1F;
                Solver solver(settings);
                double expected = std::sqrt(20.0);  // m/s, from 1 m
                bool fell = true;
                for (int step = 0, bounces = 0; bounces < 10; ++step) {
                    ASSERT_LT(step, 2000);
                    Contact contact = on_floor(scene, body, 0.5);
                    contact.restitution = e;
                    solver.step(scene, 1.0F / 60, {&contact, 1});
                    const BodyState state = scene.state(body);
                    const auto speed = static_cast<double>(state.linear_velocity.y);
                    const bool falls = speed < 0;
                    if (!fell && falls) {
                        ++bounces;
                        expected *= static_cast<double>(e);
                        // The speed converted to that at the floor's height.
                        EXPECT_NEAR(std::sqrt(speed * speed + 20 * (state.position.y - 0.5)), expected,
                                    1e-3 * expected)
                            << "bounce " << bounces << ", e = " << e;
                    }
                    fell = falls;
                }
            }
        }
    }
}

TEST(Friction, ASlidingBlockStopsWhereItsEnergyIsSpent)
{
    // v^2 / (2 mu g); a particle cannot roll.
    Scene scene;
    BodyDefinition definition = ball(BodyModel::particle, {0, 0.5, 0});
    definition.linear_velocity = {2, 0, 1};
    const BodyId body = scene.add_body(definition);
    Solver solver(soft({0, -10, 0}));
    const float mu = 0.3F;
    for (int step = 0; step < 120; ++step) {
        Contact contact = on_floor(scene, body, 0.5);
        contact.friction = mu;
        solver.step(scene, 1.0F / 60, {&contact, 1});
        const ContactImpulse impulse = scene.contact_impulses()[0];
        EXPECT_LE(std::sqrt(dot(impulse.friction, impulse.friction)), mu * impulse.normal * 1.0001F + 1e-7F)
            << step;
    }
    const BodyState end = scene.state(body);
    const double stop = 5.0 / (2 * 0.3 * 10);
    EXPECT_NEAR(std::hypot(end.position.x, end.position.z), stop, 0.01 * stop);
    EXPECT_NEAR(end.position.x / end.position.z, 2, 0.01);  // friction does not bend the path
    EXPECT_NEAR(std::hypot(end.linear_velocity.x, end.linear_velocity.z), 0, 1e-3);
}

TEST(Friction, ARollingBallKeepsFiveSeventhsOfItsSpeed)
{
    // A ball that slides without spin ends rolling at 5/7 of its speed, whatever mu: angular momentum about the point
    // of contact is conserved. The same holds for a planar disc, which here also has I = 2/5 m r^2.
    for (const BodyModel model : {BodyModel::planar, BodyModel::rigid}) {
        Scene scene;
        BodyDefinition definition = ball(model, {0, 0.5, 0});
        definition.linear_velocity = {3.5F, 0, 0};
        const BodyId body = scene.add_body(definition);
        Solver solver(soft({0, -10, 0}));
        for (int step = 0; step < 90; ++step) {
            Contact contact = on_floor(scene, body, 0.5);
            contact.friction = 0.4F;
            solver.step(scene, 1.0F / 60, {&contact, 1});
        }
        EXPECT_NEAR(scene.state(body).linear_velocity.x, 2.5, 0.01);
        EXPECT_NEAR(scene.state(body).angular_velocity.z, -5, 0.02);
    }
}

TEST(Conservation, ATumblingBodyNeverGainsEnergy)
{
    // Dzhanibekov effect: a spin about the intermediate axis keeps flipping. The rotation update, which keeps angular
    // momentum, must not add energy.
    Scene scene;
    BodyDefinition body = ball(BodyModel::rigid, {});
    body.inertia = {1, 0, 0, 2, 0, 2.9F};
    body.angular_velocity = {0.01F, 5, 0};
    scene.add_body(body);
    const double start = scene.errors().kinetic_energy;
    Solver solver(soft());
    double most = 0;
    for (int step = 0; step < 600; ++step) {
        solver.step(scene, 1.0F / 60);
        most = std::max(most, scene.errors().kinetic_energy);
    }
    EXPECT_LT(most, start * 1.001);
}

TEST(Chain, APushedRowCarriesEachDriveToTheWall)
{
    // Exact law: when each of n discs is pushed by F towards a wall, contact k from the back carries k F.
    constexpr int n = 30;
    constexpr double radius = 0.2;
    Scene scene;
    std::vector<BodyId> discs;
    for (int i = 0; i < n; ++i) {
        BodyDefinition disc =
            ball(BodyModel::planar, {radius * (2 * i + 1), 0, 0}, 80, static_cast<float>(radius));
        discs.push_back(scene.add_body(disc));
        scene.set_force(discs.back(), {-50, 0, 0}, {});
    }
    SolverSettings settings = soft();
    settings.substeps = 8;
    Solver solver(settings);
    std::vector<Contact> contacts(n);
    for (int step = 0; step < 600; ++step) {
        for (int i = 0; i < n; ++i) {
            Contact& c = contacts[static_cast<std::size_t>(i)];
            const double x = scene.state(discs[static_cast<std::size_t>(i)]).position.x;
            const double front =
                i == 0 ? 0 : scene.state(discs[static_cast<std::size_t>(i - 1)]).position.x + radius;
            c.body_a = i == 0 ? scene.ground() : discs[static_cast<std::size_t>(i - 1)];
            c.body_b = discs[static_cast<std::size_t>(i)];
            c.key = static_cast<std::uint64_t>(i);
            c.normal = {1, 0, 0};
            c.separation = static_cast<float>(x - radius - front);
            c.arm_a = {i == 0 ? 0.0F : static_cast<float>(radius), 0, 0};
            c.arm_b = {-static_cast<float>(radius), 0, 0};
        }
        ASSERT_EQ(solver.step(scene, 1.0F / 60, contacts).status, StepStatus::done);
    }
    for (int i = 0; i < n; ++i) {
        const double force =
            static_cast<double>(scene.contact_impulses()[static_cast<std::size_t>(i)].normal) /
            static_cast<double>(scene.last_step());
        EXPECT_NEAR(force, 50.0 * (n - i), 0.01 * 50 * n) << "contact " << i;
        EXPECT_GT(contacts[static_cast<std::size_t>(i)].separation, -0.01 * radius);
    }
}

TEST(Joint, HoldsTenKilometresFromTheOriginAsItDoesAtTheOrigin)
{
    // Lanes only see differences of positions, so that distance from the origin costs only the rounding of doubles.
    double error[2];
    for (const int far : {0, 1}) {
        Scene scene;
        BodyId before{};
        for (int i = 0; i < 10; ++i) {
            BodyDefinition link = ball(BodyModel::rigid, {far * 1e4 + 0.5 * i, 0, 0}, 1, 0.2F);
            if (i == 0) link.motion = BodyMotion::static_body;
            const BodyId id = scene.add_body(link);
            if (i > 0) scene.add_joint(BallSocketDefinition{before, id, {0.25F, 0, 0}, {-0.25F, 0, 0}});
            before = id;
        }
        Solver solver(soft({0, -9.81F, 0}));
        for (int step = 0; step < 120; ++step) solver.step(scene, 1.0F / 60);
        error[far] = scene.errors().joint_separation_max;
    }
    EXPECT_LT(error[1], 2 * error[0] + 1e-6);
}

TEST(Hub, AThousandRopesOnOneBodyAreSolvedInAFewColours)
{
    Scene scene;
    const BodyId hub = scene.add_body(ball(BodyModel::rigid, {}, 100));
    for (int i = 0; i < 1000; ++i) {
        const double a = i * 0.01;
        const BodyId spoke = scene.add_body(ball(BodyModel::particle, {std::cos(a), std::sin(a), 0}));
        DistanceDefinition rod;
        rod.body_a = hub;
        rod.body_b = spoke;
        scene.add_joint(rod);
    }
    Solver solver(soft());
    StepReport report;
    for (int step = 0; step < 10; ++step) report = solver.step(scene, 1.0F / 60);
    EXPECT_LE(report.colours, 30);
    EXPECT_EQ(report.joints, 1000);
    EXPECT_EQ(report.overflow, 1000 - 30);
    EXPECT_LT(scene.errors().joint_separation_max, 1e-3);
}

TEST(Containment, ABodyThatOverflowsIsFrozenNamedAndLeavesOthersAlone)
{
    // Two islands; in one of them a force drives a body beyond the range of floats.
    const auto build = [](bool hostile, std::vector<BodyId>& ids) {
        Scene scene;
        for (int i = 0; i < 4; ++i) ids.push_back(scene.add_body(ball(BodyModel::rigid, {3.0 * i, 0, 0})));
        scene.add_joint(BallSocketDefinition{ids[0], ids[1], {1.5F, 0, 0}, {-1.5F, 0, 0}});
        scene.add_joint(BallSocketDefinition{ids[2], ids[3], {1.5F, 0, 0}, {-1.5F, 0, 0}});
        if (hostile) scene.set_force(ids[0], {3e38F, 3e38F, 0}, {0, 0, 3e38F});
        return scene;
    };
    std::vector<BodyId> ids, calm_ids;
    Scene scene = build(true, ids), calm = build(false, calm_ids);
    Solver solver(soft({0, -10, 0}));
    std::int64_t contained = 0;
    BodyId named{};
    for (int step = 0; step < 60; ++step) {
        const StepReport report = solver.step(scene, 1.0F / 60);
        contained += report.bodies_contained;
        if (report.bodies_contained > 0 && named == BodyId{}) named = report.first_contained;
        solver.step(calm, 1.0F / 60);
    }
    EXPECT_GE(contained, 1);
    EXPECT_TRUE(scene.is_contained(named));
    for (const std::size_t i : {2, 3}) {
        EXPECT_EQ(scene.state(ids[i]).position.y, calm.state(calm_ids[i]).position.y);
        EXPECT_EQ(scene.state(ids[i]).linear_velocity.y, calm.state(calm_ids[i]).linear_velocity.y);
    }
    for (const BodyId id : ids) EXPECT_TRUE(std::isfinite(scene.state(id).position.x));
    scene.set_force(named, {}, {});
    scene.revive(named, {0, 5, 0}, {});
    const double y = scene.state(named).position.y;
    solver.step(scene, 1.0F / 60);
    EXPECT_LT(scene.state(named).position.y, y);
}

TEST(Step, OfZeroSecondsChangesNothing)
{
    testing::MixedScene mixed;
    Solver solver(soft({0, -10, 0}));
    solver.step(mixed.scene, 1.0F / 60, mixed.contacts());
    const std::uint64_t hash = mixed.scene.state_hash();
    EXPECT_EQ(solver.step(mixed.scene, 0, mixed.contacts()).status, StepStatus::done);
    EXPECT_EQ(mixed.scene.state_hash(), hash);
}

TEST(Step, BodiesAndJointsComeAndGoWithoutDisturbingTheRest)
{
    // A row of falling pairs. Each step removes and adds some, but never the first pair, which must fall as if alone.
    Scene scene, alone;
    const auto pair = [](Scene& s, double x) {
        const BodyId a = s.add_body(ball(BodyModel::rigid, {x, 0, 0})),
                     b = s.add_body(ball(BodyModel::rigid, {x, -1, 0}));
        s.add_joint(BallSocketDefinition{a, b, {0, -0.5F, 0}, {0, 0.5F, 0}});
        return std::pair{a, b};
    };
    const auto kept = pair(scene, 0), same = pair(alone, 0);
    scene.set_velocity(kept.first, {1, 0, 2}, {0, 1, 0});
    alone.set_velocity(same.first, {1, 0, 2}, {0, 1, 0});
    std::vector<std::pair<BodyId, BodyId>> others;
    Solver solver(soft({0, -10, 0})), lone(soft({0, -10, 0}));
    testing::Random random;
    for (int step = 0; step < 200; ++step) {
        others.push_back(pair(scene, 5.0 * (1 + random.below(100))));
        if (others.size() > 10) {
            const auto gone = others.begin() + random.below(static_cast<int>(others.size()));
            scene.remove_body(gone->first);
            EXPECT_FALSE(scene.is_alive(gone->first));
            scene.remove_body(gone->second);
            others.erase(gone);
        }
        ASSERT_EQ(solver.step(scene, 1.0F / 60).status, StepStatus::done);
        lone.step(alone, 1.0F / 60);
        ASSERT_EQ(scene.state(kept.second).position.y, alone.state(same.second).position.y) << step;
        ASSERT_EQ(scene.joint_count(), others.size() + 1);
        ASSERT_EQ(scene.body_count(), 2 * others.size() + 2);
    }
}

}  // namespace
}  // namespace motley
