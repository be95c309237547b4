// What a C host can get wrong is refused with the field, the value and what is expected, and changes nothing: neither the
// scene nor what the host's pointers point to.
#include <gtest/gtest.h>

#include <atomic>
#include <cstring>
#include <functional>
#include <limits>
#include <new>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "c/solver_mirrors.h"
#include "motley/c/motley.h"

namespace motley {
namespace {

using std::string;

/// A scene with three bodies, a wall, a joint and a disc, and a solver.
class CBadInput : public ::testing::Test {
  protected:
    motley_scene* scene = nullptr;
    motley_solver* solver = nullptr;
    motley_body_id ground{}, a{}, b{}, removed{};
    motley_constraint_id joint{};
    motley_body_definition body = motley_default_body_definition();

    void SetUp() override
    {
        ASSERT_EQ(motley_scene_create(&scene), MOTLEY_DONE);
        ASSERT_EQ(motley_solver_create(nullptr, nullptr, &solver), MOTLEY_DONE);
        ASSERT_EQ(motley_scene_ground(scene, &ground), MOTLEY_DONE);
        ASSERT_EQ(motley_scene_add_body(scene, &body, &a), MOTLEY_DONE);
        body.model = MOTLEY_PLANAR;
        ASSERT_EQ(motley_scene_add_body(scene, &body, &b), MOTLEY_DONE);
        ASSERT_EQ(motley_scene_add_body(scene, &body, &removed), MOTLEY_DONE);
        ASSERT_EQ(motley_scene_remove_body(scene, removed), MOTLEY_DONE);
        motley_ball_socket_definition ball = motley_default_ball_socket_definition();
        ball.body_a = ground;
        ball.body_b = a;
        ASSERT_EQ(motley_scene_add_ball_socket(scene, &ball, &joint), MOTLEY_DONE);
    }
    void TearDown() override
    {
        motley_solver_destroy(solver);
        motley_scene_destroy(scene);
    }

    [[nodiscard]] string state() const
    {
        void* bytes = nullptr;
        std::size_t size = 0;
        EXPECT_EQ(motley_scene_save(scene, &bytes, &size), MOTLEY_DONE);
        string saved(static_cast<const char*>(bytes), size);
        motley_free(bytes);
        return saved;
    }
    /// Expects that a call is refused with a text that begins so, and leaves every byte of the scene.
    void refuses(const std::function<motley_status()>& call, const string& words) const
    {
        const string before = state();
        EXPECT_EQ(call(), MOTLEY_REFUSED) << words;
        EXPECT_EQ(string(motley_last_error()).substr(0, words.size()), words);
        EXPECT_TRUE(state() == before) << words;
    }
};

TEST_F(CBadInput, NullPointersAreRefused)
{
    const motley_body_id two[] = {a, b};
    motley_vec3f v[2] = {};
    const auto null = [](const string& name) {
        return name + " is null; expected a pointer that is not null";
    };
    refuses([&] { return motley_scene_create(nullptr); }, "motley_scene_create: " + null("scene"));
    refuses([&] { return motley_scene_copy(scene, nullptr); }, "motley_scene_copy: " + null("copy"));
    refuses([&] { return motley_scene_add_body(scene, nullptr, nullptr); },
            "motley_scene_add_body: " + null("definition"));
    refuses([&] { return motley_scene_body_state(scene, a, nullptr); },
            "motley_scene_body_state: " + null("state"));
    refuses([&] { return motley_scene_body_count(scene, nullptr); },
            "motley_scene_body_count: " + null("count"));
    refuses([&] { return motley_scene_set_velocities(scene, 2, two, nullptr, 12, v, 12); },
            "motley_scene_set_velocities: linear is null; expected an array of 2");
    refuses([&] { return motley_scene_set_velocities(scene, 2, nullptr, v, 12, nullptr, 0); },
            "motley_scene_set_velocities: bodies is null; expected an array of 2");
    refuses([&] { return motley_scene_add_wall(scene, nullptr, nullptr); },
            "motley_scene_add_wall: " + null("definition"));
    motley_wall_definition wall = motley_default_wall_definition();
    wall.point_count = 4;
    refuses([&] { return motley_scene_add_wall(scene, &wall, nullptr); },
            "motley_scene_add_wall: motley_wall_definition.points is null; expected an array of 4");
    refuses([&] { return motley_solver_step(nullptr, scene, 0.01F, 0, nullptr, nullptr); },
            "motley_solver_step: " + null("solver"));
    refuses([&] { return motley_solver_step(solver, nullptr, 0.01F, 0, nullptr, nullptr); },
            "motley_solver_step: " + null("scene"));
    refuses([&] { return motley_solver_step(solver, scene, 0.01F, 3, nullptr, nullptr); },
            "motley_solver_step: contacts is null; expected an array of 3");
    refuses([&] { return motley_scene_save_file(scene, nullptr); },
            "motley_scene_save_file: " + null("file"));
    refuses([&] { return motley_scene_load(nullptr, 8, &scene); },
            "motley_scene_load: bytes is null; expected an array of 8");
    refuses([&] { return motley_job_run(nullptr, 0); }, "motley_job_run: " + null("job"));
    refuses([&] { return motley_init_disc_definition(nullptr, 24); },
            "motley_init_disc_definition: " + null("value"));
    // These are allowed.
    motley_scene_destroy(nullptr);
    motley_solver_destroy(nullptr);
    motley_free(nullptr);
    EXPECT_EQ(motley_scene_set_velocities(scene, 0, nullptr, nullptr, 0, nullptr, 0), MOTLEY_DONE);
}

TEST_F(CBadInput, StridesCountsAndAddressesThatCannotBeAreRefused)
{
    const motley_body_id two[] = {a, b};
    motley_vec3f v[2] = {};
    motley_vec3d p[2] = {};
    refuses(
        [&] { return motley_scene_set_velocities(scene, 2, two, v, 8, nullptr, 0); },
        "motley_scene_set_velocities: linear, its stride is 8; expected 12 or more, a multiple of 4 (bytes)");
    refuses([&] { return motley_scene_read_positions(scene, 2, two, p, 28); },
            "motley_scene_read_positions: positions, its stride is 28; expected 24 or more, a multiple of 8 "
            "(bytes)");
    refuses([&] { return motley_scene_read_positions(scene, 2, two, p, 0); },
            "motley_scene_read_positions: positions, its stride is 0; expected 24 or more");
    refuses([&] { return motley_scene_remove_bodies(scene, static_cast<std::size_t>(-1), two); },
            "motley_scene_remove_bodies: bodies, its count is -1; expected 0 to ");
    refuses([&] { return motley_scene_disc_contacts(scene, static_cast<std::size_t>(-2), nullptr, nullptr); },
            "motley_scene_disc_contacts: count is null");
    std::vector<std::byte> bytes(64);
    auto* odd = reinterpret_cast<motley_vec3f*>(bytes.data() + 1);
    refuses(
        [&] { return motley_scene_set_velocities(scene, 2, two, odd, 12, nullptr, 0); },
        "motley_scene_set_velocities: linear is not aligned; expected an address that is a multiple of 4");
    motley_body_definition bodies[2] = {body, body};
    motley_body_id ids[2];
    refuses([&] { return motley_scene_add_bodies(scene, 2, bodies, sizeof body - 8, ids); },
            "motley_scene_add_bodies: definitions, its stride is ");
}

TEST_F(CBadInput, UnknownValuesOfEnumerationsAndFlagsAreRefused)
{
    const auto adds = [&](const motley_body_definition& d) {
        return [this, d] { return motley_scene_add_body(scene, &d, nullptr); };
    };
    for (const int value : {-1, 3, 256, 1 << 30}) {
        motley_body_definition d = motley_default_body_definition();
        d.model = value;
        refuses(adds(d), "motley_scene_add_body: motley_body_definition.model is " +
                             (value == 1 << 30 ? string("1.07374182e+09") : std::to_string(value)) +
                             "; expected 0 to 2");
        d = motley_default_body_definition();
        d.motion = value;
        refuses(adds(d), "motley_scene_add_body: motley_body_definition.motion is ");
        motley_solver_settings settings = motley_default_solver_settings();
        settings.method = value;
        refuses([&] { return motley_solver_set_settings(solver, &settings); },
                "motley_solver_set_settings: motley_solver_settings.method is ");
        settings = motley_default_solver_settings();
        settings.warm_start = value;
        refuses([&] { return motley_solver_set_settings(solver, &settings); },
                "motley_solver_set_settings: motley_solver_settings.warm_start is ");
        motley_euler_drive_definition drive = motley_default_euler_drive_definition();
        drive.body_a = ground;
        drive.body_b = a;
        drive.angle = value;
        refuses([&] { return motley_scene_add_euler_drive(scene, &drive, nullptr); },
                "motley_scene_add_euler_drive: motley_drive_definition.angle is ");
        motley_solver_options options = motley_default_solver_options();
        options.isa = value == -1 ? -2 : value == 3 ? 5 : value;
        motley_solver* none = nullptr;
        refuses([&] { return motley_solver_create(nullptr, &options, &none); },
                "motley_solver_create: motley_solver_options.isa is ");
        EXPECT_EQ(none, nullptr);
    }
}

TEST_F(CBadInput, SizesOfStructsThatNoVersionHasAreRefused)
{
    for (const std::size_t size : {std::size_t{0}, sizeof body - 1, sizeof body + 8, SIZE_MAX}) {
        motley_body_definition d = motley_default_body_definition();
        d.struct_size = size;
        refuses([&] { return motley_scene_add_body(scene, &d, nullptr); },
                "motley_scene_add_body: motley_body_definition.struct_size is " + std::to_string(size) +
                    "; expected " + std::to_string(sizeof d) + ", as its initialiser sets it");
        refuses([&] { return motley_init_body_definition(&d, size); },
                "motley_init_body_definition: motley_body_definition.struct_size is " + std::to_string(size));
        motley_body_definition several[2] = {motley_default_body_definition(), d};
        motley_body_id ids[2] = {};
        refuses([&] { return motley_scene_add_bodies(scene, 2, several, sizeof d, ids); },
                "motley_scene_add_bodies: ");
        EXPECT_EQ(ids[0].generation, 0U);
    }
    motley_step_report report{};
    refuses([&] { return motley_solver_step(solver, scene, 0.01F, 0, nullptr, &report); },
            "motley_solver_step: motley_step_report.struct_size is 0; expected ");
    motley_solver_settings settings{};
    refuses([&] { return motley_solver_read_settings(solver, &settings); },
            "motley_solver_read_settings: motley_solver_settings.struct_size is 0; expected ");
}

TEST_F(CBadInput, HandlesOfWhatWasRemovedAreRefused)
{
    motley_body_state state_of{};
    state_of.yaw = 5;
    refuses([&] { return motley_scene_body_state(scene, removed, &state_of); }, "motley_scene_body_state: ");
    EXPECT_EQ(state_of.yaw, 5);
    refuses([&] { return motley_scene_remove_body(scene, removed); }, "motley_scene_remove_body: ");
    refuses(
        [&] {
            return motley_scene_set_mass(scene, removed, 1, {1, 0, 0, 1, 0, 1});
        },
        "motley_scene_set_mass: ");
    const motley_body_id list[] = {a, removed};
    motley_vec3d positions[2] = {{7, 7, 7}, {7, 7, 7}};
    refuses([&] { return motley_scene_read_positions(scene, 2, list, positions, sizeof *positions); },
            "motley_scene_read_positions: ");
    EXPECT_EQ(positions[0].x, 7);
    motley_hinge_definition hinge = motley_default_hinge_definition();
    hinge.body_a = a;
    hinge.body_b = removed;
    refuses([&] { return motley_scene_add_hinge(scene, &hinge, nullptr); },
            "motley_scene_add_hinge: joint.body_b is ");
    refuses(
        [&] { return motley_scene_set_hinge(scene, joint, &hinge); },
        "motley_scene_set_hinge: set_joint.definition is of another type; expected the type of the joint");
    ASSERT_EQ(motley_scene_remove_joint(scene, joint), MOTLEY_DONE);
    motley_joint_report report;
    refuses([&] { return motley_scene_joint_report(scene, joint, &report); },
            "motley_scene_joint_report: joint_report.joint is slot ");
    refuses([&] { return motley_scene_remove_wall(scene, {3, 9}); }, "motley_scene_remove_wall: ");
    refuses([&] { return motley_scene_remove_shape(scene, {3, 9}); }, "motley_scene_remove_shape: ");
    const motley_wheel wheel{{1, 9}, {2, 9}, {3, 9}, {4, 9}};
    const motley_wheel_definition definition = motley_default_wheel_definition();
    refuses([&] { return motley_scene_steer(scene, &wheel, &definition, 0.1F); }, "motley_scene_steer: ");
}

TEST_F(CBadInput, WhatCppRefusesIsRefusedWithItsWords)
{
    motley_disc_definition disc = motley_default_disc_definition();
    disc.radius = -2;
    refuses([&] { return motley_scene_set_disc(scene, b, &disc); },
            "motley_scene_set_disc: DiscDefinition.radius is -2; expected 1e-6 to 1e6 (m)");
    motley_solver_settings settings = motley_default_solver_settings();
    settings.substeps = 0;
    refuses([&] { return motley_solver_set_settings(solver, &settings); },
            "motley_solver_set_settings: SolverSettings.substeps is 0; expected 1 to 1024");
    motley_step_report report = motley_default_step_report();
    refuses([&] { return motley_solver_step(solver, scene, 2, 0, nullptr, &report); },
            "motley_solver_step: ");
    EXPECT_EQ(report.refused, 1);
    EXPECT_NE(string(motley_last_error()).find(report.error), string::npos);
    motley_contact contact{};
    contact.body_a = a;
    contact.body_b = removed;
    refuses([&] { return motley_solver_step(solver, scene, 0.01F, 1, &contact, nullptr); },
            "motley_solver_step: ");
    refuses([&] { return motley_scene_add_polygon(scene, 0, nullptr, nullptr, nullptr); },
            "motley_scene_add_polygon: ring_count is 0; expected 1 or more");
    const motley_vec2d bow[] = {{0, 0}, {1, 1}, {1, 0}, {0, 1}};
    const motley_ring ring{bow, 4};
    motley_wall_id wall;
    refuses([&] { return motley_scene_add_polygon(scene, 1, &ring, nullptr, &wall); },
            "motley_scene_add_polygon: ");
}

TEST_F(CBadInput, AFailedCallOfAnotherThreadLeavesTheTextOfThisOne)
{
    body.mass = -1;
    EXPECT_EQ(motley_scene_add_body(scene, &body, nullptr), MOTLEY_REFUSED);
    const string here = motley_last_error();
    std::thread([] {
        EXPECT_STREQ(motley_last_error(), "");
        EXPECT_EQ(motley_scene_create(nullptr), MOTLEY_REFUSED);
    }).join();
    EXPECT_EQ(motley_last_error(), here);
}

TEST(CCalls, EveryExceptionBecomesAStatusAndAText)
{
    const auto throwing = [](auto what) { return c::call("name", [&] { throw what; }); };
    EXPECT_EQ(throwing(std::bad_alloc()), MOTLEY_OUT_OF_MEMORY);
    EXPECT_STREQ(motley_last_error(), "name: out of memory");
    EXPECT_EQ(throwing(std::length_error("vector")), MOTLEY_OUT_OF_MEMORY);
    EXPECT_EQ(throwing(std::runtime_error("lost")), MOTLEY_FAILED);
    EXPECT_STREQ(motley_last_error(), "name: lost");
    EXPECT_EQ(throwing(42), MOTLEY_FAILED);
    EXPECT_STREQ(motley_last_error(), "name: an exception of unknown type");
    EXPECT_EQ(throwing(InvalidInput(string(5000, 'x'))), MOTLEY_REFUSED);
    EXPECT_EQ(string(motley_last_error()).size(), 1023U);
    EXPECT_EQ(c::call_on_file("name", [] { throw std::runtime_error("no disk"); }), MOTLEY_FILE_ERROR);
    EXPECT_EQ(c::call_on_file("name", [] { throw InvalidInput("no name"); }), MOTLEY_REFUSED);
}

// An executor that throws through C, as that of a host in C++ may.
TEST(CCalls, AnExecutorThatThrowsRefusesTheStepOrIsToldInItsReport)
{
    const auto step_with = [](int32_t (*run)(void*, int32_t, motley_job*), motley_step_report& report) {
        motley_executor executor = motley_default_executor();
        executor.concurrency = 2;
        executor.run = run;
        motley_solver_options options = motley_default_solver_options();
        options.executor = &executor;
        options.alone_below = 0;
        motley_scene* scene = nullptr;
        motley_solver* solver = nullptr;
        EXPECT_EQ(motley_scene_create(&scene), MOTLEY_DONE);
        EXPECT_EQ(motley_solver_create(nullptr, &options, &solver), MOTLEY_DONE);
        const motley_status status = motley_solver_step(solver, scene, 0.01F, 0, nullptr, &report);
        motley_solver_destroy(solver);
        motley_scene_destroy(scene);
        return status;
    };
    motley_step_report report = motley_default_step_report();
    EXPECT_EQ(step_with([](void*, int32_t, motley_job*) -> int32_t { throw std::runtime_error("no thread"); },
                        report),
              MOTLEY_REFUSED);
    EXPECT_STREQ(report.error, "no thread");
    EXPECT_EQ(step_with([](void*, int32_t, motley_job*) { return 0; }, report), MOTLEY_REFUSED);
    EXPECT_EQ(step_with(
                  [](void*, int32_t, motley_job* job) {
                      EXPECT_EQ(motley_job_run(job, 0), MOTLEY_DONE);
                      return 3;
                  },
                  report),
              MOTLEY_DONE);
    EXPECT_STREQ(report.error, "motley_executor.run returned 3");
    EXPECT_EQ(report.refused, 0);
}

// A struct that has grown by a field since the version of an older host.
struct grown_c {
    std::size_t struct_size;
    std::int32_t old_field, new_field;
};
struct Grown {
    int old_field = 1, new_field = 2;
};

}  // namespace

namespace c {
template <>
struct Mirror<grown_c, Grown> : Pair<grown_c, Grown> {
    static constexpr const char* name = "grown";
    static constexpr auto fields = std::tuple(MOTLEY_FIELD(old_field), MOTLEY_FIELD(new_field));
};
template <>
inline constexpr std::size_t first_size<grown_c> = offsetof(grown_c, new_field);
}  // namespace c

namespace {

TEST(CStructs, AnOlderHostsStructKeepsTheDefaultsOfWhatItDoesNotKnow)
{
    const std::size_t old_size = offsetof(grown_c, new_field);
    grown_c host{0, 0, 77};
    c::initialise<Grown>(&host, old_size);
    EXPECT_EQ(host.struct_size, old_size);
    EXPECT_EQ(host.old_field, 1);
    EXPECT_EQ(host.new_field, 77);  // not the library's to write
    host.old_field = 5;
    const Grown read = c::read<Grown>(&host, "host");
    EXPECT_EQ(read.old_field, 5);
    EXPECT_EQ(read.new_field, 2);  // not the library's to read
    host.struct_size = old_size - 4;
    EXPECT_THROW(c::read<Grown>(&host, "host"), InvalidInput);
    c::initialise<Grown>(&host, sizeof host);
    EXPECT_EQ(host.new_field, 2);
}

TEST(CStructs, HostsOfTheFirstReleaseHaveDefaultsForWhatTheyDoNotKnow)
{
    alignas(motley_solver_settings) unsigned char old[sizeof(motley_solver_settings)];
    std::memset(old, 0x7f, sizeof old);
    auto* settings = reinterpret_cast<motley_solver_settings*>(old);
    ASSERT_EQ(motley_init_solver_settings(settings, 112), MOTLEY_DONE);
    EXPECT_EQ(settings->exact_limits, 0x7f7f7f7f) << "behind what the host has";
    settings->substeps = 3;
    motley_solver* solver = nullptr;
    ASSERT_EQ(motley_solver_create(settings, nullptr, &solver), MOTLEY_DONE);
    motley_solver_settings now = motley_default_solver_settings();
    now.exact_limits = 1;
    now.exact_above_ratio = 7;
    ASSERT_EQ(motley_solver_read_settings(solver, &now), MOTLEY_DONE);
    EXPECT_EQ(now.substeps, 3);
    EXPECT_EQ(now.exact_limits, 0);
    EXPECT_EQ(now.exact_above_ratio, 10);
    motley_solver_destroy(solver);
}

// The sizes of version 1, on machines of 64 bits. A struct that says that it never changes keeps its size for ever; of the
// others a later version may only be larger, and says first_size.
TEST(CStructs, HaveTheSizesThatHostsWereBuiltWith)
{
    static_assert(sizeof(void*) == 8);
    EXPECT_EQ(sizeof(motley_body_definition), 144U);
    EXPECT_EQ(sizeof(motley_body_change), 40U);
    EXPECT_EQ(sizeof(motley_body_state), 88U);
    EXPECT_EQ(sizeof(motley_disc_definition), 24U);
    EXPECT_EQ(sizeof(motley_wall_definition), 64U);
    EXPECT_EQ(sizeof(motley_disc_contact), 44U);
    EXPECT_EQ(sizeof(motley_capsule_definition), 64U);
    EXPECT_EQ(sizeof(motley_half_space_definition), 72U);
    EXPECT_EQ(sizeof(motley_shape_contact), 68U);
    EXPECT_EQ(sizeof(motley_ball_socket_definition), 48U);
    EXPECT_EQ(sizeof(motley_distance_definition), 80U);
    EXPECT_EQ(sizeof(motley_frame_joint_definition), 88U);
    EXPECT_EQ(sizeof(motley_drive_definition), 128U);
    EXPECT_EQ(sizeof(motley_swing_limit_definition), 88U);
    EXPECT_EQ(sizeof(motley_point_servo_definition), 72U);
    EXPECT_EQ(sizeof(motley_angular_servo_definition), 104U);
    EXPECT_EQ(sizeof(motley_gear_definition), 56U);
    EXPECT_EQ(sizeof(motley_rack_and_pinion_definition), 56U);
    EXPECT_EQ(sizeof(motley_pulley_definition), 112U);
    EXPECT_EQ(sizeof(motley_manifold_definition), 168U);
    EXPECT_EQ(sizeof(motley_screw_definition), 64U);
    EXPECT_EQ(sizeof(motley_six_dof_definition), 360U);
    EXPECT_EQ(sizeof(motley_weld_definition), 96U);
    EXPECT_EQ(sizeof(motley_wheel_definition), 104U);
    EXPECT_EQ(sizeof(motley_joint_report), 36U);
    EXPECT_EQ(sizeof(motley_break_event), 16U);
    EXPECT_EQ(sizeof(motley_weld), 16U);
    EXPECT_EQ(sizeof(motley_wheel), 32U);
    EXPECT_EQ(c::first_size<motley_solver_settings>, 112U);
    EXPECT_EQ(sizeof(motley_solver_options), 32U);
    EXPECT_EQ(sizeof(motley_executor), 32U);
    EXPECT_EQ(sizeof(motley_contact), 72U);
    EXPECT_EQ(sizeof(motley_contact_impulse), 16U);
    EXPECT_EQ(sizeof(motley_body_load), 24U);
    EXPECT_EQ(sizeof(motley_step_measures), 168U);
    EXPECT_EQ(sizeof(motley_step_report), 1544U);
    EXPECT_EQ(sizeof(motley_near_person), 16U);
    EXPECT_EQ(sizeof(motley_wall_hit), 16U);
    EXPECT_EQ(sizeof(motley_contact_pair), 24U);
    EXPECT_EQ(sizeof(motley_scene_errors), 64U);
}

}  // namespace
}  // namespace motley
