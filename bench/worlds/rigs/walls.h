// Boxes on boxes: stacks that should stand still.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "worlds/random.h"
#include "worlds/rig.h"

namespace motley::bench {

/// A box of this size; the first ones stand on the ground y = 0.
inline RigBody standing_box(Vec3<double> position, Vec3<float> half_extents, float mass)
{
    const Vec3<float> h = half_extents;
    RigBody box;
    box.position = position;
    box.mass = mass;
    box.inertia = {mass / 3 * (h.y * h.y + h.z * h.z), mass / 3 * (h.x * h.x + h.z * h.z),
                   mass / 3 * (h.x * h.x + h.y * h.y)};
    box.half_extents = h;
    return box;
}

/// The error is how far boxes have moved.
inline Rig at_rest(std::vector<RigBody> boxes)
{
    Rig rig;
    rig.collides = true;
    rig.bodies = std::move(boxes);
    std::vector<Vec3<double>> start;
    for (const RigBody& body : rig.bodies) start.push_back(body.position);
    rig.truth = [start](std::span<const RigPose> poses, double) {
        double squares = 0;
        for (std::size_t i = 0; i < poses.size(); ++i) {
            const Vec3<double> moved = poses[i].position - start[i];
            squares += dot(moved, moved);
        }
        return std::sqrt(squares / static_cast<double>(poses.size()));
    };
    return rig;
}

/// A pyramid of boxes of 1 m and 1 kg; each layer has one box less than the layer below.
inline Rig make_pyramid(std::int64_t bodies, std::uint64_t)
{
    int layers = 1;
    while ((layers + 1) * (layers + 2) / 2 <= bodies) ++layers;
    std::vector<RigBody> boxes;
    for (int layer = 0; layer < layers; ++layer) {
        for (int i = 0; i + layer < layers; ++i)
            boxes.push_back(standing_box({1.02 * (i + 0.5 * layer), 0.5 + layer, 0}, {0.5F, 0.5F, 0.5F}, 1));
    }
    return at_rest(std::move(boxes));
}

/// Boxes of 1 m and 1 kg on each other, up to 1 mm aside; the uppermost has the mass `top`, kg.
template <int top>
Rig make_tower(std::int64_t bodies, std::uint64_t seed)
{
    Random random(seed);
    std::vector<RigBody> boxes;
    for (std::int64_t i = 0; i < bodies; ++i) {
        const double x = 1e-3 * random.symmetric(), z = 1e-3 * random.symmetric();
        boxes.push_back(standing_box({x, 0.5 + static_cast<double>(i), z}, {0.5F, 0.5F, 0.5F},
                                     i + 1 == bodies ? top : 1));
    }
    return at_rest(std::move(boxes));
}

/// Courses of bricks of 1 x 0.5 x 0.5 m and 1 kg, each on two of the course below; as many courses as bricks in one.
inline Rig make_bricks(std::int64_t bodies, std::uint64_t)
{
    int side = 1;
    while ((side + 1) * (side + 1) <= bodies) ++side;
    std::vector<RigBody> bricks;
    for (int course = 0; course < side; ++course) {
        for (int i = 0; i < side; ++i)
            bricks.push_back(standing_box({i + (course % 2 == 0 ? 0.0 : 0.5), 0.25 + 0.5 * course, 0},
                                          {0.5F, 0.25F, 0.25F}, 1));
    }
    return at_rest(std::move(bricks));
}

}  // namespace motley::bench
