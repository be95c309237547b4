// Bodies that change their model in place. Independent evidence: momenta computed here from the states and tensors, in
// double; closed forms; bodies that were added with the new model, bit for bit; and scenes that were read back from bytes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "disc_crowd.h"
#include "every_way.h"
#include "motley/motley.h"
#include "rig.h"
#include "scene/scene_core.h"

namespace motley {
namespace {

using testing::MixedScene;

constexpr float dt = 1.0F / 60;
constexpr BodyModel models[] = {BodyModel::particle, BodyModel::planar, BodyModel::rigid};
constexpr Sym3<float> long_body{4.5F, 0.3F, -0.2F, 4, 0.1F, 0.9F};  // kg m2
constexpr Sym3<float> round_body{2, 0, 0, 2, 0, 1.6F};

Quat<double> turned(const Vec3<double>& axis, double angle)
{
    const double s = std::sin(angle / 2) / std::sqrt(dot(axis, axis));
    return {s * axis.x, s * axis.y, s * axis.z, std::cos(angle / 2)};
}

double length(const Vec3<double>& v)
{
    return std::sqrt(dot(v, v));
}

/// The angular momentum about the centre of mass, kg m2/s, world, of a body with this inertia in its own frame.
Vec3<double> spin_of(const Scene& scene, BodyId body, const Sym3<float>& inertia)
{
    const BodyState state = scene.state(body);
    const Vec3<double> w = convert<double>(state.angular_velocity);
    if (scene.model(body) == BodyModel::particle) return {};
    if (scene.model(body) == BodyModel::planar) return {0, 0, static_cast<double>(inertia.zz) * w.z};
    const Sym3<double> tensor{inertia.xx, inertia.xy, inertia.xz, inertia.yy, inertia.yz, inertia.zz};
    return rotate(state.orientation, tensor * rotate(conjugate(state.orientation), w));
}

/// A body of this model that moves and turns in every way that the model has.
BodyDefinition moving(BodyModel model)
{
    BodyDefinition body;
    body.model = model;
    body.position = {1, 2, 3};
    body.mass = 70;
    body.inertia = long_body;
    body.yaw = 19.25;  // three turns and a little
    body.orientation = turned({1, 2, 3}, 1.1);
    body.linear_velocity = {1.5F, -0.7F, model == BodyModel::planar ? 0 : 0.3F};
    if (model == BodyModel::rigid) body.angular_velocity = {0.4F, -0.9F, 1.7F};
    if (model == BodyModel::planar) body.angular_velocity = {0, 0, 1.7F};
    return body;
}

TEST(ChangeBody, KeepsTheMomentaThatTheNewModelHas)
{
    for (const BodyModel from : models) {
        for (const BodyModel to : models) {
            Scene scene;
            const BodyId body = scene.add_body(moving(from));
            const BodyState before = scene.state(body);
            const Vec3<double> spin = spin_of(scene, body, long_body);
            scene.change_body(body, {to, round_body});
            ASSERT_TRUE(scene.is_alive(body));
            ASSERT_EQ(scene.model(body), to);
            EXPECT_EQ(scene.motion(body), BodyMotion::dynamic_body);
            const BodyState after = scene.state(body);
            EXPECT_EQ(after.position.x, before.position.x);
            EXPECT_EQ(after.position.y, before.position.y);
            EXPECT_EQ(after.position.z, before.position.z);
            EXPECT_EQ(after.linear_velocity.x, before.linear_velocity.x);
            EXPECT_EQ(after.linear_velocity.y, before.linear_velocity.y);
            EXPECT_EQ(after.linear_velocity.z,
                      to == BodyModel::planar && from != BodyModel::planar ? 0 : before.linear_velocity.z);
            Vec3<double> kept = spin;
            if (to == BodyModel::planar) kept.x = kept.y = 0;
            if (to == BodyModel::particle) kept = {};
            // Three roundings to float: of the velocity, and for a planar body of the inverse inertia.
            EXPECT_LE(length(spin_of(scene, body, round_body) - kept), 2e-7 * length(spin))
                << static_cast<int>(from) << " to " << static_cast<int>(to);
            EXPECT_NEAR(scene.errors().momentum[0], 70 * 1.5, 1e-5 * 105);
        }
    }
}

TEST(ChangeBody, KeepsTheMomentumOfASpinningTopThroughTheNextSteps)
{
    for (const BodyModel from : {BodyModel::planar, BodyModel::rigid}) {
        Scene scene;
        const BodyId body = scene.add_body(moving(from));
        const Vec3<double> spin = spin_of(scene, body, long_body);
        // A tensor in whose frame the body wobbles.
        const Sym3<float> wobbly{1.5F, 0.2F, 0.3F, 2.5F, -0.1F, 2};
        scene.change_body(body, {BodyModel::rigid, wobbly});
        Solver solver({.gravity = {}});
        solver.step(scene, dt);
        EXPECT_LE(length(spin_of(scene, body, wobbly) - spin), 1e-6 * length(spin));
        EXPECT_NEAR(scene.errors().momentum[0], 70 * 1.5, 1e-6 * 105);
    }
}

TEST(ChangeBody, FliesOnAlongItsParabola)
{
    // x = x_0 + v t + a t^2 / 2 with a = g + F / m, and w = w_0 + T t / I about an axis of symmetry, across changes.
    constexpr float torque = 4;
    constexpr double mass = 70, force = 35, gravity = -9.81, steps = 60;
    for (const BodyModel from : models) {
        for (const BodyModel to : models) {
            Scene scene;
            BodyDefinition definition = moving(from);
            definition.inertia = round_body;
            definition.orientation = {0, 0, 0, 1};
            definition.linear_velocity.z = 0;
            definition.angular_velocity = {0, 0, from == BodyModel::particle ? 0.0F : 1.7F};
            const BodyId body = scene.add_body(definition);
            scene.set_force(body, {force, 0, 0}, {0, 0, from == BodyModel::particle ? 0.0F : torque});
            Solver solver({.gravity = {0, gravity, 0}});
            for (int step = 0; step < steps; ++step) {
                if (step == 20) scene.change_body(body, {to, round_body});
                ASSERT_EQ(solver.step(scene, dt).status, StepStatus::done);
            }
            const BodyState state = scene.state(body);
            const double t = steps * static_cast<double>(dt);
            EXPECT_NEAR(state.position.x, 1 + 1.5 * t + force / mass * t * t / 2, 1e-5);
            EXPECT_NEAR(state.position.y, 2 - 0.7F * t + gravity * t * t / 2, 1e-5);
            EXPECT_EQ(state.position.z, 3);
            const bool turns = from != BodyModel::particle && to != BodyModel::particle;
            // 240 substeps, each of which adds the torque and the gyration, and rounds up to 4.2 rad/s by 2.4e-7 at most.
            EXPECT_NEAR(state.angular_velocity.z, turns ? 1.7 + torque * t / 1.6 : 0, 2 * 240 * 2.4e-7);
        }
    }
}

TEST(ChangeBody, TurnsByTheYawAndBackToTheSameBits)
{
    for (const double yaw : {0.0, 0.7, -2.9, 19.25, -300.3}) {
        for (const float spin : {0.0F, 1.7F, -0.37F}) {
            Scene scene;
            BodyDefinition definition = moving(BodyModel::planar);
            definition.yaw = yaw;
            definition.angular_velocity.z = spin;
            const BodyId body = scene.add_body(definition);
            const std::uint64_t planar = scene.state_hash();
            scene.change_body(body, {BodyModel::rigid, long_body});
            const Vec3<double> nose = rotate(scene.state(body).orientation, {1, 0, 0});
            EXPECT_NEAR(nose.x, std::cos(yaw), 1e-12);
            EXPECT_NEAR(nose.y, std::sin(yaw), 1e-12);
            EXPECT_EQ(nose.z, 0);
            EXPECT_NE(scene.state_hash(), planar);
            scene.change_body(body, {BodyModel::planar, long_body});
            EXPECT_EQ(scene.state_hash(), planar) << yaw << " rad, " << spin << " rad/s";
            // A particle does not spin, but remembers where it looked.
            scene.change_body(body, {BodyModel::particle, {}});
            scene.change_body(body, {BodyModel::planar, long_body});
            EXPECT_EQ(scene.state(body).yaw, yaw);
            EXPECT_EQ(scene.state(body).angular_velocity.z, 0);
        }
    }
}

TEST(ChangeBody, GivesUpTheTiltAndCountsItsTurnsOn)
{
    constexpr double turn = 2 * std::numbers::pi;
    for (const double yaw : {0.0, 1.0, 19.25, -40.0}) {
        for (const double more : {0.3, -2.5, 3.1}) {
            Scene scene;
            BodyDefinition definition = moving(BodyModel::planar);
            definition.yaw = yaw;
            const BodyId body = scene.add_body(definition);
            scene.change_body(body, {BodyModel::rigid, long_body});
            // It falls by any axis in the plane, and turns on.
            const Quat<double> lying =
                turned({std::cos(0.4), std::sin(0.4), 0}, 1.5) * turned({0, 0, 1}, yaw + more);
            scene.set_pose(body, definition.position, lying, yaw);
            scene.change_body(body, {BodyModel::planar, long_body});
            EXPECT_NEAR(scene.state(body).yaw, yaw + more, 1e-5);
            EXPECT_LE(std::abs(scene.state(body).yaw - yaw), turn / 2);
        }
    }
    Scene scene;
    BodyDefinition upside_down = moving(BodyModel::rigid);
    upside_down.yaw = 0.5;
    upside_down.orientation = {1, 0, 0, 0};
    const BodyId body = scene.add_body(upside_down);
    scene.change_body(body, {BodyModel::planar, long_body});
    EXPECT_EQ(scene.state(body).yaw, 0.5) << "nothing of its turn about z is left";
}

/// Bodies of one model, or of another one that change to it before the first step: chains that hang from the ground, of
/// which seventeen are alike, and bodies that lie on a floor.
struct Bodies {
    Scene scene;
    std::vector<BodyId> bodies;
    std::vector<ConstraintId> joints;
    std::vector<Contact> contacts;

    Bodies(BodyModel born, BodyModel wanted)
    {
        // A particle has no anchor off its centre: chains of particles are chains of rods for all.
        const bool rods = born == BodyModel::particle || wanted == BodyModel::particle;
        for (int chain = 0; chain < 18; ++chain) {
            BodyId above = scene.ground();
            Vec3<float> hook{2.0F * static_cast<float>(chain), 0, 0};
            for (int link = 0; link < 3; ++link) {
                const BodyId body = add(born, {2.0 * chain + 0.5 + link, 0, 0});
                const Vec3<float> back = rods ? Vec3<float>{} : Vec3<float>{-0.5F, 0, 0};
                if (rods || chain == 0) {
                    joints.push_back(scene.add_joint(DistanceDefinition{.body_a = above,
                                                                        .body_b = body,
                                                                        .local_anchor_a = hook,
                                                                        .local_anchor_b = back,
                                                                        .min_length = 0.4F,
                                                                        .max_length = 1}));
                } else {
                    joints.push_back(scene.add_joint(BallSocketDefinition{above, body, hook, back}));
                }
                above = body;
                hook = -back;
            }
        }
        for (int lying = 0; lying < 6; ++lying) {
            const BodyId body = add(born, {3.0 * lying, 0.5, 9});
            Contact floor;
            floor.body_a = scene.ground();
            floor.body_b = body;
            floor.key = static_cast<std::uint64_t>(lying);
            floor.normal = {0, 1, 0};
            floor.separation = -0.001F;
            floor.arm_a = {3.0F * static_cast<float>(lying), 0, 9};
            floor.arm_b = {0.1F, -0.5F, 0};
            floor.friction = 0.5F;
            contacts.push_back(floor);
        }
        if (born != wanted) change_all(wanted);
    }
    void change_all(BodyModel model)
    {
        for (std::size_t i = 0; i < bodies.size(); ++i) scene.change_body(bodies[i], {model, inertia_of(i)});
    }

  private:
    static Sym3<float> inertia_of(std::size_t i)
    {
        const float m = 1 + 0.1F * static_cast<float>(i % 7);
        return {0.11F * m, 0.01F * m, 0, 0.13F * m, 0.02F * m, 0.12F * m};
    }
    BodyId add(BodyModel model, const Vec3<double>& position)
    {
        BodyDefinition body;
        body.model = model;
        body.position = position;
        body.mass = 1 + 0.1F * static_cast<float>(bodies.size() % 7);
        body.inertia = inertia_of(bodies.size());
        body.linear_velocity = {0.1F * static_cast<float>(bodies.size() % 5), 0, 0};
        bodies.push_back(scene.add_body(body));
        return bodies.back();
    }
};

TEST(ChangeBody, GivesTheBitsOfABodyThatWasAddedWithThisModel)
{
    for (const SolverSettings& settings : testing::every_way()) {
        for (const BodyModel from : models) {
            for (const BodyModel to : models) {
                // Rods that rigid bodies had would be balls on sockets here.
                if ((from == BodyModel::particle) != (to == BodyModel::particle)) continue;
                Bodies born(to, to), changed(from, to);
                ASSERT_EQ(changed.scene.state_hash(), born.scene.state_hash());
                Solver solver(settings), other(settings);
                for (int step = 0; step < testing::long_run(20, 5); ++step) {
                    ASSERT_EQ(solver.step(born.scene, dt, born.contacts).status, StepStatus::done);
                    ASSERT_EQ(other.step(changed.scene, dt, changed.contacts).status, StepStatus::done);
                    ASSERT_EQ(changed.scene.state_hash(), born.scene.state_hash()) << "step " << step;
                }
            }
        }
    }
}

TEST(ChangeBody, LeavesNothingOfTheOldModelInASolverThatKnowsTheScene)
{
    for (const SolverSettings& settings : testing::every_way()) {
        for (const BodyModel to : {BodyModel::rigid, BodyModel::planar}) {
            Bodies bodies(to == BodyModel::rigid ? BodyModel::planar : BodyModel::rigid,
                          to == BodyModel::rigid ? BodyModel::planar : BodyModel::rigid);
            Solver solver(settings);
            for (int step = 0; step < testing::long_run(20, 5); ++step)
                solver.step(bodies.scene, dt, bodies.contacts);
            // Every third one, so that all pairs of old and new models meet.
            for (std::size_t i = 0; i < bodies.bodies.size(); i += 3)
                bodies.scene.change_body(bodies.bodies[i], {to, round_body});
            Scene anew = load_scene(save_scene(bodies.scene));
            ASSERT_EQ(bodies.scene.state_hash(), anew.state_hash());
            Solver other(settings);
            for (int step = 0; step < testing::long_run(20, 5); ++step) {
                ASSERT_EQ(solver.step(bodies.scene, dt, bodies.contacts).status, StepStatus::done);
                ASSERT_EQ(other.step(anew, dt, bodies.contacts).status, StepStatus::done);
                ASSERT_EQ(bodies.scene.state_hash(), anew.state_hash()) << "step " << step;
            }
        }
    }
}

TEST(ChangeBody, GoesOnFromACopyAndFromNewRows)
{
    MixedScene mixed(20);
    Solver solver({.gravity = {0, -9.81F, 0}}), other({.gravity = {0, -9.81F, 0}});
    for (int step = 0; step < 30; ++step) {
        for (std::size_t i = static_cast<std::size_t>(step) % 4; i < mixed.balls.size(); i += 4) {
            const BodyModel now = mixed.scene.model(mixed.balls[i]);
            if (now == BodyModel::particle) continue;  // ball-sockets off the centre may be on the others
            mixed.scene.change_body(
                mixed.balls[i], {now == BodyModel::rigid ? BodyModel::planar : BodyModel::rigid, round_body});
        }
        Scene renumbered = mixed.scene;
        if (step % 2 == 0) renumbered.renumber_bodies();
        const std::vector<Contact> contacts = mixed.contacts();
        ASSERT_EQ(solver.step(mixed.scene, dt, contacts).status, StepStatus::done);
        ASSERT_EQ(other.step(renumbered, dt, contacts).status, StepStatus::done);
        ASSERT_EQ(renumbered.state_hash(), mixed.scene.state_hash()) << "step " << step;
    }
}

/// Balls of 0.2 m in a row along x that lean on a wall at x = 0 with 50 N each. The force that contact i bears is exactly
/// 50 N times the balls behind it.
struct Row {
    static constexpr int count = 12;
    Scene scene;
    std::vector<BodyId> balls;
    std::uint64_t generation = 0;  ///< other keys make all contacts new

    Row()
    {
        for (int i = 0; i < count; ++i) {
            BodyDefinition ball = testing::person_at(0.2 + 0.4 * i, 0);
            balls.push_back(scene.add_body(ball));
            scene.set_force(balls.back(), {-50, 0, 0}, {});
        }
    }
    [[nodiscard]] std::vector<Contact> contacts() const
    {
        std::vector<Contact> list;
        for (std::size_t i = 0; i < balls.size(); ++i) {
            const double x = scene.state(balls[i]).position.x;
            Contact contact;
            contact.body_a = i == 0 ? scene.ground() : balls[i - 1];
            contact.body_b = balls[i];
            contact.key = 100 * generation + i;
            contact.normal = {1, 0, 0};
            contact.arm_a = {i == 0 ? 0.0F : 0.2F, 0, 0};
            contact.arm_b = {-0.2F, 0, 0};
            contact.friction = 0.3F;
            contact.separation =
                static_cast<float>(i == 0 ? x - 0.2 : x - scene.state(balls[i - 1]).position.x - 0.4);
            list.push_back(contact);
        }
        return list;
    }
    /// The most by which a contact of the last step is off its law, as a share of the force on the wall.
    [[nodiscard]] double off() const
    {
        double most = 0;
        for (int i = 0; i < count; ++i) {
            const double law = 50.0 * (count - i) * static_cast<double>(dt);
            const double impulse = scene.contact_impulses()[static_cast<std::size_t>(i)].normal;
            most = std::max(most, std::abs(impulse - law) / (50.0 * count * static_cast<double>(dt)));
        }
        return most;
    }
};

TEST(ChangeBody, FindsTheImpulsesOfItsContactsAgain)
{
    Row row;
    Solver solver(SolverSettings{});
    for (int step = 0; step < 600; ++step) solver.step(row.scene, dt, row.contacts());
    ASSERT_LT(row.off(), 1e-6);
    Row cold = row;
    cold.generation = 1;
    solver.step(cold.scene, dt, cold.contacts());
    EXPECT_GT(cold.off(), 0.3) << "one step finds the forces without a warm start";
    for (const BodyModel to : {BodyModel::rigid, BodyModel::particle, BodyModel::planar}) {
        for (std::size_t i = 0; i < row.balls.size(); i += 2)
            row.scene.change_body(row.balls[i], {to, {1.3F, 0, 0, 1.3F, 0, 1.6F}});
        for (int step = 0; step < 5; ++step) {
            solver.step(row.scene, dt, row.contacts());
            EXPECT_LT(row.off(), 1e-6) << "to " << static_cast<int>(to) << ", step " << step;
        }
    }
}

TEST(ChangeBody, KeepsItsJointsWithTheForcesInThem)
{
    constexpr int links = 6;
    Scene scene;
    std::vector<BodyId> chain;
    std::vector<ConstraintId> joints;
    BodyId above = scene.ground();
    for (int i = 0; i < links; ++i) {
        BodyDefinition link = moving(BodyModel::planar);
        link.position = {0, -0.5 - i, 0};
        link.yaw = 0;
        link.mass = 2;
        link.inertia = {0.2F, 0, 0, 0.1F, 0, 0.2F};
        link.linear_velocity = link.angular_velocity = {};
        chain.push_back(scene.add_body(link));
        const Vec3<float> hook = i == 0 ? Vec3<float>{} : Vec3<float>{0, -0.5F, 0};
        joints.push_back(scene.add_joint(BallSocketDefinition{above, chain.back(), hook, {0, 0.5F, 0}}));
        above = chain.back();
    }
    scene.set_break_limit(joints[0], {.force = 1});
    scene.set_iterations(joints[1], 3);
    Solver solver({.gravity = {0, -9.81F, 0}});
    for (int step = 0; step < 600; ++step) solver.step(scene, dt);
    const auto check = [&](const char* when) {
        for (int i = 0; i < links; ++i) {
            ASSERT_TRUE(scene.is_alive(joints[static_cast<std::size_t>(i)]));
            const JointReport report = scene.joint_report(joints[static_cast<std::size_t>(i)]);
            // The weight of all links below.
            EXPECT_NEAR(report.force.y, 2 * 9.81 * (links - i), 0.02) << when << ", joint " << i;
        }
        ASSERT_EQ(scene.break_events().size(), std::size_t{1});
        EXPECT_EQ(scene.break_events()[0].joint, joints[0]);
    };
    check("before");
    for (const BodyModel to : {BodyModel::rigid, BodyModel::planar}) {
        for (const BodyId link : chain) {
            // From link to link, so that each meets both models on both sides.
            scene.change_body(link, {to, {0.2F, 0, 0, 0.1F, 0, 0.2F}});
            ASSERT_EQ(solver.step(scene, dt).status, StepStatus::done);
            check("on the way");
        }
    }
}

TEST(ChangeBody, KeepsUserDataAndTheIterationsOfTheIsland)
{
    Scene scene;
    const BodyId body = scene.add_body(moving(BodyModel::planar)), other = scene.add_body({});
    scene.add_joint(BallSocketDefinition{body, other, {}, {}});
    scene.set_user_data(body, 42);
    scene.set_island_iterations(body, 50);
    for (const BodyModel to : {BodyModel::rigid, BodyModel::particle, BodyModel::planar}) {
        scene.change_body(body, {to, long_body});
        EXPECT_EQ(scene.user_data(body), 42U);
    }
    Scene without = scene;
    without.set_island_iterations(body, 0);
    Solver solver({.gravity = {}});
    solver.step(scene, dt);
    solver.step(without, dt);
    EXPECT_NE(scene.state_hash(), without.state_hash()) << "the wish makes no difference here";
}

TEST(ChangeBody, ThatIsContainedIsRefusedUntilItIsRevived)
{
    Scene scene;
    BodyDefinition light = moving(BodyModel::planar);
    light.mass = 1e-6F;
    const BodyId body = scene.add_body(light);
    Solver solver;
    scene.set_force(body, {3e38F, 3e38F, 0}, {});
    for (int step = 0; step < 10 && !scene.is_contained(body); ++step) solver.step(scene, dt);
    ASSERT_TRUE(scene.is_contained(body));
    const std::uint64_t hash = scene.state_hash();
    EXPECT_THROW(scene.change_body(body, {BodyModel::rigid, long_body}), InvalidInput);
    EXPECT_EQ(scene.state_hash(), hash);
    EXPECT_EQ(scene.model(body), BodyModel::planar);
    scene.set_force(body, {}, {});
    scene.revive(body, {}, {1, 0, 0});
    scene.change_body(body, {BodyModel::rigid, long_body});
    solver.step(scene, dt);
    EXPECT_NEAR(scene.state(body).position.x, static_cast<double>(dt), 1e-8);
}

/// Some of a crowd become particles, rigid bodies, and people with discs again, while all jostle.
struct ChangingCrowd {
    testing::DiscCrowd crowd{{.people = 600, .friction = 0.3F}};
    std::vector<Contact> contacts;

    /// Returns the people who were given a disc again.
    std::vector<BodyId> change(int step)
    {
        std::vector<BodyId> with_new_discs;
        for (std::size_t i = static_cast<std::size_t>(step) % 7; i < crowd.people.size(); i += 41) {
            // So that some leave the plane while others come back, into rows that were just left.
            if ((7919 * i + 6007 * static_cast<std::size_t>(step)) % 3 == 0) continue;
            const BodyId person = crowd.people[i];
            BodyModel to = BodyModel::planar;
            if (crowd.scene.has_disc(person)) {
                crowd.scene.clear_disc(person);
                to = i % 2 == 0 ? BodyModel::particle : BodyModel::rigid;
            }
            crowd.scene.change_body(person, {to, {1.5F, 0, 0, 1.5F, 0, 1.6F}});
            if (to != BodyModel::planar) continue;
            DiscDefinition disc = crowd.discs[i];
            disc.friction = step % 2 == 0 ? 0.3F : 0;
            crowd.scene.set_disc(person, disc);
            with_new_discs.push_back(person);
        }
        if (step % 10 == 0) crowd.pull_together(150);
        return with_new_discs;
    }
};

TEST(ChangeBody, InACrowdOfDiscsHasTheSameBitsOnEveryThreadAndInEveryLane)
{
    const auto run = [](const SolverOptions& options) {
        ChangingCrowd changing;
        Solver solver(SolverSettings{}, options);
        std::vector<std::uint64_t> hashes;
        for (int step = 0; step < 90; ++step) {
            changing.change(step);
            EXPECT_EQ(solver.step(changing.crowd.scene, dt).status, StepStatus::done);
            hashes.push_back(changing.crowd.scene.state_hash());
        }
        return hashes;
    };
    const std::vector<std::uint64_t> expected = run({.isa = Isa::scalar});
    for (const Isa isa : available_isas()) {
        for (const int threads : {1, 2, 4})
            EXPECT_EQ(run({.threads = threads, .alone_below = 0, .isa = isa}), expected) << isa_name(isa);
    }
}

/// Discs that rub each other keep the effective masses of their contacts from search to search.
TEST(ChangeBody, ToTheSameModelIsASetMassWithTheSpinThatKeepsTheMomentum)
{
    testing::DiscCrowd changed({.people = 300, .friction = 0.4F, .speed = 0.1F});
    for (const BodyId person : changed.people) changed.scene.set_mass(person, 75, {0, 0, 0, 0, 0, 2});
    changed.pull_together(300);
    Solver solver(SolverSettings{}), other(SolverSettings{});
    for (int step = 0; step < 300; ++step) solver.step(changed.scene, dt);
    Scene still = changed.scene;
    solver.step(still, dt);
    ASSERT_GT(core_of(still).discs.age, 0) << "neighbours would be searched for anyway";
    Scene same = changed.scene;
    for (std::size_t i = 0; i < changed.people.size(); i += 2) {
        const BodyId person = changed.people[i];
        const Vec3<float> linear = same.state(person).linear_velocity;
        changed.scene.set_velocity(person, linear, {0, 0, 0.25F});
        changed.scene.change_body(person, {BodyModel::planar, {0, 0, 0, 0, 0, 0.5F}});
        EXPECT_TRUE(changed.scene.has_disc(person));
        same.set_mass(person, 75, {0, 0, 0, 0, 0, 0.5F});
        same.set_velocity(person, linear, {0, 0, 1});
    }
    for (int step = 0; step < 20; ++step) {
        solver.step(changed.scene, dt);
        other.step(same, dt);
        ASSERT_EQ(changed.scene.state_hash(), same.state_hash()) << "step " << step;
    }
}

TEST(ChangeBody, InACrowdOfDiscsLeavesNoContactBehind)
{
    ChangingCrowd changing;
    Scene& scene = changing.crowd.scene;
    Solver solver(SolverSettings{}), other(SolverSettings{});
    for (int step = 0; step < 60; ++step) {
        const std::vector<BodyId> with_new_discs = changing.change(step);
        // Between steps the contacts of the last one are told: of nobody who has left the plane, nor of whoever has got
        // the row of such a person since.
        for (const DiscContact& contact : scene.disc_contacts()) {
            for (const BodyId body : {contact.a, contact.b}) {
                ASSERT_TRUE(body == scene.ground() || scene.model(body) == BodyModel::planar);
                ASSERT_EQ(std::count(with_new_discs.begin(), with_new_discs.end(), body), 0);
            }
        }
        Scene anew = load_scene(save_scene(scene));
        ASSERT_EQ(solver.step(scene, dt).status, StepStatus::done);
        ASSERT_EQ(other.step(anew, dt).status, StepStatus::done);
        ASSERT_EQ(anew.state_hash(), scene.state_hash()) << "step " << step;
        for (const DiscContact& contact : scene.disc_contacts())
            ASSERT_TRUE(scene.has_disc(contact.b) && (contact.wall != WallId{} || scene.has_disc(contact.a)));
    }
}

}  // namespace
}  // namespace motley
