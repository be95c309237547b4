// The C interface where memory counts: a warm step and bulk calls allocate nothing, and a call that runs out of memory says so
// and changes nothing. Every allocation fails once.
#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "allocator.h"
#include "motley/c/motley.h"

namespace motley {
namespace {

using testing::allocations;
using testing::FailingAllocator;

/// A room with a crowd, some of whom overlap, and one body on a hinge.
class CRoom {
  public:
    static constexpr std::size_t people = 60;
    motley_scene* scene = nullptr;
    motley_solver* solver = nullptr;
    std::vector<motley_body_id> bodies = std::vector<motley_body_id>(people);
    motley_body_id hung{};

    CRoom()
    {
        EXPECT_EQ(motley_scene_create(&scene), MOTLEY_DONE);
        EXPECT_EQ(motley_solver_create(nullptr, nullptr, &solver), MOTLEY_DONE);
        std::vector<motley_body_definition> definitions(people, motley_default_body_definition());
        std::vector<motley_disc_definition> discs(people, motley_default_disc_definition());
        for (std::size_t i = 0; i < people; ++i) {
            definitions[i].model = MOTLEY_PLANAR;
            definitions[i].position = {0.39 * static_cast<double>(i % 8), 0.39 * static_cast<double>(i / 8),
                                       0};
        }
        EXPECT_EQ(
            motley_scene_add_bodies(scene, people, definitions.data(), sizeof definitions[0], bodies.data()),
            MOTLEY_DONE);
        EXPECT_EQ(motley_scene_set_discs(scene, people, bodies.data(), discs.data(), sizeof discs[0]),
                  MOTLEY_DONE);
        const motley_body_definition body = motley_default_body_definition();
        EXPECT_EQ(motley_scene_add_body(scene, &body, &hung), MOTLEY_DONE);
        EXPECT_EQ(add_hinge(), MOTLEY_DONE);
    }
    CRoom(const CRoom&) = delete;
    CRoom& operator=(const CRoom&) = delete;
    ~CRoom()
    {
        motley_solver_destroy(solver);
        motley_scene_destroy(scene);
    }
    [[nodiscard]] motley_status add_hinge() const
    {
        motley_hinge_definition hinge = motley_default_hinge_definition();
        EXPECT_EQ(motley_scene_ground(scene, &hinge.body_a), MOTLEY_DONE);
        hinge.body_b = hung;
        return motley_scene_add_hinge(scene, &hinge, nullptr);
    }
    [[nodiscard]] motley_status step() const
    {
        motley_step_report report = motley_default_step_report();
        return motley_solver_step(solver, scene, 1.0F / 60, 0, nullptr, &report);
    }
    [[nodiscard]] std::string bytes() const
    {
        void* saved = nullptr;
        std::size_t size = 0;
        EXPECT_EQ(motley_scene_save(scene, &saved, &size), MOTLEY_DONE);
        std::string text(static_cast<const char*>(saved), size);
        motley_free(saved);
        return text;
    }
};

TEST(CAllocation, WarmStepsAndBulkCallsAllocateNothing)
{
    const CRoom room;
    std::vector<motley_vec3d> positions(CRoom::people);
    std::vector<motley_vec3f> velocities(CRoom::people);
    const std::vector<motley_vec3f> forces(CRoom::people);
    long before = 0;
    for (int step = 0; step < 120; ++step) {
        if (step == 100) before = allocations;
        ASSERT_EQ(motley_scene_read_positions(room.scene, CRoom::people, room.bodies.data(), positions.data(),
                                              sizeof positions[0]),
                  MOTLEY_DONE);
        ASSERT_EQ(motley_scene_read_velocities(room.scene, CRoom::people, room.bodies.data(),
                                               velocities.data(), sizeof velocities[0], nullptr, 0),
                  MOTLEY_DONE);
        ASSERT_EQ(motley_scene_set_forces(room.scene, CRoom::people, room.bodies.data(), forces.data(),
                                          sizeof forces[0], nullptr, 0),
                  MOTLEY_DONE);
        ASSERT_EQ(room.step(), MOTLEY_DONE);
    }
    EXPECT_EQ(allocations - before, 0);
}

TEST(CAllocation, ACallThatRunsOutOfMemorySaysSoAndChangesNothing)
{
    CRoom room;
    ASSERT_EQ(room.step(), MOTLEY_DONE);
    const std::string saved = room.bytes();
    const motley_vec2d square[] = {{-1, -1}, {5, -1}, {5, 5}, {-1, 5}};
    std::vector<motley_body_definition> definitions(40, motley_default_body_definition());
    std::vector<motley_body_id> ids(40);
    struct Call {
        const char* name;
        std::function<motley_status()> make;
    };
    motley_scene* scene = nullptr;
    motley_solver* solver = nullptr;
    const Call calls[] = {
        {"add_bodies",
         [&] {
             return motley_scene_add_bodies(room.scene, 40, definitions.data(), sizeof definitions[0],
                                            ids.data());
         }},
        {"add_wall",
         [&] {
             motley_wall_definition wall = motley_default_wall_definition();
             wall.points = square;
             wall.point_count = 4;
             return motley_scene_add_wall(room.scene, &wall, nullptr);
         }},
        {"add_polygon",
         [&] {
             const motley_ring ring{square, 4};
             motley_wall_id wall;
             return motley_scene_add_polygon(room.scene, 1, &ring, nullptr, &wall);
         }},
        {"add_capsule",
         [&] {
             motley_capsule_definition capsule = motley_default_capsule_definition();
             capsule.body = room.hung;
             return motley_scene_add_capsule(room.scene, &capsule, nullptr);
         }},
        {"add_hinge", [&] { return room.add_hinge(); }},
        {"copy", [&] { return motley_scene_copy(room.scene, &scene); }},
        {"load", [&] { return motley_scene_load(saved.data(), saved.size(), &scene); }},
        {"create a solver", [&] { return motley_solver_create(nullptr, nullptr, &solver); }},
        {"disc_contacts",
         [&] {
             std::size_t count = 0;
             return motley_scene_disc_contacts(room.scene, 0, nullptr, &count);
         }},
    };
    for (const Call& call : calls) {
        int failures = 0;
        for (long successes = 0;; ++successes) {
            motley_status status;
            bool failed;
            {
                const FailingAllocator allocator(successes, false);
                status = call.make();
                failed = FailingAllocator::has_failed();
            }
            if (!failed) {
                EXPECT_EQ(status, MOTLEY_DONE) << call.name << ": " << motley_last_error();
                break;
            }
            ++failures;
            ASSERT_EQ(status, MOTLEY_OUT_OF_MEMORY) << call.name << ", after " << successes;
            ASSERT_TRUE(std::string(motley_last_error()).ends_with(": out of memory"));
            ASSERT_EQ(scene, nullptr) << call.name;
            ASSERT_EQ(solver, nullptr) << call.name;
            ASSERT_TRUE(room.bytes() == saved) << call.name << ", after " << successes;
        }
        EXPECT_GT(failures, 0) << call.name;
        // The next call begins from the same scene.
        motley_scene_destroy(scene);
        motley_solver_destroy(solver);
        scene = nullptr;
        solver = nullptr;
        motley_scene_destroy(room.scene);
        ASSERT_EQ(motley_scene_load(saved.data(), saved.size(), &room.scene), MOTLEY_DONE);
    }
}

}  // namespace
}  // namespace motley
