// The smaller calls of the C interface do what their namesakes in C++ do.

#include <algorithm>
#include <filesystem>
#include <limits>
#include <string>

#include "both.h"
#include "system.h"

namespace motley {
namespace {

using testing::as_c;
using testing::Both;
using testing::done;

/// Two boxes on a rod, and a person.
class CCallsOfNames : public ::testing::Test {
  protected:
    Scene scene;
    BodyId a = scene.add_body(testing::box({0, 2, 0})), b = scene.add_body(testing::box({1, 2, 0}));
    BodyId person = scene.add_body({.model = BodyModel::planar, .yaw = 0.5, .angular_velocity = {0, 0, 1}});
    ConstraintId rod = scene.add_joint(DistanceDefinition{.body_a = a, .body_b = b});
    Both both{scene, testing::with_gravity({0, -9.81F, 0})};
    motley_body_id c_a = as_c<motley_body_id>(a), c_b = as_c<motley_body_id>(b);
    motley_body_id c_person = as_c<motley_body_id>(person);

    void steps(int count)
    {
        for (int step = 0; step < count; ++step) ASSERT_NO_FATAL_FAILURE(both.step());
    }
};

TEST_F(CCallsOfNames, MoveBodies)
{
    both.scene.set_pose(a, {3, 2, 1}, {0, 0, 0.6, 0.8}, 0);
    ASSERT_TRUE(done(motley_scene_set_pose(both.c_scene, c_a, {3, 2, 1}, {0, 0, 0.6, 0.8}, 0)));
    both.scene.set_velocity(b, {1, 2, 3}, {4, 5, 6});
    ASSERT_TRUE(done(motley_scene_set_velocity(both.c_scene, c_b, {1, 2, 3}, {4, 5, 6})));
    both.scene.set_force(a, {1, 2, 3}, {4, 5, 6});
    ASSERT_TRUE(done(motley_scene_set_force(both.c_scene, c_a, {1, 2, 3}, {4, 5, 6})));
    both.scene.set_mass(b, 5, {1, 0.1F, 0.2F, 2, 0.3F, 2.5F});
    ASSERT_TRUE(done(motley_scene_set_mass(both.c_scene, c_b, 5, {1, 0.1F, 0.2F, 2, 0.3F, 2.5F})));
    both.scene.set_iterations(rod, 5);
    ASSERT_TRUE(done(motley_scene_set_iterations(both.c_scene, as_c<motley_constraint_id>(rod), 5)));
    both.scene.set_island_iterations(a, 3);
    ASSERT_TRUE(done(motley_scene_set_island_iterations(both.c_scene, c_a, 3)));
    steps(10);
    both.scene.renumber_bodies();
    ASSERT_TRUE(done(motley_scene_renumber_bodies(both.c_scene)));
    steps(10);
    float step = 0, substep = 0;
    ASSERT_TRUE(done(motley_scene_last_step(both.c_scene, &step)));
    ASSERT_TRUE(done(motley_scene_last_substep(both.c_scene, &substep)));
    EXPECT_EQ(step, both.scene.last_step());
    EXPECT_EQ(substep, both.scene.last_substep());
}

TEST_F(CCallsOfNames, ReadAndWriteInBulkOverStructsOfTheHost)
{
    struct Agent {
        char name[5];
        motley_vec3d position;
        motley_vec3f linear, angular;
        double yaw;
        motley_quatd orientation;
        char more[3];
    };
    Agent agents[3] = {};
    const motley_body_id bodies[] = {c_a, c_b, c_person};
    const motley_vec3f linear[] = {{1, 2, 3}, {4, 5, 6}, {7, 8, 0}},
                       angular[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 2}};
    for (std::size_t i = 0; i < 3; ++i) {
        agents[i].linear = linear[i];
        agents[i].angular = angular[i];
        both.scene.set_velocity(std::bit_cast<BodyId>(bodies[i]), std::bit_cast<Vec3<float>>(linear[i]),
                                std::bit_cast<Vec3<float>>(angular[i]));
    }
    ASSERT_TRUE(done(motley_scene_set_velocities(both.c_scene, 3, bodies, &agents[0].linear, sizeof(Agent),
                                                 &agents[0].angular, sizeof(Agent))));
    steps(5);
    ASSERT_TRUE(
        done(motley_scene_read_positions(both.c_scene, 3, bodies, &agents[0].position, sizeof(Agent))));
    ASSERT_TRUE(done(motley_scene_read_velocities(both.c_scene, 3, bodies, &agents[0].linear, sizeof(Agent),
                                                  &agents[0].angular, sizeof(Agent))));
    ASSERT_TRUE(done(motley_scene_read_yaws(both.c_scene, 3, bodies, &agents[0].yaw, sizeof(Agent))));
    ASSERT_TRUE(
        done(motley_scene_read_orientations(both.c_scene, 3, bodies, &agents[0].orientation, sizeof(Agent))));
    for (std::size_t i = 0; i < 3; ++i) {
        const BodyState state = both.scene.state(std::bit_cast<BodyId>(bodies[i]));
        EXPECT_EQ(agents[i].position.y, state.position.y);
        EXPECT_EQ(agents[i].linear.x, state.linear_velocity.x);
        EXPECT_EQ(agents[i].angular.z, state.angular_velocity.z);
        EXPECT_EQ(agents[i].yaw, state.yaw);
        EXPECT_EQ(agents[i].orientation.z, state.orientation.z);
        EXPECT_EQ(agents[i].name[0] + agents[i].more[2], 0);  // nothing beside them was written
    }
}

TEST_F(CCallsOfNames, TellOfBodies)
{
    motley_body_model model = -1;
    motley_body_motion motion = -1;
    std::uint64_t data = 0;
    std::size_t count = 0;
    ASSERT_TRUE(done(motley_scene_body_model(both.c_scene, c_person, &model)));
    ASSERT_TRUE(done(motley_scene_body_motion(both.c_scene, c_person, &motion)));
    EXPECT_EQ(model, MOTLEY_PLANAR);
    EXPECT_EQ(motion, MOTLEY_DYNAMIC_BODY);
    ASSERT_TRUE(done(motley_scene_set_user_data(both.c_scene, c_b, 0x123456789ABCDEFULL)));
    ASSERT_TRUE(done(motley_scene_user_data(both.c_scene, c_b, &data)));
    EXPECT_EQ(data, 0x123456789ABCDEFULL);
    ASSERT_TRUE(done(motley_scene_body_count(both.c_scene, &count)));
    EXPECT_EQ(count, 3U);
    ASSERT_TRUE(done(motley_scene_joint_count(both.c_scene, &count)));
    EXPECT_EQ(count, 1U);
    const motley_body_id gone[] = {c_a, c_person};
    ASSERT_TRUE(done(motley_scene_remove_bodies(both.c_scene, 2, gone)));
    ASSERT_TRUE(done(motley_scene_body_count(both.c_scene, &count)));
    EXPECT_EQ(count, 1U);
    motley_bool alive = 1;
    ASSERT_TRUE(done(motley_scene_is_joint_alive(both.c_scene, as_c<motley_constraint_id>(rod), &alive)));
    EXPECT_EQ(alive, 0);  // removed with its body
}

TEST_F(CCallsOfNames, ContainAndReviveABody)
{
    // Forces that are each finite, of which the velocity overflows.
    const float much = std::numeric_limits<float>::max();
    motley_bool contained = 1;
    ASSERT_TRUE(done(motley_scene_is_contained(both.c_scene, c_a, &contained)));
    EXPECT_EQ(contained, 0);
    both.scene.set_force(a, {much, much, much}, {});
    ASSERT_TRUE(done(motley_scene_set_force(both.c_scene, c_a, {much, much, much}, {0, 0, 0})));
    steps(60);
    ASSERT_TRUE(done(motley_scene_is_contained(both.c_scene, c_a, &contained)));
    ASSERT_TRUE(both.scene.is_contained(a));
    EXPECT_EQ(contained, 1);
    both.scene.set_force(a, {}, {});
    ASSERT_TRUE(done(motley_scene_set_force(both.c_scene, c_a, {0, 0, 0}, {0, 0, 0})));
    both.scene.revive(a, {0, 2, 0}, {1, 0, 0});
    ASSERT_TRUE(done(motley_scene_revive(both.c_scene, c_a, {0, 2, 0}, {1, 0, 0})));
    ASSERT_TRUE(done(motley_scene_is_contained(both.c_scene, c_a, &contained)));
    EXPECT_EQ(contained, 0);
    steps(3);
}

TEST(CCallsOfSleep, ABodyAtRestSleepsUntilItIsWoken)
{
    SolverSettings settings;
    settings.sleep_speed = 0.01F;
    Scene one;
    const BodyId body = one.add_body({});
    Both both(one, settings);
    motley_bool asleep = 1;
    ASSERT_TRUE(done(motley_scene_is_asleep(both.c_scene, as_c<motley_body_id>(body), &asleep)));
    EXPECT_EQ(asleep, 0);
    for (int step = 0; step < 60; ++step) ASSERT_NO_FATAL_FAILURE(both.step());
    ASSERT_TRUE(done(motley_scene_is_asleep(both.c_scene, as_c<motley_body_id>(body), &asleep)));
    EXPECT_EQ(asleep, 1);
    ASSERT_TRUE(done(motley_scene_wake(both.c_scene, as_c<motley_body_id>(body))));
    ASSERT_TRUE(done(motley_scene_is_asleep(both.c_scene, as_c<motley_body_id>(body), &asleep)));
    EXPECT_EQ(asleep, 0);
}

TEST_F(CCallsOfNames, SaveAProblemThatCppSolvesToTheSameBits)
{
    const std::string file = (std::filesystem::temp_directory_path() /
                              ("motley-c-problem-" + std::to_string(testing::process_id())))
                                 .string();
    motley_solver_settings settings = motley_default_solver_settings();
    settings.gravity.y = -9.81F;
    motley_contact contact{};
    contact.body_b = c_a;
    ASSERT_TRUE(done(motley_scene_ground(both.c_scene, &contact.body_a)));
    contact.normal.y = 1;
    contact.arm_a.y = 1.5F;
    contact.arm_b.y = -0.5F;
    ASSERT_TRUE(done(motley_save_problem(both.c_scene, &settings, 0.01F, 1, &contact, file.c_str())));
    StepProblem problem = load_problem(file);
    std::filesystem::remove(file);
    ASSERT_EQ(problem.contacts.size(), 1U);
    EXPECT_EQ(problem.dt, 0.01F);
    ASSERT_EQ(Solver(problem.settings).step(problem.scene, problem.dt, problem.contacts).status,
              StepStatus::done);
    ASSERT_TRUE(done(motley_solver_step(both.c_solver, both.c_scene, 0.01F, 1, &contact, nullptr)));
    EXPECT_EQ(both.c_hash(), problem.scene.state_hash());
    EXPECT_EQ(motley_save_problem(both.c_scene, &settings, 0.01F, 1, &contact, "/no/such/folder/file"),
              MOTLEY_FILE_ERROR);
}

TEST(CCallsOfSolver, TheInstructionSetIsTheOneAskedFor)
{
    for (const Isa isa : available_isas()) {
        motley_solver_options options = motley_default_solver_options();
        options.isa = static_cast<motley_isa>(isa);
        motley_solver* solver = nullptr;
        motley_isa used = -1;
        ASSERT_TRUE(done(motley_solver_create(nullptr, &options, &solver)));
        ASSERT_TRUE(done(motley_solver_isa(solver, &used)));
        EXPECT_EQ(used, options.isa);
        motley_solver_destroy(solver);
    }
}

/// What the hooks of a host in C have given out.
struct Given {
    std::size_t bytes = 0;
    long calls = 0;
    bool has_more = true;
};
extern "C" void* give(size_t bytes, size_t alignment, void* user)
{
    auto& given = *static_cast<Given*>(user);
    if (!given.has_more) return nullptr;
    ++given.calls;
    given.bytes += bytes;
    return testing::allocate_aligned(std::max(alignment, sizeof(void*)), bytes);
}
extern "C" void take_back(void* memory, size_t bytes, size_t, void* user)
{
    static_cast<Given*>(user)->bytes -= bytes;
    testing::free_aligned(memory);
}

/// A box that hangs, as a host in C makes it.
struct Hanging {
    motley_scene* scene = nullptr;
    motley_solver* solver = nullptr;
    Hanging()
    {
        motley_body_id ground, body;
        const motley_body_definition box = motley_default_body_definition();
        motley_ball_socket_definition joint = motley_default_ball_socket_definition();
        EXPECT_TRUE(done(motley_scene_create(&scene)));
        EXPECT_TRUE(done(motley_solver_create(nullptr, nullptr, &solver)));
        EXPECT_TRUE(done(motley_scene_ground(scene, &ground)));
        EXPECT_TRUE(done(motley_scene_add_body(scene, &box, &body)));
        joint.body_a = ground;
        joint.body_b = body;
        EXPECT_TRUE(done(motley_scene_add_ball_socket(scene, &joint, nullptr)));
    }
    Hanging(const Hanging&) = delete;
    Hanging& operator=(const Hanging&) = delete;
    ~Hanging()
    {
        motley_solver_destroy(solver);
        motley_scene_destroy(scene);
    }
    motley_status step() const { return motley_solver_step(solver, scene, 0.01F, 0, nullptr, nullptr); }
};

TEST(CCallsOfMemory, HooksServeScenesAndSolvers)
{
    ASSERT_EQ(motley_bytes_held(), 0);
    Given given;
    const motley_memory_hooks hooks{give, take_back, &given};
    const motley_memory_hooks half{give, nullptr, &given};
    EXPECT_EQ(motley_set_memory_hooks(&half), MOTLEY_REFUSED);
    EXPECT_STREQ(
        motley_last_error(),
        "motley_set_memory_hooks: MemoryHooks.release is null; expected a function, as the other one is");
    ASSERT_TRUE(done(motley_set_memory_hooks(&hooks)));
    {
        const Hanging hanging;
        EXPECT_EQ(hanging.step(), MOTLEY_DONE);
        EXPECT_GT(given.calls, 0);
        EXPECT_EQ(given.bytes, motley_bytes_held());
        EXPECT_EQ(motley_set_memory_hooks(nullptr), MOTLEY_REFUSED);
        given.has_more = false;
        motley_scene* another = nullptr;
        EXPECT_EQ(motley_scene_create(&another), MOTLEY_OUT_OF_MEMORY);
        given.has_more = true;
    }
    EXPECT_EQ(given.bytes, 0);
    ASSERT_TRUE(done(motley_set_memory_hooks(nullptr)));
    const long calls = given.calls;
    EXPECT_EQ(Hanging().step(), MOTLEY_DONE);
    EXPECT_EQ(given.calls, calls);
}

}  // namespace
}  // namespace motley
