// Promise 1 for contacts that the library finds: equal bits for every instruction set, number of threads and order of
// people, and after a copy, a file and a renumbering. Independent evidence: the scalar path.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstring>
#include <numeric>

#include "disc_crowd.h"
#include "rig.h"
#include "scene/scene_core.h"

namespace motley {
namespace {

using testing::DiscCrowd;
using testing::DiscCrowdOptions;
using testing::Random;

constexpr float dt = 1.0F / 60;
constexpr int steps = testing::long_run(90);

/// The state of each person in the order of `people`, hashed with FNV-1a.
std::uint64_t hash_of(const DiscCrowd& crowd)
{
    std::uint64_t hash = 1469598103934665603ULL;
    const auto add = [&](const auto& value) {
        unsigned char bytes[sizeof value];
        std::memcpy(bytes, &value, sizeof value);
        for (const unsigned char byte : bytes) hash = (hash ^ byte) * 1099511628211ULL;
    };
    for (const BodyId person : crowd.people) {
        const BodyState state = crowd.scene.state(person);
        add(state.position.x);
        add(state.position.y);
        add(state.yaw);
        add(state.linear_velocity.x);
        add(state.linear_velocity.y);
        add(state.angular_velocity.z);
    }
    return hash;
}

std::vector<std::uint64_t> run(DiscCrowd crowd, const SolverSettings& settings, const SolverOptions& options)
{
    Solver solver(settings, options);
    std::vector<std::uint64_t> hashes;
    for (int step = 0; step < steps; ++step) {
        if (step % 10 == 0) crowd.pull_together(200);
        const StepReport report = solver.step(crowd.scene, dt);
        EXPECT_EQ(report.status, StepStatus::done) << report.error;
        EXPECT_GT(report.disc_contacts, 0);
        hashes.push_back(hash_of(crowd));
    }
    return hashes;
}

TEST(DiscBits, AreEqualForEveryInstructionSetAndNumberOfThreads)
{
    for (const float friction : {0.0F, 0.4F}) {
        for (const Method method : {Method::soft_step, Method::sequential_impulse}) {
            const DiscCrowd crowd({.people = testing::is_sanitized ? 600 : 2500, .friction = friction});
            const SolverSettings settings{.method = method};
            const auto scalar = run(crowd, settings, {.isa = Isa::scalar});
            for (const Isa isa : available_isas()) {
                for (const int threads : {1, 2, 3}) {
                    if (isa == Isa::scalar && threads == 1) continue;
                    EXPECT_EQ(run(crowd, settings, {.threads = threads, .alone_below = 0, .isa = isa}),
                              scalar)
                        << isa_name(isa) << " x " << threads << ", friction " << friction;
                }
            }
        }
    }
}

TEST(DiscBits, DoNotDependOnTheOrderInWhichPeopleAreAdded)
{
    const DiscCrowdOptions options{.people = 1500, .friction = 0.3F};
    std::vector<int> order(static_cast<std::size_t>(options.people));
    std::iota(order.begin(), order.end(), 0);
    Random random;
    for (std::size_t i = order.size(); i > 1; --i)
        std::swap(order[i - 1], order[static_cast<std::size_t>(random.below(static_cast<int>(i)))]);
    EXPECT_EQ(run(DiscCrowd(options), {}, {}),
              run(DiscCrowd(options, order), {}, {.threads = 2, .alone_below = 0}));
}

/// A copy, a file and a renumbering at any step continue as the scene itself does.
TEST(DiscBits, ContinueFromCopiesFilesAndNewRows)
{
    DiscCrowd crowd({.people = 900, .friction = 0.3F});
    BodyDefinition arm;
    arm.motion = BodyMotion::kinematic_body;
    arm.position = {crowd.side / 2, crowd.side / 2, 0};
    arm.angular_velocity = {0, 0, 0.5F};
    const BodyId door = crowd.scene.add_body(arm);
    const Vec2<double> ends[] = {{-2, 0}, {2, 0}};
    crowd.scene.add_wall({.points = ends, .body = door, .friction = 0.2F});
    Solver solver(SolverSettings{}), other(SolverSettings{});
    const std::string file = ::testing::TempDir() + "disc_bits.motley";
    bool found_late = false;  // discs that left their skins between searches of all
    for (int step = 0; step < 60; ++step) {
        found_late = found_late || !core_of(crowd.scene).discs.late.empty();
        DiscCrowd copy = crowd;
        if (step % 3 == 1) {
            save_scene(crowd.scene, file);
            copy.scene = load_scene(file);
        }
        if (step % 3 == 2) copy.scene.renumber_bodies();
        for (int more = 0; more < 3; ++more) {
            ASSERT_EQ(other.step(copy.scene, dt).status, StepStatus::done);
        }
        if (step % 5 == 0) {
            DiscCrowd same = crowd;
            for (int more = 0; more < 3; ++more)
                ASSERT_EQ(solver.step(same.scene, dt).status, StepStatus::done);
            ASSERT_EQ(hash_of(same), hash_of(copy)) << "from step " << step;
            EXPECT_EQ(same.scene.disc_contacts().size(), copy.scene.disc_contacts().size());
        }
        ASSERT_EQ(solver.step(crowd.scene, dt).status, StepStatus::done);
    }
    EXPECT_TRUE(found_late);
    std::remove(file.c_str());
}

/// A new solver makes again where the discs were found last, also when bodies without discs have been added since. Where the
/// vector of these places was full, memory behind it was read.
TEST(DiscBits, ContinueFromCopiesWithBodiesWithoutDiscs)
{
    DiscCrowd crowd({.people = 400});
    Solver solver;
    const SceneCore& core = core_of(crowd.scene);
    bool reached = false;  // discs left their skins when there were more bodies than places
    for (int step = 0; step < 60; ++step) {
        for (int i = 0; i < 60; ++i) crowd.scene.add_body(testing::person_at(1000 + step, 2 * i));
        const bool has_more = core.bodies.rows(BodyKind::planar).size() > core.discs.found_at.size();
        Scene copy = crowd.scene;
        ASSERT_EQ(solver.step(crowd.scene, dt).status, StepStatus::done);
        ASSERT_EQ(Solver().step(copy, dt).status, StepStatus::done);
        ASSERT_EQ(copy.state_hash(), crowd.scene.state_hash()) << "step " << step;
        reached = reached || (has_more && step > 0 && !core.discs.late.empty());
    }
    EXPECT_TRUE(reached);
}

/// People who come, go, are moved and change their shape.
TEST(DiscBits, SurviveComingAndGoing)
{
    DiscCrowd crowd({.people = 600, .spacing = 0.5});
    Solver solver(SolverSettings{}, {.threads = 2, .alone_below = 0});
    Random random;
    for (int step = 0; step < testing::long_run(300); ++step) {
        const auto who = static_cast<std::size_t>(random.below(static_cast<int>(crowd.people.size())));
        const Vec3<double> somewhere{crowd.side * (0.05 + 0.45 * (1 + random.symmetric())),
                                     crowd.side * (0.05 + 0.45 * (1 + random.symmetric())), 0};
        switch (step % 4) {
            case 0:
                crowd.scene.remove_body(crowd.people[who]);
                crowd.people.erase(crowd.people.begin() + static_cast<std::ptrdiff_t>(who));
                crowd.discs.erase(crowd.discs.begin() + static_cast<std::ptrdiff_t>(who));
                break;
            case 1: {
                BodyDefinition body;
                body.model = BodyModel::planar;
                body.position = somewhere;
                body.mass = 70;
                body.inertia.zz = 1.4F;
                crowd.people.push_back(crowd.scene.add_body(body));
                crowd.discs.push_back({.radius = 0.15F});
                crowd.scene.set_disc(crowd.people.back(), crowd.discs.back());
                break;
            }
            case 2:
                crowd.scene.set_pose(crowd.people[who], somewhere, {0, 0, 0, 1}, 0);
                break;
            default:
                crowd.discs[who].radius = 0.25F;
                crowd.scene.set_disc(crowd.people[who], crowd.discs[who]);
        }
        const StepReport report = solver.step(crowd.scene, dt);
        ASSERT_EQ(report.status, StepStatus::done) << report.error;
        ASSERT_EQ(report.bodies_contained, 0);
    }
    for (int step = 0; step < 240; ++step) ASSERT_EQ(solver.step(crowd.scene, dt).status, StepStatus::done);
    EXPECT_LT(crowd.deepest_overlap(), 0.01 * 0.2);
}

}  // namespace
}  // namespace motley
