// Coulomb's law for what a step reports: no contact in the plane reports more friction than mu times its own normal force,
// whether it rests, slides, opens or is pushed out of an overlap. One that opens used to keep the friction of the force that
// had pressed it. Independent evidence: the law itself; no formula of a constraint is used here.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "mixed_scene.h"
#include "motley/motley.h"
#include "rig.h"

namespace motley {
namespace {

using testing::frame_time;
using testing::length;

/// A float's rounding of forces that add up over the substeps, as a share of the largest of them.
constexpr double rounding = 2e-6;

/// Of contacts between planar bodies, and between them and what cannot move. Returns how many.
int expect_cones(const Scene& scene, std::span<const Contact> contacts, float friction)
{
    const auto is_in_plane = [&](BodyId body) {
        return scene.motion(body) != BodyMotion::dynamic_body || scene.model(body) == BodyModel::planar;
    };
    double most = 0, largest = 0;
    int found = 0;
    for (std::size_t i = 0; i < contacts.size(); ++i) {
        if (!is_in_plane(contacts[i].body_a) || !is_in_plane(contacts[i].body_b)) continue;
        const ContactImpulse& impulse = scene.contact_impulses()[i];
        const auto normal = static_cast<double>(impulse.normal);
        largest = std::max(largest, normal);
        most = std::max(most,
                        length(convert<double>(impulse.friction)) - static_cast<double>(friction) * normal);
        ++found;
    }
    EXPECT_LE(most, rounding * largest);
    return found;
}

std::vector<SolverSettings> ways()
{
    std::vector<SolverSettings> ways;
    for (const int substeps : {1, 4}) {
        SolverSettings settings = testing::with_gravity({0, -9.81F, 0});
        settings.substeps = substeps;
        ways.push_back(settings);
        settings.exact_contacts = true;
        ways.push_back(settings);
        settings.exact_contacts = false;
        settings.method = Method::sequential_impulse;
        ways.push_back(settings);
    }
    return ways;
}

/// Balls of every model that fall, roll, slide and are hit by a wall that turns.
TEST(FrictionCone, HoldsForWhatListedContactsOfPlanarBodiesReport)
{
    for (const SolverSettings& settings : ways()) {
        SCOPED_TRACE(settings.substeps);
        testing::MixedScene mixed(40);
        mixed.restitution = 0;
        Solver solver(settings);
        int found = 0;
        for (int step = 0; step < 240; ++step) {
            const std::vector<Contact>& contacts = mixed.contacts();
            ASSERT_EQ(solver.step(mixed.scene, frame_time, contacts).status, StepStatus::done);
            found += expect_cones(mixed.scene, contacts, mixed.friction);
        }
        EXPECT_GT(found, 1000);
    }
}

/// Discs that are thrown at each other and into a corner, and overlap at first.
TEST(FrictionCone, HoldsForWhatDiscsReport)
{
    for (SolverSettings settings : ways()) {
        settings.gravity = {};
        testing::Random random;
        Scene scene;
        std::vector<BodyId> people;
        std::vector<DiscDefinition> discs;
        for (int i = 0; i < 200; ++i) {
            BodyDefinition person;
            person.model = BodyModel::planar;
            person.mass = 80;
            person.inertia.zz = 2;
            person.position = {2 * random.symmetric(), 2 * random.symmetric(), 0};
            person.linear_velocity = {3 * static_cast<float>(random.symmetric()), 2, 0};
            people.push_back(scene.add_body(person));
            discs.push_back({.radius = 0.2F, .friction = 0.4F});
        }
        scene.set_discs(people, discs);
        const std::vector<Vec2<double>> room = {{-3, -3}, {3, -3}, {3, 3}, {-3, 3}};
        scene.add_wall({.points = room, .closed = true, .friction = 0.4F});
        Solver solver(settings);
        std::size_t contacts = 0;
        for (int step = 0; step < 120; ++step) {
            ASSERT_EQ(solver.step(scene, frame_time).status, StepStatus::done);
            double most = 0, largest = 0;
            for (const DiscContact& contact : scene.disc_contacts()) {
                const auto normal = static_cast<double>(contact.normal_force);
                largest = std::max(largest, normal);
                most = std::max(most, std::abs(static_cast<double>(contact.friction_force)) - 0.4 * normal);
                ++contacts;
            }
            EXPECT_LE(most, rounding * largest) << settings.substeps << " " << step;
        }
        EXPECT_GT(contacts, 1000U);
    }
}

}  // namespace
}  // namespace motley
