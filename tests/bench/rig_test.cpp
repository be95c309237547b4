// The program's joint scenes: their sizes against the published ones, their reference motions against conservation of
// energy, and motley's and the peers' runs against the reference motions.
#include "rig.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "engines/engine.h"
#include "worlds/box_contacts.h"
#include "worlds/rigs/mechanisms.h"

namespace motley::bench {
namespace {

Rig make(const char* name, std::int64_t bodies)
{
    return find_rig(name)->make(bodies, 12345);
}

TEST(Rigs, HaveTheirPublishedSizes)
{
    EXPECT_EQ(make("grid", 10000).bodies.size(), 10000U);
    EXPECT_EQ(make("grid", 10000).joints.size(), 19701U);
    EXPECT_EQ(make("chains", 20000).joints.size(), 20000U);
    EXPECT_EQ(make("ragdolls", 11000).bodies.size(), 11000U);
    EXPECT_EQ(make("ragdolls", 11000).joints.size(), 11000U);
    EXPECT_EQ(make("load-hanging", 11).joints.size(), 11U);
}

TEST(Rigs, StartTogether)
{
    for (const RigEntry& entry : rig_list()) {
        const Rig rig = entry.make(entry.bodies, 1);
        ASSERT_FALSE(rig.bodies.empty()) << entry.name;
        std::vector<RigPose> poses;
        for (const RigBody& body : rig.bodies) poses.push_back({body.position, {0, 0, 0, 1}});
        EXPECT_LT(separation_of(rig, poses).max, 1e-12) << entry.name;
        if (rig.truth) {
            EXPECT_LT(rig.truth(poses, 0), 1e-12) << entry.name;
        }
    }
}

/// Kinetic and potential energy of the double pendulum in minimal coordinates, written independently.
double energy_of_double_pendulum(const std::array<double, 2>& angle, const std::array<double, 2>& rate)
{
    const double upper_x = 0.5 * std::cos(angle[0]) * rate[0], upper_y = 0.5 * std::sin(angle[0]) * rate[0];
    const double lower_x = std::cos(angle[0]) * rate[0] + 0.5 * std::cos(angle[1]) * rate[1];
    const double lower_y = std::sin(angle[0]) * rate[0] + 0.5 * std::sin(angle[1]) * rate[1];
    const double turning = (rate[0] * rate[0] + rate[1] * rate[1]) / 24;
    const double height = -0.5 * std::cos(angle[0]) - std::cos(angle[0]) - 0.5 * std::cos(angle[1]);
    return 0.5 * (upper_x * upper_x + upper_y * upper_y + lower_x * lower_x + lower_y * lower_y) + turning +
           9.81 * height;
}

TEST(Rigs, TruthOfTheDoublePendulumKeepsItsEnergy)
{
    // The acceleration must not change the energy in any state: differences of the energy along the motion.
    constexpr double h = 1e-6;
    for (int i = 0; i < 20; ++i) {
        const Motion<2>::State s{{0.7 * i, 3 - 1.1 * i}, {2 - 0.3 * i, 0.4 * i}};
        const auto acceleration = double_pendulum_acceleration(s);
        const auto energy_at = [&](double time) {
            return energy_of_double_pendulum(
                {s.angle[0] + time * s.rate[0], s.angle[1] + time * s.rate[1]},
                {s.rate[0] + time * acceleration[0], s.rate[1] + time * acceleration[1]});
        };
        EXPECT_NEAR((energy_at(h) - energy_at(-h)) / (2 * h), 0, 1e-6 * (1 + std::abs(energy_at(0)))) << i;
    }
}

TEST(Rigs, TruthsAreIntegratedToTwelveDigits)
{
    const Motion<1> fall({0.3}, 1, [](const Motion<1>::State&) { return std::array<double, 1>{-9.81}; });
    EXPECT_NEAR(fall.at(1)[0], 0.3 - 9.81 / 2, 1e-12);
    const Motion<1> spring({1.0}, 10,
                           [](const Motion<1>::State& s) { return std::array<double, 1>{-s.angle[0]}; });
    EXPECT_NEAR(spring.at(10)[0], std::cos(10.0), 1e-12);
}

/// The error of a rig in an engine, rms over its steps.
double error_of(const Rig& rig, Engine& engine, int steps)
{
    std::vector<RigPose> poses(rig.bodies.size());
    double squares = 0;
    for (int step = 1; step <= steps; ++step) {
        engine.step(1.0F / 60);
        engine.read(poses);
        const double error = rig.truth(poses, step / 60.0);
        squares += error * error;
    }
    return std::sqrt(squares / steps);
}

TEST(Rigs, MotleyConvergesToTheTruthsAsSubstepsGrow)
{
    // Semi-implicit Euler is of first order: with sixteen times the substeps the error is about a sixteenth.
    for (const char* name : {"pendulum", "double-pendulum", "four-bar"}) {
        const Rig rig = make(name, 1);
        double errors[2];
        int i = 0;
        for (const int substeps : {16, 256}) {
            SolverSettings settings;
            settings.substeps = substeps;
            settings.joint_hertz = 1e6F;
            errors[i++] = error_of(rig, *make_motley_engine(rig, settings, {}), 60);
        }
        EXPECT_LT(errors[1], errors[0] / 8) << name;
        EXPECT_LT(errors[1], 5e-4) << name;
    }
}

TEST(Rigs, PeersComeNearTheTruths)
{
    // This does not judge the peers; it shows that their rigs are the same.
    for (const Peer& peer : peers()) {
        for (const char* name : {"pendulum", "double-pendulum", "four-bar"}) {
            const Rig rig = make(name, 1);
            const PeerSetting setting{"fine", 100, 0.2F, 32, false};
            EXPECT_LT(error_of(rig, *peer.make(rig, setting), 60), 5e-3) << peer.name << " " << name;
        }
    }
}

TEST(Rigs, EveryEngineHoldsRagdollsWithinTheirLimits)
{
    const Rig rig = make("ragdolls", 110);
    std::vector<std::unique_ptr<Engine>> engines;
    SolverSettings settings;
    settings.substeps = 8;
    engines.push_back(make_motley_engine(rig, settings, {}));
    for (const Peer& peer : peers()) engines.push_back(peer.make(rig, {"fine", 50, 0.8F, 8, false}));
    for (const auto& engine : engines) {
        std::vector<RigPose> poses(rig.bodies.size());
        for (int step = 0; step < 120; ++step) engine->step(1.0F / 60);
        engine->read(poses);
        EXPECT_LT(separation_of(rig, poses).max, 0.02);
        for (const RigJoint& joint : rig.joints) {
            if (joint.tie != RigTie::hinge) continue;
            // The angle between two hinged limbs is that of their relative rotation.
            const auto a = static_cast<std::size_t>(joint.a), b = static_cast<std::size_t>(joint.b);
            const Quat<double> turn = conjugate(poses[a].orientation) * poses[b].orientation;
            EXPECT_LT(2 * std::acos(std::min(1.0, std::abs(turn.w))),
                      static_cast<double>(joint.upper) + 0.15);
        }
    }
}

TEST(Rigs, CopiesMoveAsTheirOriginal)
{
    const Rig one = make("four-bar", 3), many = make("four-bar", 30);
    SolverSettings settings;
    const double alone = error_of(one, *make_motley_engine(one, settings, {}), 30);
    EXPECT_NEAR(error_of(many, *make_motley_engine(many, settings, {}), 30), alone, 1e-6);
}

TEST(BoxContacts, OfAPyramidAtRest)
{
    const Rig rig = make("pyramid", 6);
    ASSERT_EQ(rig.bodies.size(), 6U);
    Scene scene;
    BoxContacts boxes(rig, add_rig(scene, rig));
    std::vector<RigPose> poses;
    for (const RigBody& body : rig.bodies) poses.push_back({body.position, {0, 0, 0, 1}});
    const auto contacts = boxes.find(poses, scene.ground());
    // Three boxes on the floor have four corners each; each of the three boxes on two others has four points with
    // each pair. Boxes side by side are 2 cm apart, and rounding decides whether that is within the margin: contacts
    // that push sideways are not counted.
    int upwards = 0;
    std::set<std::uint64_t> keys;
    for (const Contact& contact : contacts) {
        upwards += std::abs(contact.normal.y) > 0.9F ? 1 : 0;
        keys.insert(contact.key);
        EXPECT_LT(std::abs(contact.separation), 0.021F);
    }
    EXPECT_EQ(upwards, 3 * 4 + 3 * 2 * 4);
    EXPECT_EQ(keys.size(), contacts.size());
}

}  // namespace
}  // namespace motley::bench
