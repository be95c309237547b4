// Figures in lockstep have the same bits as ordinary sweeps, whatever touches, breaks or joins a copy. Independent
// evidence: a step that measures itself sweeps everything by colour, and must end in the same bits.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "every_way.h"
#include "rig.h"

namespace motley {
namespace {

using testing::box;
using testing::frame_time;

/// Hips on a static peg, a chest on a ball-socket with a cone, an arm on a hinge with limits and a motor, a hand on a
/// rope, and a spring back to the hips: every way in which a joint can be solved.
Figure puppet()
{
    Figure figure;
    BodyDefinition peg;
    peg.motion = BodyMotion::static_body;
    const BodyId hook = figure.add_body(peg);
    const BodyId hips = figure.add_body(box({0, -0.5, 0}, 8));
    const BodyId chest = figure.add_body(box({0.1, -1.1, 0}, 12));
    const BodyId arm = figure.add_body(box({0.7, -1.1, 0.1}, 2));
    const BodyId hand = figure.add_body(box({1.2, -1.0, 0.1}, 0.5F));
    figure.add_joint(BallSocketDefinition{hook, hips, {}, {0, 0.5F, 0}});
    figure.add_joint(BallSocketDefinition{hips, chest, {0, -0.3F, 0}, {-0.1F, 0.3F, 0}});
    SwingLimitDefinition cone{hips, chest};
    cone.frame_a.rotation = cone.frame_b.rotation = testing::axis_along(1);
    cone.max_angle = 0.3F;
    figure.add_joint(cone);
    // The chest is body b, so that the tree has to reverse this joint.
    HingeDefinition shoulder{arm, chest};
    shoulder.frame_a.position = {-0.3F, 0, 0};
    shoulder.frame_b.position = {0.3F, 0, 0.1F};
    figure.add_joint(shoulder);
    TwistDriveDefinition muscle{arm, chest, shoulder.frame_a, shoulder.frame_b};
    muscle.lower = -0.6F;
    muscle.upper = 0.4F;
    muscle.motor_speed = 1;
    muscle.motor_max_force = 3;
    figure.add_joint(muscle);
    DistanceDefinition rope{arm, hand, {0.3F, 0, 0}, {}};
    rope.min_length = 0;
    rope.max_length = 0.3F;
    figure.add_joint(rope);
    DistanceDefinition spring{hips, hand};
    spring.min_length = 0;
    spring.max_length = 10;
    spring.spring_hertz = 2;
    spring.spring_damping_ratio = 0.1F;
    spring.rest_length = 1;
    figure.add_joint(spring);
    return figure;
}

constexpr std::size_t puppet_bodies = 5;
constexpr std::int64_t puppet_joints = 7;

/// Copies of the puppet, each with its own velocity.
std::vector<BodyId> add_puppets(Scene& scene, int copies)
{
    std::vector<Placing> places;
    for (int i = 0; i < copies; ++i) {
        const double turn = 0.1 * i;
        places.push_back({.position = {4.0 * (i % 8), 0, 4.0 * (i / 8)},
                          .orientation = {0, std::sin(turn), 0, std::cos(turn)}});
    }
    std::vector<BodyId> ids = add_assembly(scene, puppet(), places);
    for (std::size_t i = 0; i < ids.size(); ++i) {
        if (i % puppet_bodies == 0) continue;
        scene.set_velocity(ids[i], {0.1F * static_cast<float>(i % 7), 0, 0.2F},
                           {0, 0.01F * static_cast<float>(i), 0});
    }
    return ids;
}

std::vector<SolverSettings> every_way()
{
    const SolverSettings soft = testing::with_gravity({0, -9.81F, 0});
    SolverSettings iterated = soft;
    iterated.iterations = 3;
    iterated.relaxations = 2;
    SolverSettings exact = soft;
    exact.exact_joints = true;
    SolverSettings impulse = soft;
    impulse.method = Method::sequential_impulse;
    impulse.drift_correction = DriftCorrection::baumgarte;  // figures with projection are swept by colour
    impulse.iterations = 6;
    impulse.substeps = 2;
    SolverSettings limits = exact;
    limits.exact_limits = true;
    if (testing::is_sanitized) return {iterated, exact, limits};
    return {soft, iterated, exact, limits, impulse};
}

TEST(Figures, CopiesInLockstepHaveTheBitsOfOrdinarySweepsAfterEveryStep)
{
    constexpr int copies = 16 + 16 + 5;  // two full blocks; five are too few for a third
    for (const SolverSettings& settings : every_way()) {
        Scene lockstep;
        add_puppets(lockstep, copies);
        Scene ordinary = lockstep;
        Solver solver(settings), reference(testing::swept(settings));
        for (int step = 0; step < testing::long_run(300); ++step) {
            const StepReport report = solver.step(lockstep, frame_time);
            ASSERT_EQ(report.status, StepStatus::done) << report.error;
            EXPECT_EQ(report.joints_in_lockstep, puppet_joints * (settings.exact_joints ? copies : 32));
            EXPECT_EQ(report.joints, puppet_joints * copies);
            EXPECT_EQ(reference.step(ordinary, frame_time).joints_in_lockstep, 0);
            ASSERT_EQ(lockstep.state_hash(), ordinary.state_hash()) << "step " << step;
        }
    }
}

TEST(Figures, EveryInstructionSetAndThreadCountHasTheSameBits)
{
    for (const SolverSettings& settings : every_way()) {
        std::vector<std::uint64_t> scalar;
        const auto run = [&](const SolverOptions& options) {
            Scene scene;
            add_puppets(scene, 48 + 11);
            Solver solver(settings, options);
            std::vector<std::uint64_t> hashes;
            for (int step = 0; step < testing::long_run(60); ++step) {
                solver.step(scene, frame_time);
                hashes.push_back(scene.state_hash());
            }
            return hashes;
        };
        scalar = testing::expect_same_bits(run);
    }
}

TEST(Figures, ACopyThatTouchesBreaksOrLeavesKeepsTheBitsOfOrdinarySweeps)
{
    for (const SolverSettings& settings : every_way()) {
        Scene lockstep;
        std::vector<BodyId> ids = add_puppets(lockstep, 40);
        const BodyId stone = lockstep.add_body(box({-3, -1, 0}, 5));
        Scene ordinary = lockstep;
        Solver solver(settings), reference(testing::swept(settings));
        const auto in_both = [&](auto&& change) {
            change(lockstep);
            change(ordinary);
        };
        std::vector<std::int64_t> in_lockstep;
        for (int step = 0; step < 120; ++step) {
            // From step 20 on a stone pushes the hips of copy 3, for twenty steps.
            std::vector<Contact> contacts;
            if (step >= 20 && step < 40) {
                Contact contact;
                contact.body_a = stone;
                contact.body_b = ids[3 * puppet_bodies + 1];
                contact.key = 1;
                contact.normal = {1, 0, 0};
                contact.separation = -0.01F;
                contact.friction = 0.5F;
                contacts.push_back(contact);
            }
            if (step == 50)  // a rope from copy 20 to copy 21
                in_both([&](Scene& scene) {
                    DistanceDefinition rope{ids[20 * puppet_bodies + 2], ids[21 * puppet_bodies + 2]};
                    rope.min_length = 0;
                    rope.max_length = 4.1F;
                    scene.add_joint(rope);
                });
            if (step == 70)  // copy 5 loses its hand
                in_both([&](Scene& scene) { scene.remove_body(ids[5 * puppet_bodies + 4]); });
            if (step == 90)  // a lock of copy 6 becomes a spring; two copies are removed, one is added
                in_both([&](Scene& scene) {
                    for (std::size_t i = 0; i < puppet_bodies; ++i) {
                        scene.remove_body(ids[30 * puppet_bodies + i]);
                        scene.remove_body(ids[31 * puppet_bodies + i]);
                    }
                    const std::vector<Placing> late{{.position = {-10, 0, 0}}};
                    add_assembly(scene, puppet(), late);
                });
            const StepReport report = solver.step(lockstep, frame_time, contacts);
            ASSERT_EQ(report.status, StepStatus::done) << report.error;
            reference.step(ordinary, frame_time, contacts);
            ASSERT_EQ(lockstep.state_hash(), ordinary.state_hash()) << "step " << step;
            in_lockstep.push_back(report.joints_in_lockstep);
        }
        if (settings.exact_joints) continue;
        // 40 copies: 16 + 16 + 8 are in lockstep; a touched block is not. Copies that a rope ties, and one that loses a
        // hand, leave their blocks, and the others stay in theirs.
        EXPECT_EQ(in_lockstep[10], 40 * puppet_joints);
        EXPECT_EQ(in_lockstep[30], 24 * puppet_joints);
        EXPECT_EQ(in_lockstep[45], 40 * puppet_joints);
        EXPECT_EQ(in_lockstep[60], 38 * puppet_joints) << "38 are left alike";
        EXPECT_EQ(in_lockstep[80], 37 * puppet_joints);
    }
}

/// Joints are removed and added again, one a figure and several in each step. The stores then hold the joints of all
/// figures in another order, but the figures are the same.
TEST(Figures, ACopyWhoseJointsAreReplacedStaysInLockstep)
{
    constexpr int copies = 32, bodies = 6;
    Scene scene;
    std::vector<BallSocketDefinition> definitions;
    std::vector<ConstraintId> joints;
    for (int copy = 0; copy < copies; ++copy) {
        BodyId last{};
        for (int i = 0; i < bodies; ++i) {
            const BodyId body = scene.add_body(box({double(i), double(copy), 0}, 1));
            if (i > 0) {
                definitions.push_back({last, body, {0.5F, 0, 0}, {-0.5F, 0, 0}});
                joints.push_back(scene.add_joint(definitions.back()));
            }
            last = body;
        }
    }
    Solver solver(testing::with_gravity({0, -9.81F, 0}));
    solver.step(scene, frame_time);  // gives the joints their colours
    std::uint32_t random = 1;
    for (int step = 0; step < 50; ++step) {
        // Several at once, so that their slots are reused in another order too.
        std::vector<std::size_t> replaced;
        for (int k = 0; k < 5; ++k) {
            random = random * 1664525 + 1013904223;
            const std::size_t joint = (random >> 8) % joints.size();
            const auto same_figure = [&](std::size_t other) {
                return other / (bodies - 1) == joint / (bodies - 1);
            };
            if (std::any_of(replaced.begin(), replaced.end(), same_figure)) continue;
            scene.remove_joint(joints[joint]);
            replaced.push_back(joint);
        }
        for (const std::size_t joint : replaced) joints[joint] = scene.add_joint(definitions[joint]);
        const StepReport report = solver.step(scene, frame_time);
        ASSERT_EQ(report.status, StepStatus::done) << report.error;
        ASSERT_EQ(report.joints_in_lockstep, copies * (bodies - 1)) << "step " << step;
    }
}

/// Gears count turns from the poses at the beginning of a step to those at its end.
TEST(Figures, CopiesWithGearsKeepTheBitsOfOrdinarySweeps)
{
    for (const SolverSettings& settings : every_way()) {
        Scene lockstep;
        const std::vector<BodyId> ids = add_puppets(lockstep, 16);
        for (std::size_t copy = 0; copy < 16; ++copy) {
            GearDefinition gear{ids[copy * puppet_bodies + 3], ids[copy * puppet_bodies + 4]};
            gear.ratio = 0.5F;
            lockstep.add_joint(gear);
        }
        Scene ordinary = lockstep;
        Solver solver(settings), reference(testing::swept(settings));
        for (int step = 0; step < 120; ++step) {
            const StepReport report = solver.step(lockstep, frame_time);
            ASSERT_EQ(report.joints_in_lockstep, (puppet_joints + 1) * 16) << report.error;
            reference.step(ordinary, frame_time);
            ASSERT_EQ(lockstep.state_hash(), ordinary.state_hash()) << "step " << step;
        }
    }
}

/// A torso on a peg, with an upper arm on a shoulder of limited rotations and a forearm on an elbow that slides within
/// limits and is driven.
std::vector<SixDofDefinition> arm_joints(std::span<const BodyId> bodies)
{
    SixDofDefinition hang;
    hang.body_a = bodies[0];
    hang.body_b = bodies[1];
    hang.frame_b.position = {0, 0.5F, 0};
    hang.rotation[1] = AxisSetup::limited(-0.4F, 0.3F);
    SixDofDefinition shoulder;
    shoulder.body_a = bodies[1];
    shoulder.body_b = bodies[2];
    shoulder.frame_a.position = {0.35F, 0, 0};
    shoulder.frame_b.position = {-0.35F, 0, 0};
    shoulder.rotations = SixDofRotation::euler;
    shoulder.rotation[0] = AxisSetup::limited(-0.5F, 0.5F);
    shoulder.rotation[1] = AxisSetup::free();
    shoulder.rotation[2] = AxisSetup::limited(-0.2F, 1);
    SixDofDefinition elbow;
    elbow.body_a = bodies[2];
    elbow.body_b = bodies[3];
    elbow.frame_a.position = {0.3F, 0, 0};
    elbow.frame_b.position = {-0.3F, 0, 0};
    elbow.position[0] = AxisSetup::limited(0, 0.1F);
    elbow.rotation[2] = {.lower = -1, .upper = 1, .motor_speed = 2, .motor_max_force = 5};
    return {hang, shoulder, elbow};
}
constexpr std::size_t arm_bodies = 4;
Figure armed()
{
    Figure figure;
    BodyDefinition peg;
    peg.motion = BodyMotion::static_body;
    const std::array<BodyId, arm_bodies> bodies{figure.add_body(peg), figure.add_body(box({0, -0.5, 0}, 8)),
                                                figure.add_body(box({0.7, -0.5, 0}, 2)),
                                                figure.add_body(box({1.3, -0.5, 0}, 1))};
    for (const SixDofDefinition& joint : arm_joints(bodies)) figure.add_six_dof(joint);
    return figure;
}

TEST(Figures, CopiesWithJointsOfSixDegreesOfFreedomHaveTheBitsOfOrdinarySweeps)
{
    constexpr std::size_t copies = 16 + 9;
    const Figure figure = armed();
    std::vector<Placing> places;
    for (std::size_t i = 0; i < copies; ++i)
        places.push_back({.position = {4.0 * static_cast<double>(i), 0, 0}});
    for (const SolverSettings& settings : every_way()) {
        Scene lockstep;
        const std::vector<BodyId> ids = add_assembly(lockstep, figure, places);
        for (std::size_t i = 0; i < ids.size(); ++i) {
            if (i % arm_bodies != 0)
                lockstep.set_velocity(ids[i], {0.1F * static_cast<float>(i % 7), 0, 0.2F},
                                      {0, 0.01F * static_cast<float>(i), 0});
        }
        Scene ordinary = lockstep;
        Solver solver(settings), reference(testing::swept(settings));
        for (int step = 0; step < testing::long_run(120); ++step) {
            const StepReport report = solver.step(lockstep, frame_time);
            ASSERT_EQ(report.joints_in_lockstep, static_cast<std::int64_t>(figure.joint_count() * copies))
                << report.error;
            reference.step(ordinary, frame_time);
            ASSERT_EQ(lockstep.state_hash(), ordinary.state_hash()) << "step " << step;
        }
    }
}

TEST(Figures, AJointOfSixDegreesOfFreedomOfAFigureIsTheOneThatASceneHas)
{
    const Figure figure = armed();
    const std::vector<Placing> place{{}};
    Scene copied, built;
    add_assembly(copied, figure, place);
    std::vector<BodyId> bodies(arm_bodies);
    built.add_bodies(figure.bodies(), bodies);
    for (const SixDofDefinition& joint : arm_joints(bodies)) add_six_dof(built, joint);
    EXPECT_EQ(copied.joint_count(), figure.joint_count());
    Solver one(testing::with_gravity({0, -9.81F, 0})), other(testing::with_gravity({0, -9.81F, 0}));
    for (int step = 0; step < 120; ++step) {
        one.step(copied, frame_time);
        other.step(built, frame_time);
        ASSERT_EQ(copied.state_hash(), built.state_hash()) << "step " << step;
    }
}

TEST(Figures, ARefusedJointOfSixDegreesOfFreedomLeavesTheFigureAsItWas)
{
    Figure figure = armed();
    const std::size_t joints = figure.joint_count();
    SixDofDefinition bad;
    bad.body_a = figure.add_body(box({}, 1));
    bad.body_b = figure.add_body(box({1, 0, 0}, 1));
    bad.rotation[0].lower = -1;  // locks are added first, and this is refused after them
    bad.rotation[0].upper = std::nanf("");
    EXPECT_THROW(figure.add_six_dof(bad), InvalidInput);
    EXPECT_EQ(figure.joint_count(), joints);
    Scene other;
    bad.rotation[0] = {};
    bad.body_a = other.ground();
    EXPECT_THROW(figure.add_six_dof(bad), InvalidInput);
    EXPECT_EQ(figure.joint_count(), joints);
}

TEST(Figures, ACopyThatComesToGriefIsFrozenAndTheOthersKeepTheirBits)
{
    for (const SolverSettings& settings : every_way()) {
        Scene lockstep;
        const std::vector<BodyId> ids = add_puppets(lockstep, 16);
        Scene ordinary = lockstep;
        Solver solver(settings), reference(testing::swept(settings));
        std::int64_t contained = 0;
        for (int step = 0; step < 60; ++step) {
            if (step == 20) {
                const BodyId hand = ids[7 * puppet_bodies + 4];
                for (Scene* scene : {&lockstep, &ordinary}) scene->set_force(hand, {3e38F, 3e38F, 0}, {});
            }
            const StepReport report = solver.step(lockstep, frame_time);
            ASSERT_EQ(report.status, StepStatus::done) << report.error;
            if (step == 20) {
                EXPECT_EQ(report.joints_in_lockstep, puppet_joints * 16);
            }
            const StepReport expected = reference.step(ordinary, frame_time);
            ASSERT_EQ(report.bodies_contained, expected.bodies_contained) << "step " << step;
            ASSERT_EQ(lockstep.state_hash(), ordinary.state_hash()) << "step " << step;
            contained += report.bodies_contained;
        }
        EXPECT_GT(contained, 0);
    }
}

TEST(Figures, AnAssemblyIsAllOrNothing)
{
    Scene scene;
    const std::uint64_t empty = scene.state_hash();
    const Figure figure = puppet();
    const std::vector<Placing> bad_position{{}, {.position = {0, std::nan(""), 0}}};
    EXPECT_THROW(add_assembly(scene, figure, bad_position), InvalidInput);
    const std::vector<Placing> bad_turn{{.orientation = {0, 0, 0, 0}}};
    EXPECT_THROW(add_assembly(scene, figure, bad_turn), InvalidInput);
    EXPECT_EQ(scene.body_count(), 0U);
    EXPECT_EQ(scene.state_hash(), empty);
    Figure alien;
    const BodyId body = alien.add_body(box({}));
    EXPECT_THROW(alien.add_joint(BallSocketDefinition{scene.ground(), body}), InvalidInput);
    EXPECT_EQ(alien.joint_count(), 0U);
}

TEST(Figures, ACopyStandsWhereItIsPlaced)
{
    Scene scene;
    const std::vector<Placing> place{
        {.position = {5, 6, 7}, .orientation = {0, 0, 1, 1}, .linear_velocity = {1, 0, 0}}};
    const std::vector<BodyId> ids = add_assembly(scene, puppet(), place);
    const BodyState chest = scene.state(ids[2]);  // a quarter turn about z of (0.1, -1.1, 0)
    EXPECT_NEAR(chest.position.x, 5 + 1.1, 1e-12);
    EXPECT_NEAR(chest.position.y, 6 + 0.1, 1e-12);
    EXPECT_FLOAT_EQ(chest.linear_velocity.x, 1);
    EXPECT_LT(scene.errors().joint_separation_max, 0.11)
        << "the rope's slack anchors apart, no joint pulled apart";
}

}  // namespace
}  // namespace motley
