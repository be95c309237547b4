// Blocks that stand on each other: towers, walls and what else stands by its weight and friction alone.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "rig.h"

namespace motley::testing {

/// One substep, and the contacts of an island solved at once.
inline SolverSettings exact_contacts(Vec3<float> gravity = {0, -9.81F, 0})
{
    SolverSettings settings;
    settings.gravity = gravity;
    settings.exact_contacts = true;
    settings.substeps = 1;
    return settings;
}

/// The place of a point of a body, m, world.
inline Vec3<double> place_of(const Scene& scene, BodyId body, const Vec3<double>& local)
{
    const BodyState state = scene.state(body);
    return state.position + rotate(state.orientation, local);
}

/// A face of body a on corners of body b: what a mason calls a bed joint.
struct BedJoint {
    BodyId a, b;
    Vec3<double> normal, on_face;       ///< in the frame of a
    std::vector<Vec3<double>> corners;  ///< in the frame of b
};

/// Blocks that stand on each other, with contacts at the corners.
struct Masonry {
    Scene scene;
    std::vector<BodyId> blocks;
    std::vector<Vec3<double>> start;
    std::vector<BedJoint> joints;
    float friction = 0.6F;
    std::vector<Contact> contacts;

    BodyId add(const Vec3<double>& position, const Vec3<double>& half, float mass,
               const Quat<double>& orientation = {0, 0, 0, 1})
    {
        const auto third = mass / 3;
        const Vec3<float> h = convert<float>(half);
        BodyDefinition body;
        body.position = position;
        body.orientation = orientation;
        body.mass = mass;
        body.inertia = {third * (h.y * h.y + h.z * h.z), 0, 0,
                        third * (h.x * h.x + h.z * h.z), 0, third * (h.x * h.x + h.y * h.y)};
        blocks.push_back(scene.add_body(body));
        start.push_back(position);
        return blocks.back();
    }
    /// The face y = `top` of a under the corners of a rectangle of b, half lengths x and z, centre at `centre`.
    void lay(BodyId a, const Vec3<double>& on_face, BodyId b, const Vec3<double>& centre, double x, double z)
    {
        BedJoint joint{a, b, {0, 1, 0}, on_face, {}};
        for (const double i : {-1.0, 1.0}) {
            for (const double k : {-1.0, 1.0})
                joint.corners.push_back(centre + Vec3<double>{i * x, 0, k * z});
        }
        joints.push_back(joint);
    }
    /// A face of a, which has this normal, on b at these points of its surface; all in the world.
    void touch(BodyId a, BodyId b, const Vec3<double>& normal, const std::vector<Vec3<double>>& points)
    {
        const auto local = [&](BodyId body, const Vec3<double>& v) {
            return rotate(conjugate(scene.state(body).orientation), v);
        };
        BedJoint joint{a, b, local(a, normal), local(a, points.front() - scene.state(a).position), {}};
        for (const Vec3<double>& point : points)
            joint.corners.push_back(local(b, point - scene.state(b).position));
        joints.push_back(joint);
    }
    std::vector<Contact>& find()
    {
        contacts.clear();
        std::uint64_t key = 0;
        for (const BedJoint& joint : joints) {
            const Vec3<double> n = rotate(scene.state(joint.a).orientation, joint.normal);
            const Vec3<double> face = place_of(scene, joint.a, joint.on_face);
            for (const Vec3<double>& corner : joint.corners) {
                const Vec3<double> point = place_of(scene, joint.b, corner);
                Contact contact;
                contact.key = ++key;
                contact.body_a = joint.a;
                contact.body_b = joint.b;
                contact.normal = convert<float>(n);
                const double apart = dot(n, point - face);
                contact.separation = static_cast<float>(apart);
                contact.arm_a = convert<float>(point - apart * n - scene.state(joint.a).position);
                contact.arm_b = convert<float>(point - scene.state(joint.b).position);
                contact.friction = friction;
                if (apart < 0.2) contacts.push_back(contact);
            }
        }
        return contacts;
    }
    StepReport step(Solver& solver)
    {
        const StepReport report = solver.step(scene, frame_time, find());
        EXPECT_EQ(report.status, StepStatus::done) << report.error;
        return report;
    }
    [[nodiscard]] double farthest() const
    {
        double most = 0;
        for (std::size_t i = 0; i < blocks.size(); ++i)
            most = std::max(most, length(scene.state(blocks[i]).position - start[i]));
        return most;
    }
};

/// Boxes of 1 m and 1 kg on each other, each up to 1 mm aside; the uppermost has the mass `top`, kg.
inline Masonry tower(int count, float top = 1)
{
    Masonry tower;
    for (int i = 0; i < count; ++i) {
        const double x = 1e-3 * std::sin(12.9898 * i), z = 1e-3 * std::cos(78.233 * i);
        const BodyId box = tower.add({x, 0.5 + i, z}, {0.5, 0.5, 0.5}, i + 1 == count ? top : 1);
        if (i == 0) {
            tower.lay(tower.scene.ground(), {0, 0, 0}, box, {0, -0.5, 0}, 0.5, 0.5);
        } else {
            tower.lay(tower.blocks[static_cast<std::size_t>(i) - 1], {0, 0.5, 0}, box, {0, -0.5, 0}, 0.499,
                      0.499);
        }
    }
    return tower;
}

/// Bricks of 1 m and 1 kg in courses `width` m long; every other course begins and ends with half a brick.
inline Masonry wall(int courses, int width = 10)
{
    struct Brick {
        BodyId body;
        double from, to;  ///< m, along the wall
    };
    constexpr double half_height = 0.25, half_depth = 0.25;
    Masonry wall;
    std::vector<Brick> below{{wall.scene.ground(), 0, static_cast<double>(width)}};
    for (int i = 0; i < courses; ++i) {
        std::vector<Brick> course;
        for (double from = 0; from < width;) {
            const double to = i % 2 == 1 && (from == 0 || from + 1 > width) ? from + 0.5 : from + 1;
            const double middle = (from + to) / 2, bottom = 2 * half_height * i;
            const BodyId brick =
                wall.add({middle, bottom + half_height, 0}, {(to - from) / 2, half_height, half_depth},
                         static_cast<float>(to - from));
            for (const Brick& under : below) {
                const double begin = std::max(from, under.from), end = std::min(to, under.to);
                if (end <= begin) continue;
                wall.touch(under.body, brick, {0, 1, 0},
                           {{begin, bottom, -half_depth},
                            {begin, bottom, half_depth},
                            {end, bottom, -half_depth},
                            {end, bottom, half_depth}});
            }
            course.push_back({brick, from, to});
            from = to;
        }
        below = course;
    }
    return wall;
}

}  // namespace motley::testing
