// Figures on a floor stay in lockstep. Independent evidence: weights, momenta, the joints themselves, and a step that
// measures itself, which sweeps everything by colour and must end in the same bits.
#include "fallen_figures.h"
#include "every_way.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

namespace motley {
namespace {

using testing::FallenFigures;
using testing::frame_time;
using testing::Ragdoll;

/// Sanitizers run exact joints alone, except in the test that asks for every way.
std::vector<SolverSettings> every_way(bool exact_joints_alone = testing::is_sanitized)
{
    const SolverSettings soft = testing::with_gravity({0, -9.81F, 0});
    SolverSettings iterated = soft;
    iterated.substeps = 1;
    iterated.iterations = 3;
    iterated.relaxations = 2;
    SolverSettings exact = soft;
    exact.exact_joints = true;
    exact.substeps = 2;
    SolverSettings impulse = soft;
    impulse.method = Method::sequential_impulse;
    impulse.drift_correction = DriftCorrection::baumgarte;
    impulse.iterations = 6;
    impulse.substeps = 2;
    if (exact_joints_alone) return {exact};
    return {soft, iterated, impulse, exact};
}

bool have_equal_bits(std::span<const ContactImpulse> x, std::span<const ContactImpulse> y)
{
    return x.size() == y.size() && (x.empty() || std::memcmp(x.data(), y.data(), x.size_bytes()) == 0);
}

constexpr FallenFigures::Options everything{.copies = 16 + 13, .all_touches = true, .turntable = true};

TEST(FallenFigures, HaveTheBitsOfOrdinarySweepsAfterEveryStep)
{
    for (const SolverSettings& settings : every_way(false)) {
        FallenFigures fallen(everything), ordinary = fallen;
        Solver solver(settings), reference(testing::swept(settings));
        std::size_t most = 0;
        // Sanitizers stop once all of them touch the floor.
        const int steps = testing::long_run(240, 60);
        for (int step = 0; step < steps; ++step) {
            fallen.turn();
            ordinary.turn();
            const std::vector<Contact> contacts = fallen.contacts();
            most = std::max(most, contacts.size());
            const StepReport report = solver.step(fallen.scene, frame_time, contacts);
            ASSERT_EQ(report.status, StepStatus::done) << report.error;
            ASSERT_EQ(report.joints_in_lockstep, everything.copies * Ragdoll::joints);
            ASSERT_EQ(report.contacts, static_cast<std::int64_t>(contacts.size()));
            const StepReport expected = reference.step(ordinary.scene, frame_time, contacts);
            ASSERT_EQ(expected.joints_in_lockstep, 0);
            ASSERT_EQ(report.bytes_per_constraint, expected.bytes_per_constraint);
            ASSERT_EQ(fallen.scene.state_hash(), ordinary.scene.state_hash()) << "step " << step;
            ASSERT_TRUE(have_equal_bits(fallen.scene.contact_impulses(), ordinary.scene.contact_impulses()))
                << "step " << step;
        }
        EXPECT_GT(most, 15U * everything.copies);
    }
}

/// Sixteen copies of one box, each with one contact at one corner: a block of contacts without a gap, and one of joints.
TEST(FallenFigures, HaveTheirShareInTheCountsOfBlocks)
{
    Figure figure;
    const BodyId lower = figure.add_body(testing::box({0, 0.5, 0}, 1)),
                 upper = figure.add_body(testing::box({0, 1.5, 0}, 1));
    figure.add_joint(BallSocketDefinition{lower, upper, {0, 0.5F, 0}, {0, -0.5F, 0}});
    std::vector<Placing> places;
    for (int copy = 0; copy < 16; ++copy) places.push_back({.position = {4.0 * copy, 0, 0}});
    for (const int threads : {1, 2}) {
        Scene scene;
        const std::vector<BodyId> ids = add_assembly(scene, figure, places);
        const BodyId floor = scene.ground();
        Solver solver(testing::with_gravity({0, -9.81F, 0}), {.threads = threads, .alone_below = 0});
        for (const std::size_t touching : {16U, 12U}) {
            std::vector<Contact> contacts;
            for (std::size_t copy = 0; copy < touching; ++copy) {
                Contact contact{.body_a = floor, .body_b = ids[2 * copy], .key = copy};
                contact.normal = {0, 1, 0};
                contact.arm_b = {0, -0.5F, 0};
                contacts.push_back(contact);
            }
            const StepReport report = solver.step(scene, frame_time, contacts);
            ASSERT_EQ(report.joints_in_lockstep, 16) << report.error;
            EXPECT_EQ(report.contacts, static_cast<std::int64_t>(touching));
            EXPECT_EQ(report.blocks, 2);
            EXPECT_EQ(report.lane_occupancy, static_cast<double>(16 + touching) / 32);
        }
    }
}

TEST(FallenFigures, EveryInstructionSetAndThreadCountHasTheSameBits)
{
    for (const SolverSettings& settings : every_way()) {
        const auto run = [&](const SolverOptions& options) {
            FallenFigures fallen({.copies = 48 + 11, .all_touches = true, .turntable = true});
            Solver solver(settings, options);
            std::vector<std::uint64_t> hashes;
            for (int step = 0; step < testing::long_run(90); ++step) {
                fallen.turn();
                solver.step(fallen.scene, frame_time, fallen.contacts());
                hashes.push_back(fallen.scene.state_hash());
            }
            return hashes;
        };
        testing::expect_same_bits(run);
    }
}

/// A list so long that other contacts are solved in patches.
TEST(FallenFigures, ManyHaveTheBitsOfOrdinarySweeps)
{
    if (testing::long_run(10) < 10) GTEST_SKIP() << "the tests of fewer figures access the same memory";
    const FallenFigures::Options many{.copies = 3500};
    FallenFigures fallen(many), ordinary = fallen;
    const SolverSettings settings = every_way().front();
    Solver solver(settings, {.threads = 2}), reference(testing::swept(settings), {.threads = 2});
    std::size_t most = 0;
    for (int step = 0; step < 66; ++step) {
        const std::vector<Contact> contacts = fallen.contacts();
        most = std::max(most, contacts.size());
        const StepReport report = solver.step(fallen.scene, frame_time, contacts);
        ASSERT_EQ(report.joints_in_lockstep,
                  many.copies / 16 * 16 * Ragdoll::joints +
                      (many.copies % 16 >= 8 ? many.copies % 16 : 0) * Ragdoll::joints);
        reference.step(ordinary.scene, frame_time, contacts);
        ASSERT_EQ(fallen.scene.state_hash(), ordinary.scene.state_hash()) << "step " << step;
    }
    EXPECT_GE(most, std::size_t{1} << 16U);
}

TEST(FallenFigures, ACopyThatTouchesWhatMovesOrHasTooManyContactsKeepsTheBitsOfOrdinarySweeps)
{
    for (const SolverSettings& settings : every_way()) {
        FallenFigures fallen({.copies = 40}), ordinary = fallen;
        const BodyId stone = fallen.scene.add_body(testing::box({0, 9, 0}, 5));
        ordinary.scene.add_body(testing::box({0, 9, 0}, 5));
        Solver solver(settings), reference(testing::swept(settings));
        std::vector<std::int64_t> in_lockstep;
        for (int step = 0; step < 150; ++step) {
            std::vector<Contact> contacts = fallen.contacts();
            const auto touch = [&](BodyId a, std::size_t body, std::uint64_t key) {
                Contact contact;
                contact.body_a = a;
                contact.body_b = fallen.ids[body];
                contact.key = 1000000 + key;
                contact.normal = {0, 0, 1};
                contact.separation = -0.001F;
                contact.friction = 0.5F;
                contacts.push_back(contact);
            };
            // A stone pushes copy 3; copy 20 pushes copy 21; the pelvis of copy 35 has 40 contacts more.
            if (step >= 60 && step < 70) touch(stone, 3 * Ragdoll::bodies, 0);
            if (step >= 80 && step < 90) touch(fallen.ids[20 * Ragdoll::bodies], 21 * Ragdoll::bodies, 1);
            if (step >= 100 && step < 110)
                for (std::uint64_t i = 0; i < 40; ++i)
                    touch(fallen.scene.ground(), 35 * Ragdoll::bodies, 2 + i);
            const StepReport report = solver.step(fallen.scene, frame_time, contacts);
            ASSERT_EQ(report.status, StepStatus::done) << report.error;
            reference.step(ordinary.scene, frame_time, contacts);
            ASSERT_EQ(fallen.scene.state_hash(), ordinary.scene.state_hash()) << "step " << step;
            ASSERT_TRUE(have_equal_bits(fallen.scene.contact_impulses(), ordinary.scene.contact_impulses()))
                << "step " << step;
            in_lockstep.push_back(report.joints_in_lockstep / Ragdoll::joints);
        }
        EXPECT_EQ(in_lockstep[55], 40);
        EXPECT_EQ(in_lockstep[65], 24) << "a block of 16 is swept";
        EXPECT_EQ(in_lockstep[75], 40);
        EXPECT_EQ(in_lockstep[85], 24) << "both copies are in one block";
        EXPECT_EQ(in_lockstep[105], 32) << "the last block has 8 copies";
        EXPECT_EQ(in_lockstep[120], 40);
    }
}

TEST(FallenFigures, ACopyThatComesToGriefIsFrozenAndTheOthersKeepTheirBits)
{
    for (const SolverSettings& settings : every_way()) {
        FallenFigures fallen({.copies = 16, .all_touches = true}), ordinary = fallen;
        Solver solver(settings), reference(testing::swept(settings));
        std::int64_t contained = 0;
        for (int step = 0; step < 120; ++step) {
            if (step == 60) {
                for (Scene* scene : {&fallen.scene, &ordinary.scene})
                    scene->set_force(fallen.ids[7 * Ragdoll::bodies + 2], {3e38F, 3e38F, 0}, {});
            }
            const std::vector<Contact> contacts = fallen.contacts();
            const StepReport report = solver.step(fallen.scene, frame_time, contacts);
            ASSERT_EQ(report.status, StepStatus::done) << report.error;
            if (step == 60) {
                EXPECT_EQ(report.joints_in_lockstep, Ragdoll::joints * 16);
            }
            ASSERT_EQ(report.bodies_contained,
                      reference.step(ordinary.scene, frame_time, contacts).bodies_contained);
            ASSERT_EQ(fallen.scene.state_hash(), ordinary.scene.state_hash()) << "step " << step;
            contained += report.bodies_contained;
        }
        EXPECT_GT(contained, 0);
    }
}

TEST(FallenFigures, AThousandAtRestWeighWhatTheyWeighAndHoldTogether)
{
    if (testing::long_run(10) < 10) GTEST_SKIP() << "the tests of fewer figures access the same memory";
    SolverSettings exact = testing::with_gravity({0, -9.81F, 0});
    exact.exact_joints = true;
    exact.substeps = 1;
    for (const SolverSettings& settings : {testing::with_gravity({0, -9.81F, 0}), exact}) {
        FallenFigures fallen({.copies = 1000});
        Solver solver(settings, {.threads = 2});
        constexpr int fall = 420, at_rest = 60;
        double force = 0;
        for (int step = 0; step < fall + at_rest; ++step) {
            const std::vector<Contact> contacts = fallen.contacts();
            const StepReport report = solver.step(fallen.scene, frame_time, contacts);
            ASSERT_EQ(report.status, StepStatus::done) << report.error;
            if (step < fall) continue;
            for (const ContactImpulse& impulse : fallen.scene.contact_impulses())
                force += double{impulse.normal} / frame_time / at_rest;
        }
        const double weight = 1000 * Ragdoll::mass * 9.81;
        EXPECT_NEAR(force, weight, 0.01 * weight);
        const SceneErrors errors = fallen.scene.errors();
        EXPECT_LT(errors.joint_separation_max, 1e-3) << "m";
        // A limit gives way by F / (m w^2), and with one substep w is a quarter.
        EXPECT_LT(errors.joint_angle_max, settings.exact_joints ? 0.1 : 0.01) << "rad";
        std::printf("force / weight %.5f, joints apart rms %.2g m, max %.2g m; angles rms %.2g, max %.2g\n",
                    force / weight, errors.joint_separation_rms, errors.joint_separation_max,
                    errors.joint_angle_rms, errors.joint_angle_max);
    }
}

/// Nothing drives a fallen figure, so friction and impacts bring it to rest, with its limbs within their limits. With one exact
/// substep, limits that stepped as if their two bodies were alone kept one figure of five hundred moving for ever, its shoulder
/// 0.4 rad beyond its limit, and left an elbow beyond by 2.2 rad.
TEST(FallenFigures, AllComeToRestWithinTheirLimits)
{
    if (testing::long_run(10) < 10) GTEST_SKIP() << "the tests of fewer figures access the same memory";
    SolverSettings exact = testing::with_gravity({0, -9.81F, 0});
    exact.exact_joints = true;
    exact.substeps = 1;
    for (const int run : {0, 1, 2, 3}) {
        constexpr int copies = 1000;
        const std::uint64_t seed = 1 + run % 2;
        FallenFigures fallen({.copies = copies, .seed = seed});
        exact.exact_limits = run >= 2;
        Solver solver(exact, {.threads = 2});
        constexpr int fall = 640, at_rest = 60;
        std::vector<double> energies(copies);  // J, mean over the last second
        for (int step = 0; step < fall + at_rest; ++step) {
            const StepReport report = solver.step(fallen.scene, frame_time, fallen.contacts());
            ASSERT_EQ(report.status, StepStatus::done) << report.error;
            if (step < fall) continue;
            for (std::size_t i = 0; i < fallen.ids.size(); ++i) {
                const double speed =
                    testing::length(convert<double>(fallen.scene.state(fallen.ids[i]).linear_velocity));
                energies[i / Ragdoll::bodies] +=
                    0.5 * fallen.ragdoll.masses[i % Ragdoll::bodies] * speed * speed / at_rest;
            }
        }
        const double most = *std::max_element(energies.begin(), energies.end());
        EXPECT_LT(most, 1e-3) << "J, seed " << seed;
        const double beyond = fallen.scene.errors().joint_angle_max;
        EXPECT_LT(beyond, 0.05) << "rad, seed " << seed;
        std::printf("most energy %.2g J, most beyond a limit %.2g rad\n", most, beyond);
    }
}

/// The momentum of a whole figure changes by what its weight and its contacts give, whatever its joints do.
TEST(FallenFigures, TheMomentumOfEachChangesByWeightAndContacts)
{
    for (const SolverSettings& settings : every_way()) {
        FallenFigures fallen({.copies = 16, .all_touches = true, .turntable = true});
        Solver solver(settings);
        const auto momenta = [&] {
            std::vector<Vec3<double>> of_copies(16);
            for (std::size_t i = 0; i < fallen.ids.size(); ++i) {
                const double mass = fallen.ragdoll.masses[i % Ragdoll::bodies];
                Vec3<double>& sum = of_copies[i / Ragdoll::bodies];
                sum = sum + mass * convert<double>(fallen.scene.state(fallen.ids[i]).linear_velocity);
            }
            return of_copies;
        };
        double worst = 0;
        for (int step = 0; step < testing::long_run(180, 60); ++step) {
            fallen.turn();
            const std::vector<Contact> contacts = fallen.contacts();
            std::vector<Vec3<double>> expected = momenta();
            solver.step(fallen.scene, frame_time, contacts);
            const std::span<const ContactImpulse> impulses = fallen.scene.contact_impulses();
            for (Vec3<double>& momentum : expected) momentum.y -= Ragdoll::mass * 9.81 * frame_time;
            for (std::size_t i = 0; i < contacts.size(); ++i) {
                const std::size_t body = contacts[i].key / 8;
                const double sign = contacts[i].body_b == fallen.ids[body] ? 1 : -1;
                Vec3<double>& momentum = expected[body / Ragdoll::bodies];
                momentum =
                    momentum + sign * (double{impulses[i].normal} * convert<double>(contacts[i].normal) +
                                       convert<double>(impulses[i].friction));
            }
            const std::vector<Vec3<double>> found = momenta();
            for (std::size_t copy = 0; copy < found.size(); ++copy)
                worst = std::max(worst, testing::length(found[copy] - expected[copy]));
        }
        // 61 kg at a few m/s in float, 11 bodies, tens of changes a step.
        EXPECT_LT(worst, 2e-4) << "N s";
        std::printf("worst momentum error %.2g N s\n", worst);
    }
}

}  // namespace
}  // namespace motley
