// A layout follows joints that come and go one by one. Whatever the order of changes, it must give the bits of a solver that
// has never seen the scene and lays everything out anew: that is the independent evidence.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <utility>
#include <vector>

#include "every_way.h"
#include "motley/motley.h"
#include "rig.h"

namespace motley {
namespace {

constexpr float dt = 1.0F / 60;

/// Figures of a few shapes, a net, and loose bodies of all models, whose joints and bodies come and go at random.
class Restless {
  public:
    explicit Restless(std::uint32_t seed) : random_(seed)
    {
        for (int i = 0; i < 36; ++i) add_figure(i % 3);
        add_net(12);
        for (const BodyModel model : {BodyModel::particle, BodyModel::planar, BodyModel::rigid}) {
            for (int i = 0; i < 6; ++i) bodies_.push_back(scene.add_body(body_at(model)));
        }
    }
    Scene scene;

    void change()
    {
        switch (below(9)) {
            case 0:
                add_figure(below(3));
                break;
            case 1:
                remove_figure();
                break;
            case 2:
                remove_joint();
                add_joint();
                break;
            case 3:
                add_joint();
                break;
            case 4:
                remove_joint();
                remove_joint();
                break;
            case 5:
                remove_body();
                break;
            default:
                replace_joint();
        }
    }

  private:
    struct Tie {
        ConstraintId id;
        BallSocketDefinition as;
    };
    std::mt19937 random_;
    std::vector<BodyId> bodies_;
    std::vector<std::vector<BodyId>> figures_;
    std::vector<Tie> ties_;

    int below(std::size_t n) { return static_cast<int>(random_() % n); }
    template <class T>
    std::size_t any(const std::vector<T>& of)
    {
        return random_() % of.size();
    }
    BodyDefinition body_at(BodyModel model)
    {
        BodyDefinition body;
        body.model = model;
        body.position = {below(1000) * 0.01, below(1000) * 0.01, model == BodyModel::planar ? 0 : 1.5};
        // Long, and fast enough for its inertia to turn much within a step.
        body.inertia = {0.02F, 0, 0, 0.1F, 0, 0.11F};
        if (model == BodyModel::rigid) body.angular_velocity = {1, 0, 2.0F * static_cast<float>(below(20))};
        return body;
    }
    void tie(BodyId a, BodyId b)
    {
        const auto anchor = [&](BodyId body, float x) {
            return Vec3<float>{scene.model(body) == BodyModel::particle ? 0 : x, 0, 0};
        };
        const BallSocketDefinition definition{a, b, anchor(a, 0.25F), anchor(b, -0.25F)};
        ties_.push_back({scene.add_joint(definition), definition});
    }
    /// A limit that acts about the long axis of a body.
    void limit(BodyId a, BodyId b)
    {
        TwistDriveDefinition drive;
        drive.body_a = a, drive.body_b = b;
        drive.frame_a.position = {0.25F, 0, 0}, drive.frame_b.position = {-0.25F, 0, 0};
        drive.lower = -0.01F, drive.upper = 0.01F;
        scene.add_joint(drive);
    }
    /// A chain, a chain that hangs on the ground, or one with a limb and a limit.
    void add_figure(int shape)
    {
        std::vector<BodyId> own;
        for (int i = 0; i < 4 + shape; ++i) {
            BodyDefinition body = body_at(BodyModel::rigid);
            if (i > 0) body.position = scene.state(own.back()).position + Vec3<double>{0.5, 0, 0};
            // Now and then a light body bears a heavy one, and is solved exactly by default.
            if (below(9) == 0) body.mass = 40;
            own.push_back(scene.add_body(body));
            if (i > 0) tie(own[static_cast<std::size_t>(shape == 2 && i == 3 ? 1 : i - 1)], own.back());
        }
        if (shape == 1) tie(scene.ground(), own.front());
        if (shape == 2) limit(own[0], own[1]);
        bodies_.insert(bodies_.end(), own.begin(), own.end());
        figures_.push_back(own);
    }
    void add_net(int side)
    {
        std::vector<BodyId> net;
        for (int i = 0; i < side * side; ++i) {
            net.push_back(scene.add_body(body_at(BodyModel::rigid)));
            if (i % side > 0) tie(net[static_cast<std::size_t>(i) - 1], net.back());
            if (i >= side) tie(net[static_cast<std::size_t>(i - side)], net.back());
        }
        bodies_.insert(bodies_.end(), net.begin(), net.end());
    }
    void forget_the_dead()
    {
        std::erase_if(bodies_, [&](BodyId body) { return !scene.is_alive(body); });
        std::erase_if(ties_, [&](const Tie& tie) { return !scene.is_alive(tie.id); });
    }
    void remove_figure()
    {
        if (figures_.size() < 8) return;
        const std::size_t which = any(figures_);
        for (const BodyId body : figures_[which])
            if (scene.is_alive(body)) scene.remove_body(body);
        figures_.erase(figures_.begin() + static_cast<std::ptrdiff_t>(which));
        forget_the_dead();
    }
    void remove_body()
    {
        scene.remove_body(bodies_[any(bodies_)]);
        forget_the_dead();
    }
    void remove_joint()
    {
        const std::size_t which = any(ties_);
        scene.remove_joint(ties_[which].id);
        ties_.erase(ties_.begin() + static_cast<std::ptrdiff_t>(which));
    }
    void replace_joint()
    {
        Tie& tie = ties_[any(ties_)];
        scene.remove_joint(tie.id);
        tie.id = scene.add_joint(tie.as);
    }
    void add_joint()
    {
        const BodyId a = bodies_[any(bodies_)], b = bodies_[any(bodies_)];
        if (a == b) return;
        const bool both_turn = scene.model(a) != BodyModel::particle && scene.model(b) != BodyModel::particle;
        const int type = below(both_turn ? 3 : 2);
        if (type == 0) return tie(a, b);
        if (type == 1) scene.add_joint(DistanceDefinition{.body_a = a, .body_b = b, .max_length = 20});
        if (type == 2) scene.add_joint(ManifoldDefinition{.body_a = a, .body_b = b, .friction = 0.5F});
    }
};

/// Steps two copies of a scene that changes, one with a solver that goes on and one with a new solver in each step.
void compare(Restless& restless, const SolverSettings& settings, const SolverOptions& options,
             int most_changes, int steps)
{
    Solver solver(settings, options);
    for (int step = 0; step < steps; ++step) {
        for (int change = 0; change < most_changes; ++change) restless.change();
        Scene as_new = restless.scene;
        const StepReport report = solver.step(restless.scene, dt);
        ASSERT_EQ(report.status, StepStatus::done) << report.error;
        const StepReport expected = Solver(settings).step(as_new, dt);
        ASSERT_EQ(report.joints, expected.joints) << "step " << step;
        ASSERT_EQ(report.exact_joints_refused, expected.exact_joints_refused) << "step " << step;
        ASSERT_EQ(restless.scene.state_hash(), as_new.state_hash()) << "step " << step;
    }
}

TEST(JointChanges, HaveTheBitsOfASolverThatHasNeverSeenTheScene)
{
    for (const SolverSettings& settings : testing::every_way()) {
        if (settings.method == Method::direct) continue;  // too large for it
        for (int seed = 0; seed < testing::repeats(2); ++seed) {
            Restless restless(static_cast<std::uint32_t>(7 + seed));
            compare(restless, settings, {}, 1, testing::long_run(80));
        }
    }
}

TEST(JointChanges, HaveTheSameBitsManyAtOnceAndOnTwoThreads)
{
    for (int seed = 1; seed <= testing::repeats(6); ++seed) {
        Restless restless(static_cast<std::uint32_t>(seed));
        compare(restless, {}, {.threads = 2, .alone_below = 0}, 1 + seed, testing::long_run(120, 20));
    }
}

/// A light body comes between heavy ones and goes again: its joints are refused while it is there.
TEST(JointChanges, LetJointsBeRefusedAndSolvedExactlyAgain)
{
    Scene scene;
    std::vector<BodyId> bodies;
    for (int i = 0; i < 60; ++i) {
        BodyDefinition body;
        body.position.x = i;
        body.mass = i % 3 == 1 ? 1e-7F : 1;
        body.linear_velocity = {0, 0.1F * static_cast<float>(i), 0};
        bodies.push_back(scene.add_body(body));
    }
    const auto tie = [&](std::size_t first) {
        return scene.add_joint(
            BallSocketDefinition{bodies[first], bodies[first + 1], {0.5F, 0, 0}, {-0.5F, 0, 0}});
    };
    for (std::size_t first = 0; first < bodies.size(); first += 3) tie(first);
    SolverSettings settings;
    settings.exact_joints = true;
    Solver solver(settings);
    ConstraintId second;
    for (int step = 0; step < 12; ++step) {
        if (step % 4 == 1) second = tie(16);
        if (step % 4 == 3) scene.remove_joint(second);
        Scene as_new = scene;
        const StepReport report = solver.step(scene, dt);
        Solver(settings).step(as_new, dt);
        EXPECT_EQ(report.exact_joints_refused, step % 4 == 1 || step % 4 == 2 ? 2 : 0) << step;
        EXPECT_EQ(scene.state_hash(), as_new.state_hash()) << step;
    }
}

/// Chains and pairs that fall asleep and are woken, by kicks and by changes of their joints.
TEST(JointChanges, AreFollowedWhileOthersFallAsleepAndWake)
{
    for (const bool exactly : {false, true}) {
        std::mt19937 random(17);
        const auto below = [&](std::size_t n) { return random() % n; };
        Scene scene;
        std::vector<BodyId> bodies;
        std::vector<std::pair<ConstraintId, BallSocketDefinition>> joints;
        for (int chain = 0; chain < 60; ++chain) {
            for (int i = 0; i < 2 + chain % 3; ++i) {
                BodyDefinition body;
                body.position = {0.5 * i, 0, 2.0 * chain};
                bodies.push_back(scene.add_body(body));
                if (i == 0) continue;
                const BallSocketDefinition joint{
                    bodies[bodies.size() - 2], bodies.back(), {0.25F, 0, 0}, {-0.25F, 0, 0}};
                joints.emplace_back(scene.add_joint(joint), joint);
            }
        }
        SolverSettings settings;
        settings.exact_joints = exactly;
        settings.sleep_speed = 0.1F;
        settings.sleep_after = 0.05F;
        Solver solver(settings);
        std::int64_t least = 1000, most = 0;
        for (int step = 0; step < testing::long_run(300, 60); ++step) {
            const BodyId body = bodies[below(bodies.size())];
            if (step % 3 == 0) scene.set_velocity(body, {0, 0.1F * static_cast<float>(below(5)), 0}, {});
            if (step % 7 == 0) scene.set_velocity(body, {}, {});
            if (step % 11 == 0) scene.wake(body);
            if (step % 4 == 0) {
                auto& [id, joint] = joints[below(joints.size())];
                scene.remove_joint(id);
                id = scene.add_joint(joint);
            }
            Scene as_new = scene;
            const StepReport report = solver.step(scene, dt);
            const StepReport expected = Solver(settings).step(as_new, dt);
            ASSERT_EQ(report.joints, expected.joints) << step;
            ASSERT_EQ(report.bodies_asleep, expected.bodies_asleep) << step;
            ASSERT_EQ(scene.state_hash(), as_new.state_hash()) << step;
            if (step < 20) continue;
            least = std::min(least, report.bodies_asleep);
            most = std::max(most, report.bodies_asleep);
        }
        EXPECT_GT(least, 0);
        EXPECT_LT(most, static_cast<std::int64_t>(bodies.size()));
        EXPECT_GT(most - least, 10);
    }
}

/// A file knows in which order new joints were added, and so which colours they get.
TEST(JointChanges, HaveTheSameBitsInASceneFromAFile)
{
    Restless restless(5);
    Solver solver;
    for (int step = 0; step < 60; ++step) {
        for (int change = 0; change < 4; ++change) restless.change();
        Scene loaded = load_scene(save_scene(restless.scene));
        solver.step(restless.scene, dt);
        Solver().step(loaded, dt);
        ASSERT_EQ(restless.scene.state_hash(), loaded.state_hash()) << "step " << step;
    }
}

/// Two solvers in turn step one scene, so that each finds changes that the other one has followed.
TEST(JointChanges, AreSeenByEverySolver)
{
    Restless restless(3);
    Solver first, second;
    for (int step = 0; step < 60; ++step) {
        restless.change();
        Scene as_new = restless.scene;
        (step % 3 == 0 ? first : second).step(restless.scene, dt);
        Solver().step(as_new, dt);
        ASSERT_EQ(restless.scene.state_hash(), as_new.state_hash()) << "step " << step;
    }
}

}  // namespace
}  // namespace motley
