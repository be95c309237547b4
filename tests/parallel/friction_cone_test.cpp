// Coulomb's law for what a step reports: no contact reports more friction than mu times its own normal force, whether it
// rests, slides, opens or is pushed out of an overlap. One that opens used to keep the friction of the force that
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

void expect_cones(const Scene& scene, std::span<const Contact> contacts, float friction)
{
    double most = 0, largest = 0;
    for (std::size_t i = 0; i < contacts.size(); ++i) {
        const ContactImpulse& impulse = scene.contact_impulses()[i];
        const auto normal = static_cast<double>(impulse.normal);
        largest = std::max(largest, normal);
        most = std::max(most,
                        length(convert<double>(impulse.friction)) - static_cast<double>(friction) * normal);
    }
    EXPECT_LE(most, rounding * largest);
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
TEST(FrictionCone, HoldsForWhatListedContactsReport)
{
    const int steps = testing::long_run(240);
    for (const SolverSettings& settings : ways()) {
        for (const float restitution : {0.0F, 0.6F}) {
            SCOPED_TRACE(settings.substeps);
            testing::MixedScene mixed(40);
            mixed.restitution = restitution;
            Solver solver(settings);
            std::size_t found = 0;
            for (int step = 0; step < steps; ++step) {
                const std::vector<Contact>& contacts = mixed.contacts();
                ASSERT_EQ(solver.step(mixed.scene, frame_time, contacts).status, StepStatus::done);
                expect_cones(mixed.scene, contacts, mixed.friction);
                found += contacts.size();
            }
            EXPECT_GT(found, static_cast<std::size_t>(testing::long_run(5000)));
        }
    }
}

/// The host's narrow phase: puts the points of a manifold between the floor at y = 0 and the lowest corners of a cube of 1 m.
void touch_with_lowest_corners(const BodyState& cube, ManifoldDefinition& floor)
{
    std::vector<Vec3<double>> corners;
    for (unsigned corner = 0; corner < 8; ++corner) {
        const auto half = [&](unsigned bit) { return (corner & bit) != 0 ? 0.5 : -0.5; };
        corners.push_back({half(1), half(2), half(4)});
    }
    std::sort(corners.begin(), corners.end(), [&](const Vec3<double>& x, const Vec3<double>& y) {
        return rotate(cube.orientation, x).y < rotate(cube.orientation, y).y;
    });
    for (int i = 0; i < floor.point_count; ++i) {
        const Vec3<double>& corner = corners[static_cast<std::size_t>(i)];
        const Vec3<double> at = cube.position + rotate(cube.orientation, corner);
        floor.points[i] = {convert<float>(Vec3<double>{at.x, 0, at.z}), convert<float>(corner)};
    }
}

/// A box that slides, spins and tips on a floor while a force lifts it off again and again, on the corners that are nearest to the
/// floor. With one point the friction's moments are bounded too.
TEST(FrictionCone, HoldsForWhatAManifoldReports)
{
    constexpr float friction = 0.5F, radius = 0.05F;
    for (const SolverSettings& settings : ways()) {
        for (const int points : {1, 4}) {
            SCOPED_TRACE(settings.substeps);
            Scene scene;
            BodyDefinition definition = testing::box({0, 0.5, 0}, 5);
            definition.linear_velocity = {3, 0, 1};
            definition.angular_velocity = {0.5F, 4, 0};
            const BodyId box = scene.add_body(definition);
            ManifoldDefinition floor{scene.ground(), box};
            floor.normal = {0, 1, 0};
            floor.point_count = points;
            floor.friction = friction;
            floor.restitution = points == 1 ? 0.6F : 0;
            floor.torsional_radius = floor.rolling_radius = radius;
            const ConstraintId joint = scene.add_joint(floor);
            Solver solver(settings);
            int opened = 0, pressed = 0;
            for (int step = 0; step < 300; ++step) {
                touch_with_lowest_corners(scene.state(box), floor);
                scene.set_joint(joint, floor);
                scene.set_force(box, {0, 70 * std::sin(0.3F * static_cast<float>(step)), 0}, {});
                ASSERT_EQ(solver.step(scene, frame_time).status, StepStatus::done);
                const JointReport report = scene.joint_report(joint);
                const Vec3<double> force = convert<double>(report.force),
                                   torque = convert<double>(report.torque);
                (force.y > 0 ? pressed : opened) += 1;
                EXPECT_LE(std::hypot(force.x, force.z) - friction * force.y, 1e-3) << "N, step " << step;
                if (points > 1) continue;
                EXPECT_LE(std::abs(torque.y) - friction * radius * force.y, 1e-3) << "N m, step " << step;
                EXPECT_LE(std::hypot(torque.x, torque.z) - radius * force.y, 1e-3) << "N m, step " << step;
            }
            EXPECT_GT(opened, 20);
            EXPECT_GT(pressed, 100);
        }
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
        for (int step = 0; step < testing::long_run(120); ++step) {
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
