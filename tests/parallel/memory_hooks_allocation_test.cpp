// Memory of the host. Evidence: what the hooks saw, and what operator new of this executable counted beside them.
#include "motley/core/memory.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "allocator.h"
#include "disc_crowd.h"
#include "fallen_figures.h"
#include "joint_scene.h"
#include "mixed_scene.h"
#include "motley/motley.h"
#include "shape_crowd.h"
#include "system.h"

namespace motley {
namespace {

/// Hooks until they are destroyed. What a piece of memory was asked for stands before it.
class Ledger {
  public:
    Ledger() { set_memory_hooks({allocate, release, this}); }
    ~Ledger() { set_memory_hooks({}); }
    Ledger(const Ledger&) = delete;
    Ledger& operator=(const Ledger&) = delete;

    std::atomic<std::size_t> held{0};        ///< bytes
    std::atomic<long> calls{0}, wrong{0};    ///< allocations, and what was given back as something else
    std::atomic<long> left{testing::never};  ///< how many more allocations succeed

  private:
    struct Piece {
        std::size_t bytes, alignment;
    };
    static std::size_t space_before(std::size_t alignment) { return std::max(alignment, sizeof(Piece)); }
    static void* allocate(std::size_t bytes, std::size_t alignment, void* user)
    {
        auto& self = *static_cast<Ledger*>(user);
        if (self.left-- <= 0) return nullptr;
        ++self.calls;
        self.held += bytes;
        const std::size_t before = space_before(alignment);
        auto* memory = static_cast<std::byte*>(
            testing::allocate_aligned(std::max(alignment, alignof(Piece)), before + bytes));
        *reinterpret_cast<Piece*>(memory + before - sizeof(Piece)) = {bytes, alignment};
        return memory + before;
    }
    static void release(void* memory, std::size_t bytes, std::size_t alignment, void* user)
    {
        auto& self = *static_cast<Ledger*>(user);
        auto* first = static_cast<std::byte*>(memory);
        const auto& piece = *reinterpret_cast<const Piece*>(first - sizeof(Piece));
        if (piece.bytes != bytes || piece.alignment != alignment) ++self.wrong;
        self.held -= bytes;
        testing::free_aligned(first - space_before(alignment));
    }
};

/// The state's hash after steps with contacts, joints of every type, discs, capsules and figures.
std::vector<std::uint64_t> run_everything(int threads)
{
    const SolverOptions options{.threads = threads, .alone_below = 0};
    std::vector<std::uint64_t> hashes;
    testing::MixedScene mixed;
    testing::JointScene joints;
    testing::DiscCrowd discs({.people = 500});
    testing::ShapeCrowd shapes;
    Solver mixed_solver({}, options), solver({.gravity = {0, 0, -9.81F}}, options);
    for (int step = 0; step < 20; ++step) {
        mixed_solver.step(mixed.scene, testing::frame_time, mixed.contacts());
        for (Scene* scene : {&joints.scene, &discs.scene, &shapes.scene})
            EXPECT_EQ(solver.step(*scene, testing::frame_time).status, StepStatus::done);
    }
    for (const Scene* scene : {&mixed.scene, &joints.scene, &discs.scene, &shapes.scene})
        hashes.push_back(scene->state_hash());
    return hashes;
}

TEST(MemoryHooks, ServeEverythingThatGrowsAndGetAllOfItBack)
{
    const auto hashes = run_everything(1);
    ASSERT_EQ(bytes_held(), 0);
    Ledger ledger;
    for (const int threads : {1, 2}) EXPECT_EQ(run_everything(threads), hashes);
    EXPECT_GT(ledger.calls, 1000);
    EXPECT_EQ(ledger.wrong, 0);
    EXPECT_EQ(ledger.held, 0);
}

/// A scene and a solver that grow tenfold ask operator new for no more than before.
TEST(MemoryHooks, LeaveNothingThatGrowsToOperatorNew)
{
    Ledger ledger;
    const auto bytes_beside_hooks = [&](int people) {
        const long before = testing::bytes_allocated;
        const std::size_t hooked = ledger.held;
        Scene scene;
        for (int i = 0; i < people; ++i) {
            const BodyId disc = scene.add_body({.model = BodyModel::planar, .position = {0.5 * i, 0, 0}});
            scene.set_disc(disc, {.radius = 0.3F});
            const BodyId a = scene.add_body({.position = {0.5 * i, 5, 0.1}}),
                         b = scene.add_body({.position = {0.5 * i, 6, 0.1}});
            scene.add_capsule({.body = a, .radius = 0.3F});
            scene.add_joint(BallSocketDefinition{a, b, {0, 0.5F, 0}, {0, -0.5F, 0}});
        }
        scene.add_half_space({});
        Solver solver(SolverSettings{.gravity = {0, 0, -9.81F}});
        for (int step = 0; step < 10; ++step) solver.step(scene, testing::frame_time);
        EXPECT_GT(ledger.held, hooked + static_cast<std::size_t>(people) * 500);
        return testing::bytes_allocated - before;
    };
    const long few = bytes_beside_hooks(200), many = bytes_beside_hooks(2000);
    EXPECT_LT(many, few + 4096);
}

TEST(MemoryHooks, ThatHaveNoMoreMemoryRefuseAStepAndTheNextOneWorks)
{
    Ledger ledger;
    testing::DiscCrowd crowd({.people = 500});
    Solver solver;
    const std::uint64_t before = crowd.scene.state_hash();
    ledger.left = 3;
    const StepReport refused = solver.step(crowd.scene, testing::frame_time);
    EXPECT_EQ(refused.status, StepStatus::refused);
    EXPECT_EQ(crowd.scene.state_hash(), before);
    ledger.left = testing::never;
    EXPECT_EQ(solver.step(crowd.scene, testing::frame_time).status, StepStatus::done);
}

TEST(MemoryHooks, AreRefusedWhileMemoryIsHeldAndByHalves)
{
    const auto allocate = [](std::size_t, std::size_t, void*) -> void* { return nullptr; };
    EXPECT_THROW(set_memory_hooks({.allocate = allocate}), InvalidInput);
    Scene scene;
    scene.add_body({});
    EXPECT_GT(bytes_held(), 0);
    EXPECT_THROW(set_memory_hooks({}), InvalidInput);
}

}  // namespace
}  // namespace motley
