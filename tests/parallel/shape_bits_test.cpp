// Contacts of capsules: all of them are found, with their true separations, and equal bits for every instruction set and
// number of threads, after a copy and after a file. Independent evidence: every pair of shapes tried, with distances that
// are searched for instead of computed; the scalar path.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "rig.h"
#include "shape_crowd.h"

namespace motley {
namespace {

using testing::ShapeCrowd;

constexpr float dt = 1.0F / 60;
const SolverSettings earth{.gravity = {0, 0, -9.81F}};

struct Ends {
    Vec3<double> from, to;
};

double distance(const Vec3<double>& point, const Ends& axis)
{
    const Vec3<double> along = axis.to - axis.from, off = point - axis.from;
    const double length2 = dot(along, along);
    const double place = length2 > 0 ? std::clamp(dot(off, along) / length2, 0.0, 1.0) : 0;
    const Vec3<double> gap = off - place * along;
    return std::sqrt(dot(gap, gap));
}

/// The distance from a point of one axis to the other axis is a convex function of the place of the point: its least value
/// is searched for.
double distance(const Ends& a, const Ends& b)
{
    double low = 0, high = 1;
    const auto at = [&](double place) { return distance(a.from + place * (a.to - a.from), b); };
    for (int i = 0; i < 60; ++i) {
        const double first = (2 * low + high) / 3, second = (low + 2 * high) / 3;
        if (at(first) <= at(second)) {
            high = second;
        } else {
            low = first;
        }
    }
    return at(0.5 * (low + high));
}

Ends ends_of(const Scene& scene, const CapsuleDefinition& capsule, bool flat)
{
    const BodyState state = scene.state(capsule.body);
    Ends ends{state.position + rotate(state.orientation, convert<double>(capsule.from)),
              state.position + rotate(state.orientation, convert<double>(capsule.to))};
    if (flat) ends.from.z = ends.to.z = 0;
    return ends;
}

TEST(ShapeContacts, OfOverlappingCapsulesAreAllFoundWithTheirSeparation)
{
    ShapeCrowd crowd;
    Solver solver(earth, {.threads = 2, .alone_below = 0});
    const int steps = testing::long_run(100);
    std::int64_t seen = 0;
    for (int step = 0; step < steps; ++step) {
        std::vector<std::tuple<BodyId, BodyId, double>> overlaps;
        for (std::size_t i = 0; i < crowd.capsules.size(); ++i) {
            for (std::size_t j = i + 1; j < crowd.capsules.size(); ++j) {
                const CapsuleDefinition &a = crowd.capsule(i), &b = crowd.capsule(j);
                if (a.body == b.body) continue;
                const bool flat = crowd.scene.model(a.body) == BodyModel::planar ||
                                  crowd.scene.model(b.body) == BodyModel::planar;
                const Ends of_a = ends_of(crowd.scene, a, flat), of_b = ends_of(crowd.scene, b, flat);
                const Vec3<double> gap = of_a.from - of_b.from;
                if (dot(gap, gap) > 25) continue;  // the longest capsule is 4 m long
                const double apart =
                    distance(of_a, of_b) - static_cast<double>(a.radius) - static_cast<double>(b.radius);
                if (apart < 0) overlaps.emplace_back(a.body, b.body, apart);
            }
        }
        const StepReport report = solver.step(crowd.scene, dt);
        ASSERT_EQ(report.status, StepStatus::done) << report.error;
        const std::vector<ShapeContact> contacts = crowd.scene.shape_contacts();
        for (const auto& [a, b, apart] : overlaps) {
            const bool joined = std::find(crowd.rigid.begin(), crowd.rigid.end(), a) != crowd.rigid.end() &&
                                a.slot + 1 == b.slot && (a.slot - crowd.rigid[0].slot) % 2 == 0 &&
                                std::find(crowd.rigid.begin(), crowd.rigid.end(), b) != crowd.rigid.end();
            if (joined) continue;
            ++seen;
            const bool is_found = std::any_of(
                contacts.begin(), contacts.end(), [&, a = a, b = b, apart = apart](const ShapeContact& c) {
                    return ((c.a == a && c.b == b) || (c.a == b && c.b == a)) &&
                           std::abs(static_cast<double>(c.separation) - apart) < 2e-3;
                });
            ASSERT_TRUE(is_found) << "bodies " << a.slot << " and " << b.slot << ", " << apart << " m, step "
                                  << step;
        }
    }
    EXPECT_GT(seen, 10 * steps) << "too few to tell";
}

std::vector<std::uint64_t> run(ShapeCrowd crowd, const SolverOptions& options, int steps)
{
    Solver solver(earth, options);
    std::vector<std::uint64_t> hashes;
    for (int step = 0; step < steps; ++step) {
        const StepReport report = solver.step(crowd.scene, dt);
        EXPECT_EQ(report.status, StepStatus::done) << report.error;
        EXPECT_GT(report.shape_contacts, 0);
        hashes.push_back(crowd.scene.state_hash());
    }
    return hashes;
}

TEST(ShapeBits, AreEqualForEveryInstructionSetAndNumberOfThreads)
{
    const ShapeCrowd crowd(60, 150);
    const int steps = testing::long_run(90);
    const std::vector<std::uint64_t> scalar = run(crowd, {.isa = Isa::scalar}, steps);
    for (const Isa isa : available_isas()) {
        for (const int threads : {1, 2, 3}) {
            EXPECT_EQ(run(crowd, {.threads = threads, .alone_below = 0, .isa = isa}, steps), scalar)
                << isa_name(isa) << ", " << threads << " threads";
        }
    }
}

/// Pairs are kept by a solver and searched for anew after some steps. Another solver, which searches at other times, goes on
/// with the same bits from a copy or a file.
TEST(ShapeBits, DoNotDependOnWhoFoundThePairs)
{
    ShapeCrowd crowd;
    Solver solver(earth);
    for (int step = 0; step < 40; ++step) {
        Scene copy = crowd.scene;
        Scene read = load_scene(save_scene(crowd.scene));
        Solver fresh(earth);
        ASSERT_EQ(solver.step(crowd.scene, dt).status, StepStatus::done);
        ASSERT_EQ(fresh.step(copy, dt).status, StepStatus::done);
        ASSERT_EQ(copy.state_hash(), crowd.scene.state_hash()) << "step " << step;
        ASSERT_EQ(fresh.step(read, dt).status, StepStatus::done);
        ASSERT_EQ(read.state_hash(), crowd.scene.state_hash()) << "step " << step;
        ASSERT_EQ(read.shape_contacts().size(), crowd.scene.shape_contacts().size());
    }
    const std::vector<ShapeContact> contacts = crowd.scene.shape_contacts();
    const Scene read = load_scene(save_scene(crowd.scene));
    const std::vector<ShapeContact> same = read.shape_contacts();
    ASSERT_EQ(contacts.size(), same.size());
    for (std::size_t i = 0; i < contacts.size(); ++i)
        EXPECT_EQ(contacts[i].normal_force, same[i].normal_force);
}

/// Teleports, new masses and new velocities between steps change what touches at once.
TEST(ShapeContacts, FollowTeleports)
{
    ShapeCrowd crowd;
    Solver solver(earth);
    testing::Random random;
    for (int step = 0; step < testing::long_run(60); ++step) {
        const BodyId moved =
            crowd.rigid[static_cast<std::size_t>(random.below(static_cast<int>(crowd.rigid.size())))];
        const Vec3<double> to =
            crowd.scene.state(crowd.people[static_cast<std::size_t>(step) % crowd.people.size()]).position;
        crowd.scene.set_pose(moved, {to.x, to.y, 0.3}, {0, 0, 0, 1}, 0);
        Scene copy = crowd.scene;
        Solver fresh(earth);
        ASSERT_EQ(solver.step(crowd.scene, dt).status, StepStatus::done);
        ASSERT_EQ(fresh.step(copy, dt).status, StepStatus::done);
        ASSERT_EQ(copy.state_hash(), crowd.scene.state_hash()) << "step " << step;
    }
}

/// Newton's third law, as the host reads it: what contacts push on moving bodies is their change of momentum.
TEST(ShapeContacts, ChangeMomentumByWhatTheyReport)
{
    ShapeCrowd crowd;
    for (const BodyId body : crowd.rigid) crowd.scene.set_mass(body, 10, {0.3F, 0, 0, 0.4F, 0, 0.35F});
    Solver solver(earth);
    const auto momentum = [&] {
        Vec3<double> sum{};
        for (const BodyId body : crowd.rigid)
            sum = sum + 10.0 * convert<double>(crowd.scene.state(body).linear_velocity);
        return sum;
    };
    const auto is_rigid = [&](BodyId body) {
        return std::find(crowd.rigid.begin(), crowd.rigid.end(), body) != crowd.rigid.end();
    };
    for (int step = 0; step < 120; ++step) {
        const Vec3<double> before = momentum();
        ASSERT_EQ(solver.step(crowd.scene, dt).status, StepStatus::done);
        Vec3<double> impulse{0, 0, -9.81 * 10 * static_cast<double>(crowd.rigid.size())};
        for (const ShapeContact& c : crowd.scene.shape_contacts()) {
            const Vec3<double> force = convert<double>(c.normal_force * c.normal + c.friction_force);
            if (is_rigid(c.b)) impulse = impulse + force;
            if (is_rigid(c.a)) impulse = impulse - force;
        }
        const Vec3<double> change = momentum() - before;
        const double h = static_cast<double>(dt);
        ASSERT_NEAR(change.x, h * impulse.x, 2e-3) << "step " << step;
        ASSERT_NEAR(change.y, h * impulse.y, 2e-3) << "step " << step;
        ASSERT_NEAR(change.z, h * impulse.z, 4e-3) << "step " << step;
    }
}

}  // namespace
}  // namespace motley
