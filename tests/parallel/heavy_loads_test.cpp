// Which figures are solved exactly by default: those in which light bodies bear heavy ones. Independent evidence: statics (the
// pull of a joint is the weight of all below it), conservation of momenta, and the bits of settings that say the same.
#include <limits>

#include "level_arm.h"
#include "loaded_chain.h"

namespace motley {
namespace {

using testing::ChainStart;
using testing::frame_time;
using testing::LoadedChain;

constexpr float never = std::numeric_limits<float>::infinity();

SolverSettings above(float ratio)
{
    SolverSettings settings = testing::with_gravity({0, -static_cast<float>(LoadedChain::g), 0});
    settings.exact_above_ratio = ratio;
    return settings;
}

TEST(HeavyLoads, HangByTheWeightOfAllThatIsBelow)
{
    for (const double load : {11.0, 1e2, 1e3, 1e4, 1e5, 1e6}) {
        Scene scene;
        LoadedChain chain(scene);
        chain.hang(ChainStart::hanging, load);
        Solver solver(above(SolverSettings{}.exact_above_ratio));
        for (int step = 0; step < 60; ++step) solver.step(scene, frame_time);
        double below = 0;
        for (std::size_t i = chain.joints.size(); i-- > 0;) {
            below += chain.masses[i] * LoadedChain::g;
            const Vec3<double> force = convert<double>(scene.joint_report(chain.joints[i]).force);
            EXPECT_NEAR(testing::length(force), below, 1e-4 * below) << load << " kg, joint " << i;
        }
        EXPECT_LT(chain.separation(), 1e-6) << load;
    }
}

/// More links than a figure that is swept in lockstep may have.
TEST(HeavyLoads, HangByLongRopes)
{
    constexpr int links = 150;
    constexpr double mass = 1000, length = 0.2;
    Scene scene;
    BodyId before = scene.ground();
    std::vector<ConstraintId> joints;
    for (int i = 0; i <= links; ++i) {
        BodyDefinition body;
        body.position = {0, -length * (i + 0.5), 0};
        body.mass = i == links ? static_cast<float>(mass) : 1;
        const float inertia = 0.01F * body.mass;
        body.inertia = {inertia, 0, 0, inertia, 0, inertia};
        const BodyId link = scene.add_body(body);
        BallSocketDefinition joint{before, link};
        if (i > 0) joint.local_anchor_a = {0, -0.1F, 0};
        joint.local_anchor_b = {0, 0.1F, 0};
        joints.push_back(scene.add_joint(joint));
        before = link;
    }
    scene.set_velocity(before, {0.5F, 0, 0}, {});
    Solver solver(above(SolverSettings{}.exact_above_ratio));
    for (int step = 0; step < 300; ++step) ASSERT_EQ(solver.step(scene, frame_time).status, StepStatus::done);
    EXPECT_LT(scene.errors().joint_separation_max, 1e-3);
}

/// A few bodies in a row, with these masses, in kg. A mass of 0 is a static body.
struct Row {
    Scene scene;
    std::vector<BodyId> bodies;
};
Row row_of(const std::vector<float>& masses)
{
    Row row;
    for (std::size_t i = 0; i < masses.size(); ++i) {
        BodyDefinition body;
        body.position = {static_cast<double>(i), 0, 0};
        if (masses[i] == 0) {
            body.motion = BodyMotion::static_body;
        } else {
            body.mass = masses[i];
            const float inertia = 0.1F * body.mass;
            body.inertia = {inertia, 0, 0, inertia, 0, inertia};
            body.linear_velocity = {0.1F * static_cast<float>(i), 0.3F, 0};
        }
        row.bodies.push_back(row.scene.add_body(body));
        if (i == 0) continue;
        row.scene.add_joint(
            BallSocketDefinition{row.bodies[i - 1], row.bodies[i], {0.5F, 0, 0}, {-0.5F, 0, 0}});
    }
    return row;
}

std::uint64_t hash_after(Scene scene, const SolverSettings& settings)
{
    Solver solver(settings);
    for (int step = 0; step < 30; ++step) solver.step(scene, frame_time);
    return scene.state_hash();
}

TEST(HeavyLoads, AreTheOnlyOnesSolvedExactly)
{
    struct Case {
        const char* what;
        std::vector<float> masses;
        bool bears_load;
    };
    const Case cases[] = {
        {"a chain of like links that hangs", {0, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1}, false},
        {"a bridge between two walls", {0, 1, 1, 1, 1, 0}, false},
        {"light limbs of a heavy body", {1, 1, 1, 40, 1, 1}, false},
        {"a load of nine times the mass", {0, 1, 9}, false},
        {"a load of eleven times the mass", {0, 1, 11}, true},
        {"a load at the end of a rope", {0, 1, 1, 1, 11}, true},
        {"a load in the middle of a bridge", {0, 1, 1, 30, 1, 1, 0}, true},
        {"a light body between two heavy ones", {15, 1, 15}, true},
        {"a light body between a heavy one and one that is not", {15, 1, 5}, false},
        {"a load that hangs on a wall without links", {0, 100}, false},
    };
    for (const Case& each : cases) {
        SolverSettings exact = above(never);
        exact.exact_joints = true;
        const Scene scene = row_of(each.masses).scene;
        const std::uint64_t by_default = hash_after(scene, above(10));
        EXPECT_EQ(by_default, hash_after(scene, each.bears_load ? exact : above(never))) << each.what;
        EXPECT_NE(hash_after(scene, exact), hash_after(scene, above(never))) << each.what;
    }
}

TEST(HeavyLoads, OfOneFigureLeaveOthersSwept)
{
    const Row row = row_of({0, 1, 1, 1});
    Scene both = row.scene, alone = row.scene;
    LoadedChain chain(both);
    chain.hang(ChainStart::hanging, 1000, 5);
    Solver solver(above(10)), solver_alone(above(10));
    for (int step = 0; step < 30; ++step) {
        solver.step(both, frame_time);
        solver_alone.step(alone, frame_time);
    }
    for (const BodyId body : row.bodies) {
        const Vec3<double> apart = both.state(body).position - alone.state(body).position;
        EXPECT_EQ(testing::length(apart), 0);
        EXPECT_EQ(both.state(body).angular_velocity.x, alone.state(body).angular_velocity.x);
    }
    EXPECT_LT(chain.separation(), 1e-6);
}

/// Limits of such figures bear the load too.
TEST(HeavyLoads, LeanOnLimits)
{
    for (const double mass : {11.0, 1e3, 1e4}) {
        TwistDriveDefinition drive;
        drive.lower = 0, drive.upper = 1;
        testing::Arm arm = testing::arm_of(5, mass, drive);
        Solver solver(above(10));
        testing::run(arm.scene, solver, 1);
        testing::expect_held_level(arm, ::testing::Message() << mass << " kg");
    }
}

/// The tree holds the rotors of the joints that it locks, also those that come later.
TEST(HeavyLoads, AreHeldWithTheirRotors)
{
    SolverSettings exact = above(never);
    exact.exact_joints = true;
    for (const bool has_rotor : {false, true}) {
        testing::Arm arm = testing::arm_of(2, 100, {.armature = has_rotor ? 0.5F : 0});
        const std::uint64_t by_default = hash_after(arm.scene, above(10));
        EXPECT_EQ(by_default, hash_after(arm.scene, exact));
        EXPECT_NE(by_default, hash_after(arm.scene, above(never)));
        TwistDriveDefinition changed = arm.definitions.front();
        changed.armature = has_rotor ? 0 : 0.5F;
        Solver solver(above(10)), other(above(10));
        solver.step(arm.scene, frame_time);
        arm.scene.set_joint(arm.drives.front(), changed);
        Scene as_new = arm.scene;
        solver.step(arm.scene, frame_time);
        other.step(as_new, frame_time);
        EXPECT_EQ(arm.scene.state_hash(), as_new.state_hash());
    }
}

/// A rotor weighs as much as a load: K I_r, with the response K of the two bodies that it turns.
TEST(HeavyLoads, MayBeRotors)
{
    const auto arm_with = [](std::size_t joint, float rotor) {
        testing::Arm arm = testing::arm_of(3, 1, {});
        TwistDriveDefinition geared = arm.definitions[joint];
        geared.armature = rotor;
        arm.scene.set_joint(arm.drives[joint], geared);
        return arm;
    };
    const float inertia = 0.021F;  // of a link about z
    struct Case {
        std::size_t joint;
        float rotor;
        bool is_heavy;
    };
    for (const auto& [joint, rotor, is_heavy] :
         {Case{0, 9.9F * inertia, false}, Case{0, 10.1F * inertia, true}, Case{1, 4.9F * inertia, false},
          Case{1, 5.1F * inertia, true}}) {
        const Scene scene = arm_with(joint, rotor).scene;
        SolverSettings exact = above(never);
        exact.exact_joints = true;
        EXPECT_EQ(hash_after(scene, above(10)), hash_after(scene, is_heavy ? exact : above(never)))
            << joint << " " << rotor;
        EXPECT_NE(hash_after(scene, exact), hash_after(scene, above(never)));
    }
    // It gets heavy, and light again.
    testing::Arm arm = arm_with(1, 0.01F);
    Solver solver(above(10));
    for (int step = 0; step < 12; ++step) {
        TwistDriveDefinition geared = arm.definitions[1];
        geared.armature = step % 6 < 3 ? 0.01F : 1.0F;
        arm.scene.set_joint(arm.drives[1], geared);
        Scene as_new = arm.scene;
        solver.step(arm.scene, frame_time);
        Solver(above(10)).step(as_new, frame_time);
        ASSERT_EQ(arm.scene.state_hash(), as_new.state_hash()) << step;
    }
}

/// Beside exact locks a sweep throws a light body that turns a heavier rotor, so figures with a rotor that no lock of the tree is
/// beside are swept.
TEST(HeavyLoads, AreSweptWhereARotorIsBesideTheTree)
{
    for (const bool has_rotor : {false, true}) {
        testing::Arm arm = testing::arm_of(2, 100, {});
        TwistDriveDefinition over_two = arm.definitions.front();
        over_two.body_b = arm.links.back();
        over_two.armature = has_rotor ? 0.5F : 0;
        arm.scene.add_joint(over_two);
        const bool is_swept = hash_after(arm.scene, above(never)) == hash_after(arm.scene, above(10));
        EXPECT_EQ(is_swept, has_rotor);
    }
}

/// A rope of 51 links with a load at its end, which becomes longer than most_bodies and loses its hook and its load, is followed as
/// if it were laid out anew each time.
TEST(HeavyLoads, ComeAndGo)
{
    Scene scene;
    std::vector<BodyId> bodies;
    for (int i = 0; i < 100; ++i) {
        BodyDefinition body;
        body.position = {0.5 * i, 0, 0};
        body.mass = i == 50 ? 30 : 1;
        bodies.push_back(scene.add_body(body));
    }
    const auto tie = [&](std::size_t a, std::size_t b) {
        return scene.add_joint(BallSocketDefinition{bodies[a], bodies[b], {0.25F, 0, 0}, {-0.25F, 0, 0}});
    };
    for (std::size_t i = 1; i < bodies.size(); ++i)
        if (i != 51) tie(i - 1, i);
    BallSocketDefinition hook{scene.ground(), bodies[0]};
    hook.local_anchor_b = {-0.25F, 0, 0};
    ConstraintId upper = scene.add_joint(hook);
    Solver solver(above(10));
    for (int step = 0; step < 24; ++step) {
        if (step % 6 == 2) scene.remove_joint(upper);
        if (step % 6 == 5) upper = scene.add_joint(hook);
        if (step == 9) tie(50, 51);
        if (step == 16) scene.set_mass(bodies[50], 5, BodyDefinition{}.inertia);
        Scene as_new = scene;
        solver.step(scene, frame_time);
        Solver(above(10)).step(as_new, frame_time);
        ASSERT_EQ(scene.state_hash(), as_new.state_hash()) << step;
    }
}

}  // namespace
}  // namespace motley
