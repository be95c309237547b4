// Promise 1: equal input and settings give equal bits for every instruction set, number of threads and compiler.
// Independent evidence: the scalar path is the same maths on float; golden hashes tie the builds of g++ and clang to
// each other.
#include <gtest/gtest.h>

#include "joint_scene.h"
#include "rig.h"

namespace motley {
namespace {

using testing::MixedScene;

constexpr int golden_steps = 300;
constexpr int steps_of_each = testing::long_run(golden_steps, 10);
constexpr float dt = 1.0F / 60;

struct Way {
    const char* name;
    SolverSettings settings;
    std::uint64_t golden;  ///< of the state after `golden_steps`, from the first build that had it
};

#ifdef __EMSCRIPTEN__
// WebAssembly cannot take denormals for zero. x86 without the flags of float_environment.h makes these hashes too.
constexpr std::uint64_t golden_of_projection = 15141545631632701481ULL;
constexpr std::uint64_t goldens_of_joints[] = {16641942690327985438ULL, 5949572519813984265ULL,
                                               9170620323481159938ULL, 2923570952597301938ULL};
#else
constexpr std::uint64_t golden_of_projection = 12600455655897062784ULL;
constexpr std::uint64_t goldens_of_joints[] = {2274434173113477618ULL, 13718648614058717832ULL,
                                               12057534720706406688ULL, 749867953405811242ULL};
#endif

std::vector<Way> ways()
{
    SolverSettings soft;
    soft.gravity = {0, -9.81F, 0};
    SolverSettings iterative = soft;
    iterative.method = Method::sequential_impulse;
    iterative.drift_correction = DriftCorrection::baumgarte;
    iterative.substeps = 1;
    iterative.iterations = 10;
    SolverSettings none = iterative, projection = iterative;
    none.drift_correction = DriftCorrection::none;
    projection.drift_correction = DriftCorrection::projection;
    return {{"soft_step", soft, 11220186639852722211ULL},
            {"baumgarte", iterative, 8677351179348254354ULL},
            {"no drift correction", none, 10831977531164320898ULL},
            {"projection", projection, golden_of_projection}};
}

/// The state's hash after every step.
std::vector<std::uint64_t> run(const SolverSettings& settings, const SolverOptions& options,
                               int steps = steps_of_each)
{
    MixedScene mixed;
    Solver solver(settings, options);
    std::vector<std::uint64_t> hashes;
    for (int step = 0; step < steps; ++step) {
        const StepReport report = solver.step(mixed.scene, dt, mixed.contacts());
        EXPECT_EQ(report.status, StepStatus::done) << report.error;
        EXPECT_EQ(report.bodies_contained, 0) << "step " << step;
        hashes.push_back(mixed.scene.state_hash());
    }
    return hashes;
}

TEST(SameBits, EveryInstructionSetMatchesScalarAfterEveryStep)
{
    for (const Way& way : ways()) {
        const auto scalar = run(way.settings, {.isa = Isa::scalar});
        for (const Isa isa : available_isas()) {
            EXPECT_EQ(run(way.settings, {.isa = isa}), scalar) << way.name << " on " << isa_name(isa);
        }
    }
}

TEST(SameBits, ThreadCountDoesNotChangeAnyStep)
{
    for (const Way& way : ways()) {
        const auto one = run(way.settings, {.threads = 1});
        for (const int threads : {2, 3, 4}) {
            EXPECT_EQ(run(way.settings, {.threads = threads, .alone_below = 0}), one)
                << way.name << " on " << threads << " threads";
        }
    }
}

/// Like run(), for every type of joint between every pair of body kinds.
std::vector<std::uint64_t> run_joints(const SolverSettings& settings, const SolverOptions& options,
                                      int steps = steps_of_each)
{
    testing::JointScene joints;
    Solver solver(settings, options);
    std::vector<std::uint64_t> hashes;
    for (int step = 0; step < steps; ++step) {
        const StepReport report = solver.step(joints.scene, dt);
        EXPECT_EQ(report.status, StepStatus::done) << report.error;
        EXPECT_EQ(report.bodies_contained, 0) << "step " << step;
        hashes.push_back(joints.scene.state_hash());
    }
    return hashes;
}

TEST(SameBits, EveryJointTypeMatchesScalarOnEveryInstructionSetAndThreadCountAfterEveryStep)
{
    for (const Way& way : ways()) {
        const auto scalar = run_joints(way.settings, {.isa = Isa::scalar});
        for (const Isa isa : available_isas()) {
            EXPECT_EQ(run_joints(way.settings, {.isa = isa}), scalar) << way.name << " on " << isa_name(isa);
        }
        for (const int threads : {2, 3}) {
            EXPECT_EQ(run_joints(way.settings, {.threads = threads, .alone_below = 0}), scalar)
                << way.name << " on " << threads << " threads";
        }
    }
}

/// In CI g++ makes them in a Release build, and clang in one with sanitizers.
TEST(SameBits, CompilersAgreeOnTheGoldenHash)
{
    for (const Way& way : ways())
        EXPECT_EQ(run(way.settings, {}, golden_steps).back(), way.golden) << way.name;
}

TEST(SameBits, CompilersAgreeOnTheGoldenHashOfEveryJointType)
{
    std::size_t number = 0;
    for (const Way& way : ways()) {
        EXPECT_EQ(run_joints(way.settings, {}, golden_steps).back(), goldens_of_joints[number++])
            << way.name
            << ": this build makes other bits than the one that the golden hash is of. Where a type of "
            << "constraint, its cases or its maths have changed on purpose, every build has to make the new "
               "one.";
        if (testing::is_sanitized) break;
    }
}

TEST(SameBits, ACopiedSceneGoesOnLikeTheOriginal)
{
    MixedScene original;
    SolverSettings settings;
    settings.gravity = {0, -9.81F, 0};
    Solver solver(settings);
    for (int step = 0; step < 50; ++step) solver.step(original.scene, dt, original.contacts());
    MixedScene copy = original;
    Solver other(settings, {.threads = 2, .alone_below = 0});
    for (int step = 0; step < 50; ++step) {
        solver.step(original.scene, dt, original.contacts());
        other.step(copy.scene, dt, copy.contacts());
        ASSERT_EQ(original.scene.state_hash(), copy.scene.state_hash()) << "step " << step;
    }
}

/// A net wide enough that its colours have many chunks, so that several threads work on one colour.
Scene net(int side)
{
    Scene scene;
    testing::Random random;
    std::vector<BodyId> ids;
    for (int k = 0; k < side; ++k) {
        for (int i = 0; i < side; ++i) {
            BodyDefinition body;
            body.position = {static_cast<double>(k), -static_cast<double>(i), 0};
            body.inertia = {0.064F, 0, 0, 0.064F, 0, 0.064F};
            if (i == 0) body.motion = BodyMotion::static_body;
            if (i > 0) body.linear_velocity.z = static_cast<float>(0.5 * random.symmetric());
            ids.push_back(scene.add_body(body));
        }
    }
    const auto at = [&](int k, int i) { return ids[static_cast<std::size_t>(k * side + i)]; };
    for (int k = 0; k < side; ++k) {
        for (int i = 1; i < side; ++i) {
            scene.add_joint(BallSocketDefinition{at(k, i - 1), at(k, i), {0, -0.5F, 0}, {0, 0.5F, 0}});
            if (k > 0)
                scene.add_joint(BallSocketDefinition{at(k - 1, i), at(k, i), {0.5F, 0, 0}, {-0.5F, 0, 0}});
        }
    }
    return scene;
}

/// Bodies are renumbered now and then, also after some have been removed and left gaps.
TEST(SameBits, RenumberedBodiesGoOnLikeTheOthers)
{
    SolverSettings exact;
    exact.gravity = {0, -9.81F, 0};
    exact.exact_joints = true;
    std::vector<Way> all = ways();
    all.push_back({"exact joints", exact, 0});
    for (const Way& way : all) {
        MixedScene plain, moved;
        Solver solver(way.settings), of_moved(way.settings);
        for (int step = 0; step < 120; ++step) {
            for (MixedScene* mixed : {&plain, &moved}) {
                if (step == 50 || step == 80) {
                    for (int i = 0; i < 6; ++i) {
                        const std::size_t which = mixed->balls.size() / 2;
                        mixed->scene.remove_body(mixed->balls[which]);
                        mixed->balls.erase(mixed->balls.begin() + static_cast<std::ptrdiff_t>(which));
                    }
                    BodyDefinition ball;
                    ball.model = BodyModel::planar;
                    ball.position = {1, 8, 0};
                    mixed->balls.push_back(mixed->scene.add_body(ball));
                }
            }
            if (step % 25 == 0) moved.scene.renumber_bodies();
            for (auto [mixed, by] : {std::pair{&plain, &solver}, std::pair{&moved, &of_moved}})
                ASSERT_EQ(by->step(mixed->scene, dt, mixed->contacts()).status, StepStatus::done);
            ASSERT_EQ(moved.scene.state_hash(), plain.scene.state_hash()) << way.name << ", step " << step;
        }
    }
}

TEST(SameBits, AWideNetIsTheSameOnOneToFourThreads)
{
    SolverSettings settings;
    settings.gravity = {0, -9.81F, 0};
    const Scene start = net(testing::is_sanitized ? 20 : 60);
    std::vector<std::uint64_t> one;
    for (int threads = 1; threads <= 4; ++threads) {
        Scene scene = start;
        Solver solver(settings, {.threads = threads, .alone_below = 0});
        for (int step = 0; step < steps_of_each; ++step) {
            solver.step(scene, dt);
            if (threads == 1) one.push_back(scene.state_hash());
            ASSERT_EQ(scene.state_hash(), one[static_cast<std::size_t>(step)])
                << threads << " threads, step " << step;
        }
    }
}

}  // namespace
}  // namespace motley
