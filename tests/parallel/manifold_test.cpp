// Manifolds: boxes and balls on planes, against closed forms. The narrow phase is a few lines here, which run before
// every step, as a host's would.
#include <functional>
#include <limits>

#include "rig.h"

namespace motley {
namespace {

using testing::frame_time;
using testing::with_gravity;

constexpr double g = 9.81;

/// A plane through the origin of the ground, tilted about z.
struct Plane {
    double angle = 0;
    [[nodiscard]] Vec3<double> normal() const { return {-std::sin(angle), std::cos(angle), 0}; }
    [[nodiscard]] Vec3<double> downhill() const { return {-std::cos(angle), -std::sin(angle), 0}; }
};

/// A body of 2 kg that touches the plane with the points that `points_of` gives.
struct Rest {
    Scene scene;
    BodyId body{};
    ConstraintId joint{};
    ManifoldDefinition contact{};
    Plane plane{};
    /// The points of the body, in its frame, that may touch the plane.
    std::function<std::vector<Vec3<float>>(const Rest&)> points_of;

    void update()
    {
        const Vec3<double> n = plane.normal();
        const BodyState state = scene.state(body);
        const std::vector<Vec3<float>> points = points_of(*this);
        contact.body_a = scene.ground();
        contact.body_b = body;
        contact.normal = convert<float>(n);
        contact.point_count = static_cast<int>(points.size());
        for (std::size_t i = 0; i < points.size(); ++i) {
            const Vec3<double> p = state.position + rotate(state.orientation, convert<double>(points[i]));
            contact.points[i] = {convert<float>(p - dot(n, p) * n), points[i]};
        }
        if (joint == ConstraintId{}) {
            joint = scene.add_joint(contact);
        } else {
            scene.set_joint(joint, contact);
        }
    }
    void run(Solver& solver, double seconds)
    {
        for (int step = 0; step < static_cast<int>(std::lround(60 * seconds)); ++step) {
            update();
            ASSERT_EQ(solver.step(scene, frame_time).status, StepStatus::done);
        }
    }
    /// Speed downhill, m/s.
    [[nodiscard]] double speed() const
    {
        return dot(convert<double>(scene.state(body).linear_velocity), plane.downhill());
    }
};

/// A box of half sizes 0.5, 0.25, 0.5, flat on the plane, `height` above it.
Rest box_on(double angle, double height = 0)
{
    Rest rest;
    rest.plane.angle = angle;
    BodyDefinition box;
    box.mass = 2;
    box.inertia = {2.0F / 12 * 1.25F, 0, 0, 2.0F / 12 * 2, 0, 2.0F / 12 * 1.25F};
    box.position = (0.25 + height) * rest.plane.normal();
    box.orientation = {0, 0, std::sin(angle / 2), std::cos(angle / 2)};
    rest.body = rest.scene.add_body(box);
    rest.points_of = [](const Rest&) {
        return std::vector<Vec3<float>>{
            {-0.5F, -0.25F, -0.5F}, {0.5F, -0.25F, -0.5F}, {0.5F, -0.25F, 0.5F}, {-0.5F, -0.25F, 0.5F}};
    };
    return rest;
}

/// A solid ball of radius 0.5 on the level plane.
Rest ball_on_plane()
{
    Rest rest;
    BodyDefinition ball;
    ball.mass = 2;
    ball.inertia = {0.2F, 0, 0, 0.2F, 0, 0.2F};
    ball.position = {0, 0.5, 0};
    rest.body = rest.scene.add_body(ball);
    rest.points_of = [](const Rest& self) {
        const Quat<double> q = self.scene.state(self.body).orientation;
        return std::vector<Vec3<float>>{convert<float>(rotate(conjugate(q), Vec3<double>{0, -0.5, 0}))};
    };
    return rest;
}

TEST(Manifold, ABoxOnASlopeOfTwentyDegreesDoesNotCreep)
{
    // tan 20 degrees is 0.36, so friction of 0.5 holds. The test runs for a minute, after one second in which the
    // softness settles.
    Rest rest = box_on(20 * 3.14159265 / 180);
    rest.contact.friction = 0.5F;
    Solver solver(with_gravity({0, -9.81F, 0}));
    rest.run(solver, 1);
    const Vec3<double> before = rest.scene.state(rest.body).position;
    rest.run(solver, 60);
    const Vec3<double> crept = rest.scene.state(rest.body).position - before;
    EXPECT_LT(std::sqrt(dot(crept, crept)), 1e-3);
    std::printf("creep in 60 s: %.2g mm\n", 1e3 * std::sqrt(dot(crept, crept)));
}

TEST(Manifold, ABoxSlidesDownASteeperSlope)
{
    const double angle = 40 * 3.14159265 / 180;
    for (const Method method : {Method::soft_step, Method::sequential_impulse, Method::direct}) {
        Rest rest = box_on(angle);
        rest.contact.friction = 0.5F;
        SolverSettings settings = with_gravity({0, -9.81F, 0});
        settings.method = method;
        if (method == Method::sequential_impulse) settings.iterations = 20;
        Solver solver(settings);
        rest.run(solver, 1);
        const double expected = g * (std::sin(angle) - 0.5 * std::cos(angle));
        EXPECT_NEAR(rest.speed(), expected, 0.01 * expected) << static_cast<int>(method);
    }
}

TEST(Manifold, ItsReportBearsTheWeight)
{
    for (const Method method : {Method::soft_step, Method::direct}) {
        Rest rest = box_on(0.3);
        rest.contact.friction = 0.8F;
        SolverSettings settings = with_gravity({0, -9.81F, 0});
        settings.method = method;
        Solver solver(settings);
        rest.run(solver, 2);
        const JointReport report = rest.scene.joint_report(rest.joint);
        EXPECT_NEAR(report.force.y, 2 * g, 0.01);
        EXPECT_NEAR(report.force.x, 0, 0.01);
        EXPECT_EQ(report.state, JointState::active);
        EXPECT_LT(report.error, 1e-3F);
    }
}

TEST(Manifold, ABoxBouncesToTheSquareOfItsRestitution)
{
    Rest rest = box_on(0, 1);
    rest.contact.restitution = 0.5F;
    Solver solver(with_gravity({0, -9.81F, 0}));
    double highest = 0;
    bool touched = false;
    for (int step = 0; step < 90; ++step) {
        rest.run(solver, 1.0 / 60);
        const BodyState state = rest.scene.state(rest.body);
        touched = touched || state.linear_velocity.y > 0;
        if (touched) highest = std::max(highest, state.position.y - 0.25);
    }
    // The impact is at an unknown time within a step of 1/60 s, which at 4.4 m/s is worth 0.07 m of fall.
    EXPECT_NEAR(highest, 0.25, 0.03);
    const Vec3<float> w = rest.scene.state(rest.body).angular_velocity;
    EXPECT_LT(std::sqrt(dot(w, w)), 1e-3F);
}

TEST(Manifold, ABallThrownWithoutSpinRollsWithFiveSeventhsOfItsSpeed)
{
    Rest rest = ball_on_plane();
    rest.contact.friction = 0.4F;
    rest.scene.set_velocity(rest.body, {3.5F, 0, 0}, {});
    Solver solver(with_gravity({0, -9.81F, 0}));
    rest.run(solver, 1);
    const BodyState state = rest.scene.state(rest.body);
    EXPECT_NEAR(state.linear_velocity.x, 2.5, 0.01);
    EXPECT_NEAR(state.angular_velocity.z, -2.5 / 0.5, 0.02);
}

TEST(Manifold, RollingFrictionSlowsARollingBallAndLetsItRest)
{
    // (m + I / r^2) dv/dt = -M / r with M = rolling_radius m g: dv/dt = -5/7 g rolling_radius / r.
    Rest rest = ball_on_plane();
    rest.contact.friction = 0.8F;
    rest.contact.rolling_radius = 0.05F;
    rest.scene.set_velocity(rest.body, {2, 0, 0}, {0, 0, -4});
    Solver solver(with_gravity({0, -9.81F, 0}));
    rest.run(solver, 1);
    const double deceleration = 5.0 / 7 * g * 0.05 / 0.5;
    EXPECT_NEAR(rest.scene.state(rest.body).linear_velocity.x, 2 - deceleration, 0.01);
    rest.run(solver, 4);
    const double at = rest.scene.state(rest.body).position.x;
    EXPECT_NEAR(at, 2 * 2 / (2 * deceleration), 0.05);
    rest.run(solver, 5);
    EXPECT_NEAR(rest.scene.state(rest.body).position.x, at, 1e-4);
}

TEST(Manifold, TorsionalFrictionStopsASpinInItsTime)
{
    // alpha = mu r_t m g / I about the normal.
    Rest rest = ball_on_plane();
    rest.contact.friction = 0.5F;
    rest.contact.torsional_radius = 0.04F;
    rest.scene.set_velocity(rest.body, {}, {0, 6, 0});
    Solver solver(with_gravity({0, -9.81F, 0}));
    rest.run(solver, 0.5);
    const double alpha = 0.5 * 0.04 * 2 * g / 0.2;
    EXPECT_NEAR(rest.scene.state(rest.body).angular_velocity.y, 6 - 0.5 * alpha, 0.02);
    rest.run(solver, 6 / alpha);
    EXPECT_LT(std::abs(rest.scene.state(rest.body).angular_velocity.y), 1e-3F);
}

TEST(Manifold, AConveyorBeltBringsABoxToItsSpeed)
{
    Rest rest = box_on(0);
    rest.contact.friction = 0.3F;
    rest.contact.surface_velocity = {1.5F, 0.7F, 0};  // the part along the normal is not used
    Solver solver(with_gravity({0, -9.81F, 0}));
    rest.run(solver, 0.25);
    EXPECT_NEAR(rest.scene.state(rest.body).linear_velocity.x, 0.3 * g * 0.25, 0.02);
    rest.run(solver, 1);
    EXPECT_NEAR(rest.scene.state(rest.body).linear_velocity.x, 1.5, 1e-3);
    EXPECT_NEAR(rest.scene.state(rest.body).position.y, 0.25, 2e-3);
}

TEST(Manifold, EveryFieldIsChecked)
{
    using M = ManifoldDefinition;
    const float nan = std::numeric_limits<float>::quiet_NaN();
    struct Case {
        const char* field;
        std::function<void(M&)> spoil;
    };
    const Case cases[] = {{"normal",
                           [](M& m) {
                               m.normal = {0, 0, 0};
                           }},
                          {"normal", [=](M& m) { m.normal.z = nan; }},
                          {"point_count", [](M& m) { m.point_count = 0; }},
                          {"point_count", [](M& m) { m.point_count = 5; }},
                          {"points[1].local_anchor_a.x", [=](M& m) { m.points[1].local_anchor_a.x = nan; }},
                          {"points[0].local_anchor_b.y", [](M& m) { m.points[0].local_anchor_b.y = 2e9F; }},
                          {"friction", [](M& m) { m.friction = -1; }},
                          {"friction", [=](M& m) { m.friction = nan; }},
                          {"restitution", [](M& m) { m.restitution = 1.5F; }},
                          {"torsional_radius", [](M& m) { m.torsional_radius = -0.1F; }},
                          {"rolling_radius", [=](M& m) { m.rolling_radius = nan; }},
                          {"surface_velocity.y", [=](M& m) { m.surface_velocity.y = nan; }}};
    for (const Case& c : cases) {
        Scene scene;
        M contact{scene.ground(), scene.add_body({})};
        contact.point_count = 2;
        c.spoil(contact);
        try {
            scene.add_joint(contact);
            ADD_FAILURE() << c.field << " was accepted";
        } catch (const InvalidInput& error) {
            EXPECT_NE(std::string(error.what()).find(c.field), std::string::npos) << error.what();
        }
        EXPECT_EQ(scene.joint_count(), 0U);
    }
    Scene scene;
    BodyDefinition particle;
    particle.model = BodyModel::particle;
    EXPECT_THROW(scene.add_joint(M{scene.ground(), scene.add_body(particle)}), InvalidInput);
}

}  // namespace
}  // namespace motley
