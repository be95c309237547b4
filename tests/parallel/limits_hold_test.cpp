// Limits, contacts and other inequalities hold any load, and gently release what starts beyond them. Independent
// evidence: the static deflection F / (m w^2) of a soft constraint's spring, which is also the deflection of a lock;
// and the speed that push_out_speed promises.
#include <functional>
#include <string>
#include <vector>

#include "rig.h"

namespace motley {
namespace {

using testing::frame_time;

constexpr float mass = 0.5F, inertia = 0.005F;  // kg and kg m2: a hand
constexpr double pi = 3.14159265358979;

/// A body that a load presses against its limit, along x or about x.
struct Pressed {
    Scene scene;
    BodyId body{};
    bool turns = false;
    bool is_contact = false;
    /// How far the body is beyond its limit, m or rad; 0 within it.
    std::function<double(const Pressed&)> beyond;

    [[nodiscard]] double inertia_along() const { return static_cast<double>(turns ? inertia : mass); }
    void press(double load)
    {
        const auto f = static_cast<float>(load);
        scene.set_force(body, turns ? Vec3<float>{} : Vec3<float>{f, 0, 0},
                        turns ? Vec3<float>{f, 0, 0} : Vec3<float>{});
    }
    /// The host's narrow phase for a wall whose face is at x = 0.
    [[nodiscard]] std::vector<Contact> contacts() const
    {
        if (!is_contact) return {};
        Contact contact;
        contact.body_a = scene.ground();
        contact.body_b = body;
        contact.normal = {-1, 0, 0};
        const auto x = static_cast<float>(scene.state(body).position.x);
        contact.separation = -x;
        contact.arm_a = {x, 0, 0};
        return {contact};
    }
    StepStatus step(Solver& solver) { return solver.step(scene, frame_time, contacts()).status; }
};

Pressed with_hand(double x, double turn)
{
    Pressed hand;
    BodyDefinition body;
    body.mass = mass;
    body.inertia = {inertia, 0, 0, inertia, 0, inertia};
    body.position = {x, 0, 0};
    body.orientation = {std::sin(turn / 2), 0, 0, std::cos(turn / 2)};
    hand.body = hand.scene.add_body(body);
    return hand;
}
double position(const Pressed& hand)
{
    return hand.scene.state(hand.body).position.x;
}
double angle(const Pressed& hand)
{
    const Quat<double> q = hand.scene.state(hand.body).orientation;
    return 2 * std::atan2(q.w < 0 ? -q.x : q.x, std::abs(q.w));
}

// Each of these scenes starts `start` beyond its limit, m or rad.

Pressed slide_limit(double start)
{
    Pressed hand = with_hand(start, 0);
    hand.scene.add_joint(
        SlideDriveDefinition{.body_a = hand.scene.ground(), .body_b = hand.body, .lower = -10, .upper = 0});
    hand.beyond = position;
    return hand;
}
Pressed slide_limit_of_six_axes(double start)
{
    Pressed hand = with_hand(start, 0);
    SixDofDefinition six;
    six.body_a = hand.scene.ground();
    six.body_b = hand.body;
    six.position[0] = AxisSetup::limited(-10, 0);
    add_six_dof(hand.scene, six);
    hand.beyond = position;
    return hand;
}
Pressed twist_limit(double start)
{
    Pressed hand = with_hand(0, start);
    hand.turns = true;
    hand.scene.add_joint(HingeDefinition{hand.scene.ground(), hand.body});
    hand.scene.add_joint(
        TwistDriveDefinition{.body_a = hand.scene.ground(), .body_b = hand.body, .lower = -1, .upper = 0});
    hand.beyond = angle;
    return hand;
}
Pressed swing_limit(double start)
{
    // The limited axis is z, which a rotation about x swings; at 0.5 rad it is at its limit.
    Pressed hand = with_hand(0, 0.5 + start);
    hand.turns = true;
    SwingLimitDefinition limit{.body_a = hand.scene.ground(), .body_b = hand.body, .max_angle = 0.5F};
    limit.frame_a.rotation = limit.frame_b.rotation = testing::axis_along(2);
    hand.scene.add_joint(limit);
    hand.beyond = [](const Pressed& self) { return angle(self) - 0.5; };
    return hand;
}
Pressed rope(double start)
{
    Pressed hand = with_hand(2 + start, 0);
    DistanceDefinition tether{hand.scene.ground(), hand.body};
    tether.min_length = 0;
    tether.max_length = 2;
    hand.scene.add_joint(tether);
    hand.beyond = [](const Pressed& self) { return position(self) - 2; };
    return hand;
}
Pressed pulley(double start)
{
    // The rope's other end is on the ground, a metre from its wheel.
    Pressed hand = with_hand(2 + start, 0);
    PulleyDefinition over{hand.scene.ground(), hand.body};
    over.point_a = {0, 1, 0};
    over.point_b = {0, 0, 0};
    over.max_length = 3;
    hand.scene.add_joint(over);
    hand.beyond = [](const Pressed& self) { return position(self) - 2; };
    return hand;
}
Pressed contact(double start)
{
    Pressed hand = with_hand(start, 0);
    hand.is_contact = true;
    hand.beyond = position;
    return hand;
}
Pressed manifold(double start)
{
    Pressed hand = with_hand(start, 0);
    ManifoldDefinition wall{hand.scene.ground(), hand.body};
    wall.normal = {-1, 0, 0};
    wall.point_count = 1;
    hand.scene.add_joint(wall);
    hand.beyond = position;
    return hand;
}

struct Bound {
    std::string name;
    Pressed (*make)(double start);
};
std::vector<Bound> every_bound()
{
    return {{"slide limit", slide_limit},
            {"slide limit of six axes", slide_limit_of_six_axes},
            {"twist limit", twist_limit},
            {"swing limit", swing_limit},
            {"rope", rope},
            {"pulley", pulley},
            {"contact", contact},
            {"manifold", manifold}};
}

struct Way {
    std::string name;
    SolverSettings settings;
};
std::vector<Way> every_way()
{
    std::vector<Way> ways(6);
    ways[0].name = "soft step";
    ways[1].name = "soft step without relaxation";
    ways[1].settings.relaxations = 0;
    ways[2].name = "soft step from cold";
    ways[2].settings.warm_start = false;
    const char* names[] = {"no correction", "baumgarte", "projection"};
    for (std::size_t i = 0; i < 3; ++i) {
        SolverSettings& settings = ways[3 + i].settings;
        ways[3 + i].name = names[i];
        settings.method = Method::sequential_impulse;
        settings.iterations = 8;
        settings.drift_correction = static_cast<DriftCorrection>(i);
    }
    return ways;
}

/// How far beyond its limit a hand is after two seconds of a load, if it starts at the limit.
double deflection(const Bound& bound, const SolverSettings& settings, double load)
{
    Pressed hand = bound.make(0);
    hand.press(load);
    Solver solver(settings);
    for (int step = 0; step < 120; ++step) EXPECT_EQ(hand.step(solver), StepStatus::done);
    return hand.beyond(hand);
}

TEST(Limits, GiveWayAsALockDoesUnderLoadsAMillionTimesApart)
{
    // Static deflection F / (m w^2), with w of the 60 Hz of joints and of static contacts, which is also the largest
    // frequency that a substep of 1/240 s allows. The largest load turns a hand by 0.28 rad, and moves it by 0.28 m.
    const double w = 2 * pi * 60;
    for (const Way& way : every_way()) {
        if (way.settings.method != Method::soft_step) continue;
        for (const Bound& bound : every_bound()) {
            const double inertia_along = bound.make(0).inertia_along();
            double last = 0;
            for (double share = 2.8e-7; share < 0.5; share *= testing::is_sanitized ? 1e6 : 10) {
                const double load = share * inertia_along * w * w,
                             got = deflection(bound, way.settings, load);
                // Bound: 2 %, and the rounding of float positions of about a metre.
                EXPECT_NEAR(got, share, 0.02 * share + 2e-7) << way.name << ", " << bound.name;
                EXPECT_GT(got, last) << way.name << ", " << bound.name;
                last = got;
            }
        }
    }
}

TEST(Limits, OfRigidSweepsGiveNoWayUnderLoadsAMillionTimesApart)
{
    for (const Way& way : every_way()) {
        if (way.settings.method != Method::sequential_impulse) continue;
        for (const Bound& bound : every_bound()) {
            for (double load = 0.02; load < 5e4; load *= testing::is_sanitized ? 1e6 : 10) {
                const bool turns = bound.make(0).turns;
                // Bound: penetration_slop, which is not corrected, and rounding.
                EXPECT_NEAR(deflection(bound, way.settings, turns ? load / 100 : load), 0, 6e-4)
                    << way.name << ", " << bound.name << ", load " << load;
            }
        }
    }
}

TEST(Limits, LetGoOfWhatStartsARadianOrAMetreBeyondNoFasterThanPushedOut)
{
    for (const Way& way : every_way()) {
        for (const Bound& bound : every_bound()) {
            Pressed hand = bound.make(1);
            Solver solver(way.settings);
            double fastest = 0;
            for (int step = 0; step < 120; ++step) {
                ASSERT_EQ(hand.step(solver), StepStatus::done);
                const BodyState state = hand.scene.state(hand.body);
                const Vec3<float>&v = state.linear_velocity, &spin = state.angular_velocity;
                fastest = std::max(fastest, static_cast<double>(std::sqrt(dot(v, v) + dot(spin, spin))));
            }
            const auto most = static_cast<double>(way.settings.push_out_speed);
            EXPECT_LT(fastest, 1.01 * most) << way.name << ", " << bound.name;
            if (way.settings.drift_correction != DriftCorrection::none) {
                EXPECT_LT(hand.beyond(hand), 0.02) << way.name << ", " << bound.name;
            }
        }
    }
}

TEST(Limits, OfAChainOfHingesThatStartARadianBeyondMakeNoMoreEnergyThanTheirSpeed)
{
    // Five links in a row; each joint starts a radian beyond its limit and is pushed out at 3 rad/s at most. So the
    // tip turns at most at 15 rad/s and moves at most at 3 x (1 + 3 + 5 + 7 + 9) / 2 links of 0.4 m.
    for (const Way& way : every_way()) {
        Scene scene;
        std::vector<BodyId> links;
        double angle = 0;
        Vec3<double> end{};
        for (int i = 0; i < 5; ++i) {
            if (i > 0) angle += 1;
            const Vec3<double> along{std::cos(angle), std::sin(angle), 0};
            BodyDefinition body;
            body.mass = mass;
            body.inertia = {inertia, 0, 0, inertia, 0, inertia};
            body.position = end + 0.2 * along;
            body.orientation = {0, 0, std::sin(angle / 2), std::cos(angle / 2)};
            end = end + 0.4 * along;
            links.push_back(scene.add_body(body));
            if (i == 0) continue;
            HingeDefinition hinge{links[links.size() - 2], links.back()};
            hinge.frame_a = {{0.2F, 0, 0}, testing::axis_along(2)};
            hinge.frame_b = {{-0.2F, 0, 0}, testing::axis_along(2)};
            scene.add_joint(hinge);
            scene.add_joint(TwistDriveDefinition{.body_a = hinge.body_a,
                                                 .body_b = hinge.body_b,
                                                 .frame_a = hinge.frame_a,
                                                 .frame_b = hinge.frame_b,
                                                 .lower = -1,
                                                 .upper = 0});
        }
        Solver solver(way.settings);
        double highest = 0;
        for (int step = 0; step < 240; ++step) {
            ASSERT_EQ(solver.step(scene, frame_time).status, StepStatus::done);
            highest = std::max(highest, scene.errors().kinetic_energy);
        }
        double most = 0;
        const auto speed = static_cast<double>(way.settings.push_out_speed);
        for (int i = 0; i < 5; ++i) {
            const double spin = speed * i, v = speed * 0.2 * i * i;
            most += 0.5 * (static_cast<double>(mass) * v * v + static_cast<double>(inertia) * spin * spin);
        }
        std::printf("%s: %.3g J of at most %.3g J\n", way.name.c_str(), highest, most);
        EXPECT_LT(highest, most) << way.name;
    }
}

}  // namespace
}  // namespace motley
