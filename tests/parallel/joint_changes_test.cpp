// A layout follows joints that come and go one by one. Whatever the order of changes, it must give the bits of a solver that
// has never seen the scene and lays everything out anew: that is the independent evidence.
#include <gtest/gtest.h>

#include <random>
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
    /// A chain, a chain that hangs on the ground, or one with a limb.
    void add_figure(int shape)
    {
        std::vector<BodyId> own;
        for (int i = 0; i < 4 + shape; ++i) {
            BodyDefinition body = body_at(BodyModel::rigid);
            if (i > 0) body.position = scene.state(own.back()).position + Vec3<double>{0.5, 0, 0};
            own.push_back(scene.add_body(body));
            if (i > 0) tie(own[static_cast<std::size_t>(shape == 2 && i == 3 ? 1 : i - 1)], own.back());
        }
        if (shape == 1) tie(scene.ground(), own.front());
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
        compare(restless, {}, {.threads = 2}, 1 + seed, testing::long_run(120, 20));
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
