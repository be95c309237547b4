// Scenes in files. Independent evidence: the same scene without a file in between.
#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "fuzz/forged_file.h"
#include "joint_scene.h"
#include "rig.h"
#include "scene/scene_core.h"
#include "system.h"

namespace motley {
namespace {

using testing::JointScene;
using testing::MixedScene;

constexpr float dt = 1.0F / 60;

/// A file for this test only, which the destructor removes.
class File {
  public:
    File()
        : path_(::testing::TempDir() + "motley-" + name_of_test() + "-" +
                std::to_string(testing::process_id()))
    {
    }
    ~File() { std::remove(path_.c_str()); }
    File(const File&) = delete;
    File& operator=(const File&) = delete;
    [[nodiscard]] const std::string& path() const { return path_; }
    [[nodiscard]] std::string read() const { return testing::bytes_of(path_); }
    void write(const std::string& bytes) const { std::ofstream(path_, std::ios::binary) << bytes; }

  private:
    std::string path_;
    static std::string name_of_test()
    {
        return ::testing::UnitTest::GetInstance()->current_test_info()->name();
    }
};

SolverSettings settings_of(Method method)
{
    SolverSettings settings;
    settings.method = method;
    settings.gravity = {0, -9.81F, 0};
    return settings;
}

/// Steps a scene with contacts with friction and restitution, joints and hubs, in which bodies are removed and added.
void live_through(MixedScene& mixed, Solver& solver)
{
    for (int step = 0; step < 40; ++step) {
        if (step == 20) {
            mixed.scene.remove_body(mixed.balls[4]);
            mixed.scene.remove_body(mixed.balls[7]);
            mixed.balls.erase(mixed.balls.begin() + 7);
            mixed.balls.erase(mixed.balls.begin() + 4);
            BodyDefinition ball;
            ball.position = {2, 6, 0};
            mixed.balls.push_back(mixed.scene.add_body(ball));
        }
        ASSERT_EQ(solver.step(mixed.scene, dt, mixed.contacts()).status, StepStatus::done);
    }
}

TEST(Snapshot, GoesOnWithTheSameBitsByEveryMethod)
{
    for (const Method method : {Method::soft_step, Method::sequential_impulse}) {
        const File file;
        MixedScene mixed;
        Solver solver(settings_of(method));
        live_through(mixed, solver);
        save_scene(mixed.scene, file.path());
        MixedScene back = mixed;
        back.scene = load_scene(file.path());
        EXPECT_EQ(back.scene.state_hash(), mixed.scene.state_hash());
        EXPECT_EQ(back.scene.body_count(), mixed.scene.body_count());
        Solver other(settings_of(method), {.threads = 2, .alone_below = 0});
        for (int step = 0; step < 60; ++step) {
            if (step == 5) {  // both scenes give the same new handle
                for (MixedScene* scene : {&mixed, &back}) {
                    BodyDefinition ball;
                    ball.position = {1, 9, 0};
                    scene->balls.push_back(scene->scene.add_body(ball));
                }
                ASSERT_EQ(mixed.balls.back(), back.balls.back());
            }
            ASSERT_EQ(solver.step(mixed.scene, dt, mixed.contacts()).status, StepStatus::done);
            ASSERT_EQ(other.step(back.scene, dt, back.contacts()).status, StepStatus::done);
            ASSERT_EQ(back.scene.state_hash(), mixed.scene.state_hash()) << "step " << step;
        }
    }
}

TEST(Snapshot, KeepsEveryTypeOfJointBetweenEveryPairOfBodies)
{
    const File file;
    JointScene joints;
    Solver solver(settings_of(Method::soft_step));
    for (int step = 0; step < 20; ++step) solver.step(joints.scene, dt);
    save_scene(joints.scene, file.path());
    Scene back = load_scene(file.path());
    EXPECT_EQ(back.joint_count(), joints.scene.joint_count());
    for (int step = 0; step < 20; ++step) {
        solver.step(joints.scene, dt);
        solver.step(back, dt);
        ASSERT_EQ(back.state_hash(), joints.scene.state_hash()) << "step " << step;
    }
}

/// Fills the stack below its caller.
[[gnu::noinline]] void fill_stack(int byte)
{
    std::array<char, 100000> below;
    std::memset(below.data(), byte, below.size());
    asm volatile("" : : "r"(below.data()) : "memory");  // or the compiler leaves it out
}

/// A scene with all that scenes have, made and saved where new memory has this byte.
std::vector<std::byte> saved_where_memory_is(int byte)
{
    testing::fill_new_memory(byte);
    fill_stack(byte);
    static const Scene empty;
    JointScene joints(empty);
    Scene& scene = joints.scene;
    fill_stack(byte);
    const std::vector<Vec2<double>> corners{{-5, 20}, {5, 20}, {5, 30}};
    scene.add_wall({.points = corners});
    scene.remove_wall(scene.add_wall({.points = corners, .friction = 1}));
    for (int i = 0; i < 20; ++i) {
        fill_stack(byte);
        BodyDefinition person;
        person.model = BodyModel::planar;
        person.position = {0.3 * i, 19.9, 0};
        const BodyId body = scene.add_body(person);
        scene.set_disc(body, {.radius = 0.2F, .friction = i % 2 == 0 ? 0.3F : 0});
        person.position = {3.0 * i, 40, 0};
        person.linear_damping = 0.5F;
        scene.add_capsule({.body = scene.add_body(person), .from = {-0.2F, 0, 0}, .to = {0.2F, 0, 0}});
    }
    scene.add_half_space({.normal = {0, 0, 1}});
    const BodyId a = scene.add_body({}), b = scene.add_body({});
    scene.remove_joint(scene.add_joint(BallSocketDefinition{a, b, {}, {}}));
    const ConstraintId joint = scene.add_joint(BallSocketDefinition{a, b, {}, {}});
    scene.set_break_limit(joint, {.force = 100, .torque = 100});
    scene.set_iterations(joint, 3);
    scene.set_island_iterations(a, 4);
    scene.set_user_data(b, 5);
    Solver solver(settings_of(Method::soft_step));
    for (int step = 0; step < 3; ++step) {
        fill_stack(byte);
        EXPECT_EQ(solver.step(scene, dt).status, StepStatus::done);
    }
    fill_stack(byte);
    std::vector<std::byte> bytes =
        save_problem({.scene = scene, .settings = settings_of(Method::soft_step), .dt = dt, .contacts = {}});
    const std::vector<std::byte> of_scene = save_scene(scene);
    testing::fill_new_memory(0);
    bytes.insert(bytes.end(), of_scene.begin(), of_scene.end());
    return bytes;
}

TEST(Snapshot, EqualScenesHaveEqualBytesWhateverLayInMemoryBefore)
{
#if !__has_builtin(__builtin_clear_padding)
    GTEST_SKIP() << "this compiler cannot clear padding, and what lies there is written";
#endif
    const std::vector<std::byte> one = saved_where_memory_is(0x5A), other = saved_where_memory_is(0xA7);
    ASSERT_EQ(one.size(), other.size());
    std::size_t different = 0;
    for (std::size_t i = 0; i < one.size(); ++i) different += one[i] != other[i] ? 1 : 0;
    EXPECT_EQ(different, 0U);
}

/// The file with `what`, which occurs once in it, replaced by `instead`, and with a valid checksum.
template <class T>
std::string with_changed(const std::string& file, const T& what, const T& instead)
{
    const std::string old_bytes(reinterpret_cast<const char*>(&what), sizeof what);
    const std::size_t at = file.find(old_bytes);
    EXPECT_NE(at, std::string::npos);
    EXPECT_EQ(file.find(old_bytes, at + 1), std::string::npos);
    std::string changed = file;
    changed.replace(at, sizeof instead, reinterpret_cast<const char*>(&instead), sizeof instead);
    testing::make_whole(changed);
    return changed;
}

TEST(Snapshot, InMemoryHasTheBytesOfAFile)
{
    const File file;
    const StepProblem problem = testing::seed_problem();
    const auto text_of = [](const std::vector<std::byte>& bytes) {
        return std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    };
    const std::vector<std::byte> scene = save_scene(problem.scene), whole = save_problem(problem);
    save_scene(problem.scene, file.path());
    EXPECT_EQ(text_of(scene), file.read());
    save_problem(problem, file.path());
    EXPECT_EQ(text_of(whole), file.read());
    EXPECT_EQ(save_scene(load_scene(scene)), scene);
    EXPECT_EQ(save_problem(load_problem(whole)), whole);
}

TEST(Snapshot, InMemoryIsRefusedByNameWhenItIsNotWhole)
{
    const std::vector<std::byte> good = save_scene(testing::seed_problem().scene);
    const auto refusal_of = [](std::span<const std::byte> bytes) -> std::string {
        try {
            static_cast<void>(load_scene(bytes));
        } catch (const std::runtime_error& error) {
            return error.what();
        }
        return {};
    };
    EXPECT_EQ(refusal_of(good), "");
    EXPECT_EQ(refusal_of({}), "load_scene.bytes: is not a scene of motley");
    EXPECT_EQ(refusal_of(std::span(good).first(31)), "load_scene.bytes: is not a scene of motley");
    EXPECT_NE(refusal_of(std::span(good).first(good.size() - 1)).find("load_scene.bytes: is truncated"),
              std::string::npos);
    std::vector<std::byte> other = good;
    other[other.size() / 2] ^= std::byte{1};
    EXPECT_EQ(refusal_of(other), "load_scene.bytes: is corrupted: its checksum differs");
    EXPECT_THROW(static_cast<void>(load_problem(good)), std::runtime_error) << "a scene is no problem";
}

TEST(Snapshot, KeepsUserDataAndRefusesThatOfNoBody)
{
    Scene scene;
    const BodyId body = scene.add_body({}), gone = scene.add_body({}), late = scene.add_body({});
    const std::uint64_t number = 0xFEDCBA9876543210U;
    scene.set_user_data(body, number);
    scene.remove_body(gone);
    const std::vector<std::byte> good = save_scene(scene);
    const Scene back = load_scene(good);
    EXPECT_EQ(back.user_data(body), number);
    EXPECT_EQ(back.user_data(late), 0U);
    // The numbers of all slots, which lie one after the other.
    std::string file(reinterpret_cast<const char*>(good.data()), good.size());
    const std::array<std::uint64_t, 2> numbers{number, 0}, forged{number, 1};
    file = with_changed(file, numbers, forged);
    try {
        static_cast<void>(load_scene(std::as_bytes(std::span(file))));
        FAIL();
    } catch (const std::runtime_error& error) {
        EXPECT_NE(std::string(error.what()).find("user data of no body"), std::string::npos) << error.what();
    }
}

TEST(Snapshot, KeepsWishesAndBreakLimits)
{
    const File file;
    Scene scene;
    BodyDefinition body;
    body.position = {0, -1, 0};
    const BodyId ball = scene.add_body(body);
    const ConstraintId rope = scene.add_joint(BallSocketDefinition{scene.ground(), ball, {}, {0, 1, 0}});
    scene.set_break_limit(rope, {1, 1});
    scene.set_iterations(rope, 7);
    scene.set_island_iterations(ball, 3);
    save_scene(scene, file.path());
    Scene back = load_scene(file.path());
    EXPECT_TRUE(back.is_alive(rope));
    ASSERT_EQ(core_of(back).island_iterations.size(), 1U);
    EXPECT_TRUE(core_of(back).asks_for_iterations());
    Solver solver(settings_of(Method::soft_step));
    for (int step = 0; step < 5; ++step) solver.step(back, dt);
    ASSERT_EQ(back.break_events().size(), 1U);
    EXPECT_EQ(back.break_events()[0].joint, rope);
}

TEST(Snapshot, OfAStepIsSolvedAgainTheSame)
{
    const File file;
    MixedScene mixed;
    Solver solver(settings_of(Method::soft_step));
    live_through(mixed, solver);
    const StepProblem problem{mixed.scene, settings_of(Method::soft_step), dt, mixed.contacts()};
    save_problem(problem, file.path());
    solver.step(mixed.scene, dt, problem.contacts);
    for (const Isa isa : available_isas()) {
        for (const int threads : {1, 2}) {
            StepProblem back = load_problem(file.path());
            Solver other(back.settings, {.threads = threads, .alone_below = 0, .isa = isa});
            ASSERT_EQ(other.step(back.scene, back.dt, back.contacts).status, StepStatus::done);
            EXPECT_EQ(back.scene.state_hash(), mixed.scene.state_hash()) << isa_name(isa);
        }
    }
}

std::string refusal(const File& file)
{
    try {
        load_scene(file.path());
    } catch (const std::runtime_error& error) {
        return error.what();
    }
    return {};
}

TEST(Snapshot, RefusesWhatIsNotWhole)
{
    const File file;
    EXPECT_NE(refusal(file).find("cannot be read"), std::string::npos);
    MixedScene mixed(4);
    Solver solver(settings_of(Method::soft_step));
    for (int step = 0; step < 30; ++step) solver.step(mixed.scene, dt, mixed.contacts());
    save_scene(mixed.scene, file.path());
    const std::string good = file.read();
    ASSERT_TRUE(refusal(file).empty());

    file.write("");
    EXPECT_NE(refusal(file).find("is not a scene"), std::string::npos);
    file.write(std::string(100, 'x'));
    EXPECT_NE(refusal(file).find("is not a scene"), std::string::npos);
    std::string other = good;
    other[8] = 99;
    file.write(other);
    EXPECT_NE(refusal(file).find("has version 99"), std::string::npos) << refusal(file);
    other = good;
    other[12] = static_cast<char>(other[12] ^ 1);
    file.write(other);
    EXPECT_NE(refusal(file).find("lie otherwise"), std::string::npos);
    for (const std::size_t size : {std::size_t{31}, std::size_t{32}, good.size() / 2, good.size() - 1}) {
        file.write(good.substr(0, size));
        EXPECT_FALSE(refusal(file).empty()) << size;
    }
    file.write(good + "x");
    EXPECT_NE(refusal(file).find("has grown"), std::string::npos);
    // Flips one bit in every 97th byte.
    for (std::size_t at = 32; at < good.size(); at += 97) {
        other = good;
        other[at] = static_cast<char>(other[at] ^ (1 << at % 8));
        file.write(other);
        EXPECT_NE(refusal(file).find("is corrupted"), std::string::npos) << at;
    }
    file.write(good);
    EXPECT_TRUE(refusal(file).empty());
}

TEST(Snapshot, RefusesNonsenseWithAGoodChecksum)
{
    // A forged file is refused or gives a scene that can be stepped and changed; it never crashes.
    const File file;
    int refused = 0, tried = 0;
    const std::string good = testing::seed_file(file.path(), false);
    ASSERT_LT(good.size(), 65536U) << "is more than forged() reaches";
    for (std::size_t at = testing::snapshot_header; at < good.size();
         at += testing::is_sanitized ? 71 : 7, ++tried) {
        std::string forged = good;
        forged[at] = static_cast<char>(forged[at] ^ (0x80 >> at % 8));
        testing::make_whole(forged);
        file.write(forged);
        try {
            Scene scene = load_scene(file.path());
            testing::live_on(scene);
        } catch (const std::runtime_error&) {
            ++refused;
        }
    }
    EXPECT_GT(refused, 0);
    EXPECT_LT(refused, tried) << "a velocity more or less is a scene still";
}

TEST(Snapshot, RefusesWhatTheSceneWouldHaveRefused)
{
    const File file;
    Scene scene;
    BodyDefinition definition;
    definition.mass = 0.75F;
    const BodyId box = scene.add_body(definition);
    definition.inertia = {0.5F, 0, 0, 0.5F, 0, 0.75F};
    const BodyId other = scene.add_body(definition);
    ManifoldDefinition manifold{box, other};
    manifold.friction = 0.3F;
    scene.add_joint(manifold);
    const BallSocketDefinition socket{box, scene.ground(), {0.1F, 0.2F, 0.3F}, {}};
    scene.add_joint(socket);
    scene.set_island_iterations(box, 77);
    save_scene(scene, file.path());
    const std::string good = file.read();
    const auto refusal_of = [&](const auto& what, const auto& instead) {
        file.write(with_changed(good, what, instead));
        return refusal(file);
    };

    ManifoldDefinition five = manifold;
    five.point_count = 5;
    EXPECT_NE(refusal_of(manifold, five).find("point_count is 5"), std::string::npos) << refusal(file);
    BallSocketDefinition fixed = socket;
    fixed.body_a = scene.ground();
    EXPECT_NE(refusal_of(socket, fixed).find("the same body as body_a"), std::string::npos) << refusal(file);
    const IslandIterations wish{box, 77}, of_the_ground{scene.ground(), 77};
    EXPECT_NE(refusal_of(wish, of_the_ground).find("a body that nothing moves"), std::string::npos)
        << refusal(file);
    EXPECT_NE(refusal_of(definition.inertia, Sym3<float>{0.5F, 0, 0, 0.5F, 0, 7}).find("triangle inequality"),
              std::string::npos)
        << refusal(file);
    // The inverse masses of both bodies, which are contiguous in the order of their handles.
    const std::array<float, 2> masses{1 / 0.75F, 1 / 0.75F}, negative{1 / 0.75F, -1 / 0.75F};
    EXPECT_NE(refusal_of(masses, negative).find("a mass that no body has"), std::string::npos)
        << refusal(file);
}

TEST(Snapshot, RefusesSettingsThatAreNeitherTrueNorFalse)
{
    const File file;
    StepProblem problem;
    save_problem(problem, file.path());
    problem.settings.substeps = 77;
    const std::string good = file.read();
    save_problem(problem, file.path());
    ASSERT_NO_THROW(load_problem(file.path()));
    // The first difference between the files shows where the settings are.
    const std::string other = file.read();
    std::size_t at = testing::snapshot_header;
    while (good[at] == other[at]) ++at;
    at += offsetof(SolverSettings, measures) - offsetof(SolverSettings, substeps);
    std::string forged = good;
    ASSERT_EQ(forged[at], 0);
    forged[at] = 2;
    testing::make_whole(forged);
    file.write(forged);
    try {
        load_problem(file.path());
        FAIL();
    } catch (const std::runtime_error& error) {
        EXPECT_NE(std::string(error.what()).find("neither true nor false"), std::string::npos)
            << error.what();
    }
}

TEST(Snapshot, LeavesTheOldFileWhenItCannotWrite)
{
    const std::string nowhere = "/nowhere/at/all";
    try {
        save_scene(Scene(), nowhere);
        FAIL();
    } catch (const std::runtime_error& error) {
        EXPECT_NE(std::string(error.what()).find(nowhere), std::string::npos);
    }
    EXPECT_FALSE(std::filesystem::exists(nowhere + ".part"));
}

}  // namespace
}  // namespace motley
