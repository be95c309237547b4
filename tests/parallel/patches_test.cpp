// A crowd that is swept in patches has the same bits for any threads and instruction sets, and the results of the
// same contacts swept by colours alone, which is the independent evidence.
#include <gtest/gtest.h>

#include "lattice_crowd.h"
#include "layout/patches.h"
#include "rig.h"

namespace motley {
namespace {

using testing::LatticeCrowd;

constexpr float dt = 1.0F / 60;

/// Adds bodies that no contact touches, with and without joints, and joints within the crowd.
void add_others(LatticeCrowd& crowd)
{
    BodyDefinition lone;
    for (const BodyModel model : {BodyModel::particle, BodyModel::planar, BodyModel::rigid}) {
        lone.model = model;
        lone.position.x -= 3;
        lone.linear_velocity = {1, 2, 0};
        const BodyId body = crowd.scene.add_body(lone);
        lone.position.x -= 1;
        if (model != BodyModel::planar)
            crowd.scene.add_joint(DistanceDefinition{.body_a = body, .body_b = crowd.scene.add_body(lone)});
    }
    for (std::size_t i = 1; i < crowd.bodies.size(); i += 701)
        crowd.scene.add_joint(DistanceDefinition{.body_a = crowd.bodies[i],
                                                 .body_b = crowd.bodies[i + 1],
                                                 .min_length = 0.35F,
                                                 .max_length = 0.4F});
}

std::vector<std::uint64_t> run(const SolverSettings& settings, const SolverOptions& options)
{
    LatticeCrowd crowd;
    add_others(crowd);
    Solver solver(settings, options);
    std::vector<std::uint64_t> hashes;
    const int steps = testing::long_run(4, 2);
    for (int step = 0; step < steps; ++step) {
        // In the last step some people no longer touch anybody.
        if (step == steps - 1) crowd.pairs.resize(Patches::from_contacts + 1000);
        const StepReport report = solver.step(crowd.scene, dt, crowd.contacts());
        EXPECT_EQ(report.status, StepStatus::done) << report.error;
        hashes.push_back(crowd.scene.state_hash());
    }
    return hashes;
}

TEST(PatchesOfACrowd, HaveTheSameBitsForAllThreadsAndInstructionSets)
{
    SolverSettings soft, iterative;
    iterative.method = Method::sequential_impulse;
    iterative.substeps = 1;
    iterative.iterations = 5;
    iterative.drift_correction = DriftCorrection::projection;
    for (const SolverSettings& settings : {soft, iterative}) {
        // The sweeps of the other are in the test below.
        if (testing::is_sanitized && settings.method != Method::soft_step) continue;
        const auto one = run(settings, {.isa = Isa::scalar});
        for (const Isa isa : available_isas()) EXPECT_EQ(run(settings, {.isa = isa}), one) << isa_name(isa);
        for (int threads = 1 + testing::repeats(2); threads > 1; --threads)
            EXPECT_EQ(run(settings, {.threads = threads}), one) << threads;
        SolverSettings measured = settings;
        measured.measures = true;
        EXPECT_EQ(run(measured, {}), one) << "a patch at one visit, or stage by stage, is the same";
    }
}

TEST(PatchesOfACrowd, AreJudgedIslandByIslandOnAnyThreads)
{
    SolverSettings settings;
    settings.method = Method::sequential_impulse;
    settings.substeps = 1;
    settings.iterations = 8;
    settings.tolerance = 0.05F;
    EXPECT_EQ(run(settings, {.threads = 2}), run(settings, {.threads = 1}));
}

TEST(PatchesOfACrowd, DoNotDependOnWhereBodiesLie)
{
    LatticeCrowd plain, moved;
    plain.shuffle();
    moved.shuffle();
    Solver solver{SolverSettings{}}, of_moved{SolverSettings{}};
    for (int step = 0; step < 3; ++step) {
        moved.scene.renumber_bodies();
        solver.step(plain.scene, dt, plain.contacts());
        of_moved.step(moved.scene, dt, moved.contacts());
        ASSERT_EQ(moved.scene.state_hash(), plain.scene.state_hash()) << "step " << step;
    }
}

/// Clusters of 32 contacts, of which 128 fill a patch. Each cluster must move, bit for bit, like a single cluster in
/// a scene of its own.
TEST(PatchesOfACrowd, GiveWhatColoursGive)
{
    constexpr int side = 5, contacts_a_cluster = 32;
    const auto make = [](int clusters, Scene& scene, std::vector<BodyId>& bodies) {
        for (int cluster = 0; cluster < clusters; ++cluster) {
            testing::Random random;
            for (int i = 0; i < side * side; ++i) {
                BodyDefinition body;
                body.model = BodyModel::planar;
                body.inertia.zz = 0.02F;
                body.position = {0.39 * (i % side), 0.39 * (i / side), 0};
                body.linear_velocity = {static_cast<float>(random.symmetric()),
                                        static_cast<float>(random.symmetric()), 0};
                bodies.push_back(scene.add_body(body));
            }
        }
    };
    std::vector<std::pair<int, int>> pairs;
    for (int i = 0; i < side * side; ++i) {
        if (i % side + 1 < side) pairs.emplace_back(i, i + 1);
        if (i / side + 1 < side) pairs.emplace_back(i, i + side);
    }
    pairs.resize(contacts_a_cluster);
    const auto touch = [&](const Scene& scene, const std::vector<BodyId>& bodies) {
        std::vector<Vec3<double>> positions(bodies.size());
        scene.read_positions(bodies, positions);
        std::vector<Contact> contacts;
        for (std::size_t first = 0; first < bodies.size(); first += side * side) {
            for (const auto& [i, j] : pairs) {
                const std::size_t a = first + static_cast<std::size_t>(i),
                                  b = first + static_cast<std::size_t>(j);
                const double dx = positions[b].x - positions[a].x, dy = positions[b].y - positions[a].y;
                const double distance = std::sqrt(dx * dx + dy * dy);
                Contact contact;
                contact.body_a = bodies[a];
                contact.body_b = bodies[b];
                contact.key = std::uint64_t{a} << 32 | b;
                contact.normal = {static_cast<float>(dx / distance), static_cast<float>(dy / distance), 0};
                contact.separation = static_cast<float>(distance - 0.4);
                contact.arm_a = 0.2F * contact.normal;
                contact.arm_b = -contact.arm_a;
                contact.friction = 0.3F;
                contacts.push_back(contact);
            }
        }
        return contacts;
    };
    constexpr int clusters = 2100;
    Scene alone, crowd;
    std::vector<BodyId> of_alone, of_crowd;
    make(1, alone, of_alone);
    make(clusters, crowd, of_crowd);
    Solver solver{SolverSettings{}}, of_many{SolverSettings{}, {.threads = 2}};
    for (int step = 0; step < 5; ++step) {
        solver.step(alone, dt, touch(alone, of_alone));
        const StepReport report = of_many.step(crowd, dt, touch(crowd, of_crowd));
        ASSERT_EQ(report.contacts, clusters * contacts_a_cluster);
        for (std::size_t i = 0; i < of_crowd.size(); ++i) {
            const BodyState one = alone.state(of_alone[i % of_alone.size()]), each = crowd.state(of_crowd[i]);
            ASSERT_EQ(each.position.x, one.position.x) << "step " << step << ", body " << i;
            ASSERT_EQ(each.position.y, one.position.y) << "step " << step << ", body " << i;
            ASSERT_EQ(each.linear_velocity.x, one.linear_velocity.x) << "step " << step << ", body " << i;
        }
    }
}

/// There is no external force, so the total momentum stays.
TEST(PatchesOfACrowd, KeepMomentum)
{
    LatticeCrowd crowd(0);
    SolverSettings settings;
    settings.measures = true;
    Solver solver(settings, {.threads = 2});
    for (int step = 0; step < 4; ++step) {
        const StepReport report = solver.step(crowd.scene, dt, crowd.contacts());
        ASSERT_EQ(report.status, StepStatus::done) << report.error;
        const auto &before = report.measures.before, &after = report.measures.after;
        // Bound: 20,736 bodies of 80 kg at about 1 m/s, with random rounding of floats.
        EXPECT_NEAR(after.momentum[0], before.momentum[0], 1.0);
        EXPECT_NEAR(after.momentum[1], before.momentum[1], 1.0);
    }
}

}  // namespace
}  // namespace motley
