// Bodies whose mass a host changes. Independent evidence: bodies that were added with the new mass, bit for bit, and a
// scene that was read back from bytes, which computes all that follows from a mass anew.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "every_way.h"
#include "motley/motley.h"
#include "rig.h"

namespace motley {
namespace {

constexpr float dt = 1.0F / 60;

/// The mass and the inertia of body `i`, small or large.
float mass_of(std::size_t i, bool large)
{
    return (large ? 3.7F : 0.6F) + 0.1F * static_cast<float>(i % 7);
}
Sym3<float> inertia_of(std::size_t i, bool large)
{
    const float m = mass_of(i, large);
    return {0.11F * m, 0.01F * m, 0, 0.13F * m, 0.02F * m, 0.12F * m};
}

/// Chains of every model that hang from the ground, seventeen equal ones of rigid bodies, of which sixteen are solved
/// in lockstep, and bodies that lie on a floor.
struct Bodies {
    Scene scene;
    std::vector<BodyId> bodies;
    std::vector<Contact> contacts;

    explicit Bodies(bool large)
    {
        for (int chain = 0; chain < 20; ++chain) {
            const BodyModel model = chain < 3 ? static_cast<BodyModel>(chain) : BodyModel::rigid;
            BodyId above = scene.ground();
            Vec3<float> hook{2.0F * static_cast<float>(chain), 0, 0};
            for (int link = 0; link < 3; ++link) {
                const BodyId body = add(model, {2.0 * chain + 0.5 + link, 0, 0}, large);
                if (model == BodyModel::particle) {
                    scene.add_joint(
                        DistanceDefinition{.body_a = above,
                                           .body_b = body,
                                           .local_anchor_a = above == scene.ground() ? hook : Vec3<float>{},
                                           .min_length = 0.5F,
                                           .max_length = 1});
                } else {
                    scene.add_joint(BallSocketDefinition{above, body, hook, {-0.5F, 0, 0}});
                }
                above = body;
                hook = {0.5F, 0, 0};
            }
        }
        for (int lying = 0; lying < 6; ++lying) {
            const BodyId body = add(static_cast<BodyModel>(lying % 3), {3.0 * lying, 0.5, 9}, large);
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
    }
    /// Says every mass anew.
    void set_masses(bool large)
    {
        for (std::size_t i = 0; i < bodies.size(); ++i)
            scene.set_mass(bodies[i], mass_of(i, large), inertia_of(i, large));
    }

  private:
    BodyId add(BodyModel model, const Vec3<double>& position, bool large)
    {
        BodyDefinition body;
        body.model = model;
        body.position = position;
        body.mass = mass_of(bodies.size(), large);
        body.inertia = inertia_of(bodies.size(), large);
        body.linear_velocity = {0.1F * static_cast<float>(bodies.size() % 5), 0, 0};
        if (model != BodyModel::particle) body.angular_velocity = {0, 0, 0.3F};
        bodies.push_back(scene.add_body(body));
        return bodies.back();
    }
};

TEST(SetMass, GivesTheBitsOfABodyThatWasAddedWithThisMass)
{
    for (const SolverSettings& settings : testing::every_way()) {
        Bodies born(true), changed(false);
        changed.set_masses(true);
        EXPECT_EQ(changed.scene.state_hash(), born.scene.state_hash());
        EXPECT_EQ(changed.scene.errors().kinetic_energy, born.scene.errors().kinetic_energy);
        for (Bodies* bodies : {&born, &changed}) {
            for (std::size_t i = 0; i < bodies->bodies.size(); i += 4)
                bodies->scene.set_force(bodies->bodies[i], {1, 2, 0}, {0, 0, 0.5F});
        }
        Solver solver(settings), other(settings);
        for (int step = 0; step < testing::long_run(30, 5); ++step) {
            ASSERT_EQ(solver.step(born.scene, dt, born.contacts).status, StepStatus::done);
            ASSERT_EQ(other.step(changed.scene, dt, changed.contacts).status, StepStatus::done);
            ASSERT_EQ(changed.scene.state_hash(), born.scene.state_hash()) << "step " << step;
        }
    }
}

TEST(SetMass, LeavesNothingOfTheOldMassInASolverThatKnowsTheScene)
{
    for (const SolverSettings& settings : testing::every_way()) {
        Bodies bodies(false);
        Solver solver(settings);
        for (int step = 0; step < testing::long_run(20, 5); ++step)
            solver.step(bodies.scene, dt, bodies.contacts);
        bodies.set_masses(true);
        Scene anew = load_scene(save_scene(bodies.scene));
        Solver other(settings);
        for (int step = 0; step < testing::long_run(20, 5); ++step) {
            ASSERT_EQ(solver.step(bodies.scene, dt, bodies.contacts).status, StepStatus::done);
            ASSERT_EQ(other.step(anew, dt, bodies.contacts).status, StepStatus::done);
            ASSERT_EQ(bodies.scene.state_hash(), anew.state_hash()) << "step " << step;
        }
        EXPECT_NE(bodies.scene.state_hash(), Bodies(false).scene.state_hash());
    }
}

TEST(SetMass, KeepsTheForceAndTheTorque)
{
    for (const BodyModel model : {BodyModel::particle, BodyModel::planar, BodyModel::rigid}) {
        Scene scene;
        BodyDefinition definition;
        definition.model = model;
        const BodyId body = scene.add_body(definition);
        const float torque = model == BodyModel::particle ? 0 : 5;
        scene.set_force(body, {3, 0, 0}, {0, 0, torque});
        scene.set_mass(body, 1.7F, {0.3F, 0, 0, 0.4F, 0, 0.5F});
        Solver solver;
        for (int step = 0; step < 60; ++step) solver.step(scene, dt);
        const BodyState state = scene.state(body);
        // F t / m and T t / I after one second; float steps round to about a millionth each.
        EXPECT_NEAR(state.linear_velocity.x, 3 / 1.7, 1e-5);
        EXPECT_NEAR(state.angular_velocity.z, static_cast<double>(torque) / 0.5, 1e-4);
    }
}

TEST(SetMass, OfAContainedBodyCountsFromItsRevival)
{
    for (const BodyModel model : {BodyModel::particle, BodyModel::planar, BodyModel::rigid}) {
        Scene scene, fresh;
        BodyDefinition light;
        light.model = model;
        light.mass = 1e-6F;
        const BodyId body = scene.add_body(light);
        Solver solver;
        scene.set_force(body, {3e38F, 3e38F, 0}, {});
        for (int step = 0; step < 10 && !scene.is_contained(body); ++step) solver.step(scene, dt);
        ASSERT_TRUE(scene.is_contained(body));
        scene.set_force(body, {}, {});
        const std::uint64_t frozen = scene.state_hash();
        scene.set_mass(body, 2, {0.3F, 0, 0, 0.4F, 0, 0.5F});
        solver.step(scene, dt);
        EXPECT_EQ(scene.state_hash(), frozen) << "it does not move yet";
        scene.revive(body, {}, {1, 0, 0});
        light.mass = 2;
        light.inertia = {0.3F, 0, 0, 0.4F, 0, 0.5F};
        light.linear_velocity = {1, 0, 0};
        const BodyId same = fresh.add_body(light);
        for (Scene* each : {&scene, &fresh})
            each->set_force(each == &scene ? body : same, {1, 2, 0},
                            {0, 0, model == BodyModel::particle ? 0.0F : 3.0F});
        for (int step = 0; step < 10; ++step) {
            solver.step(scene, dt);
            solver.step(fresh, dt);
        }
        EXPECT_EQ(scene.state(body).position.x, fresh.state(same).position.x);
        EXPECT_EQ(scene.state(body).linear_velocity.y, fresh.state(same).linear_velocity.y);
        EXPECT_EQ(scene.state(body).angular_velocity.z, fresh.state(same).angular_velocity.z);
    }
}

TEST(SetMass, DecidesAnewWhichJointsAreSolvedAtOnce)
{
    // Three bodies in a row that float freely: exact joints refuse a middle one below a millionth of the others.
    Scene scene;
    std::vector<BodyId> bodies;
    for (int i = 0; i < 3; ++i) {
        bodies.push_back(scene.add_body({.position = {1.0 * i, 0, 0}}));
        if (i > 0)
            scene.add_joint(BallSocketDefinition{
                bodies[static_cast<std::size_t>(i) - 1], bodies.back(), {0.5F, 0, 0}, {-0.5F, 0, 0}});
    }
    Solver solver({.exact_joints = true});
    EXPECT_EQ(solver.step(scene, dt).exact_joints_refused, 0);
    scene.set_mass(bodies[1], 1e-7F, {1e-7F, 0, 0, 1e-7F, 0, 1e-7F});
    const StepReport report = solver.step(scene, dt);
    EXPECT_EQ(report.exact_joints_refused, 2);
    EXPECT_EQ(report.first_light_body, bodies[1]);
    scene.set_mass(bodies[1], 1, {1, 0, 0, 1, 0, 1});
    EXPECT_EQ(solver.step(scene, dt).exact_joints_refused, 0);
}

}  // namespace
}  // namespace motley
