// Two things that make a crowd of discs faster must change no bit: that bands are visited once for several stages, and
// that bodies are sorted in memory by place. Evidence: the same steps without them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "crowd/disc_finder.h"
#include "disc_crowd.h"
#include "scene/scene_core.h"

namespace motley {
namespace {

using testing::DiscCrowd;
using testing::Random;

constexpr float dt = 1.0F / 60;

/// A crowd with people who have no disc, one of whom the host lists a contact with a person of the crowd, and with a
/// disc that reaches further than a strip.
struct MixedCrowd {
    DiscCrowd crowd{{.people = 2500, .friction = 0.3F}};
    std::vector<BodyId> loose;
    std::vector<Contact> listed;

    MixedCrowd()
    {
        BodyDefinition body;
        body.model = BodyModel::planar;
        body.mass = 70;
        body.inertia.zz = 1.4F;
        for (int i = 0; i < 40; ++i) {
            body.position = {-5.0 - i, 0, 0};
            body.linear_velocity = {0.1F * static_cast<float>(i), 1, 0};
            loose.push_back(crowd.scene.add_body(body));
        }
        body.mass = 2000;
        body.position = {crowd.side / 2, crowd.side + 3, 0};
        body.linear_velocity = {0, -2, 0};
        crowd.people.push_back(crowd.scene.add_body(body));
        crowd.scene.set_disc(crowd.people.back(), {.radius = 2});
        Contact contact;
        contact.body_a = crowd.people[0];
        contact.body_b = loose[0];
        contact.separation = -0.001F;  // it always pushes
        contact.key = 1;
        listed = {contact};
    }
    void step(Solver& solver)
    {
        crowd.pull_together(200);
        const Vec3<double> a = crowd.scene.state(crowd.people[0]).position,
                           b = crowd.scene.state(loose[0]).position;
        const double x = b.x - a.x, y = b.y - a.y, distance = std::sqrt(x * x + y * y);
        listed[0].normal = {static_cast<float>(x / distance), static_cast<float>(y / distance), 0};
        const StepReport report = solver.step(crowd.scene, dt, listed);
        ASSERT_EQ(report.status, StepStatus::done) << report.error;
    }
    [[nodiscard]] std::vector<BodyState> states() const
    {
        std::vector<BodyState> all;
        for (const std::vector<BodyId>* bodies : {&crowd.people, &loose})
            for (const BodyId body : *bodies) all.push_back(crowd.scene.state(body));
        return all;
    }
};

bool are_equal(const std::vector<BodyState>& p, const std::vector<BodyState>& q)
{
    return std::equal(p.begin(), p.end(), q.begin(), q.end(), [](const BodyState& x, const BodyState& y) {
        return x.position.x == y.position.x && x.position.y == y.position.y && x.yaw == y.yaw &&
               x.linear_velocity.x == y.linear_velocity.x && x.linear_velocity.y == y.linear_velocity.y &&
               x.angular_velocity.z == y.angular_velocity.z;
    });
}

TEST(DiscVisits, OfEachBandOnceChangeNoBit)
{
    for (const int threads : {1, 3}) {
        MixedCrowd visited, swept;
        Solver solver({}, {.threads = threads, .alone_below = 0}), plain(SolverSettings{});
        int visits = 0;
        for (int step = 0; step < 60; ++step) {
            visits += core_of(visited.crowd.scene).discs.band_rows.empty() ? 0 : 1;
            // Without these lists bands are swept stage by stage, but in steps that search.
            core_of(swept.crowd.scene).discs.band_rows.clear();
            visited.step(solver);
            swept.step(plain);
            ASSERT_TRUE(are_equal(visited.states(), swept.states())) << "step " << step;
        }
        EXPECT_EQ(visits, 59);
        const DiscStore& discs = core_of(visited.crowd.scene).discs;
        EXPECT_GT(discs.band_count, 4U);
        EXPECT_GT(discs.bands[0].blocks[static_cast<std::size_t>(DiscClass::rough_pair)].count +
                      discs.bands[0].blocks[static_cast<std::size_t>(DiscClass::smooth_pair)].count,
                  0)
            << "the large disc is in no band";
    }
}

/// Discs of the bands whose rows in memory follow each other.
std::size_t rows_in_line(const DiscStore& discs)
{
    std::size_t in_line = 0;
    for (std::size_t i = 1; i < discs.band_rows.size(); ++i)
        in_line += discs.band_rows[i].row() == discs.band_rows[i - 1].row() + 1 ? 1 : 0;
    return in_line;
}

TEST(DiscRows, AreSortedByPlaceInMemory)
{
    std::vector<int> order(3000);
    std::iota(order.begin(), order.end(), 0);
    Random random;
    for (std::size_t i = order.size(); i > 1; --i)
        std::swap(order[i - 1], order[static_cast<std::size_t>(random.below(static_cast<int>(i)))]);
    DiscCrowd crowd({.people = 3000}, order);
    Solver solver(SolverSettings{});
    ASSERT_EQ(solver.step(crowd.scene, dt).status, StepStatus::done);
    const DiscStore& discs = core_of(crowd.scene).discs;
    EXPECT_TRUE(discs.wants_sorting);
    EXPECT_LT(rows_in_line(discs), 100U);
    // A body that is added, and one that is removed, before the rows are sorted.
    crowd.scene.remove_body(crowd.people[7]);
    crowd.people.erase(crowd.people.begin() + 7);
    crowd.discs.erase(crowd.discs.begin() + 7);
    BodyDefinition body;
    body.model = BodyModel::planar;
    body.inertia.zz = 1;
    body.position = {-3, 4, 0};
    const BodyId one = crowd.scene.add_body(body), two = crowd.scene.add_body(body);
    const auto speeds_of = [&] {
        std::vector<Vec3<float>> speeds(crowd.people.size());
        crowd.scene.read_velocities(crowd.people, std::span(speeds));
        return speeds;
    };
    const auto before = speeds_of();
    core_of(crowd.scene).sort_disc_rows();
    const auto after = speeds_of();
    EXPECT_TRUE(std::equal(before.begin(), before.end(), after.begin(),
                           [](const auto& v, const auto& w) { return v.x == w.x && v.y == w.y; }));
    EXPECT_FALSE(discs.wants_sorting);
    EXPECT_EQ(rows_in_line(discs), discs.band_rows.size() - 1);
    EXPECT_EQ(crowd.scene.state(one).position.x, -3);
    EXPECT_EQ(crowd.scene.state(two).position.y, 4);
    for (int step = 0; step < 30; ++step) {
        crowd.pull_together(20);
        ASSERT_EQ(solver.step(crowd.scene, dt).status, StepStatus::done);
    }
    EXPECT_FALSE(DiscFinder::are_rows_scattered(discs));
    EXPECT_LT(crowd.deepest_overlap(), 0.01);
}

}  // namespace
}  // namespace motley
