// Boxes on boxes: stacks that should stand still.
#pragma once

#include "worlds/rig.h"

namespace motley::bench {

/// A pyramid of boxes of 1 m and 1 kg; each layer has one box less than the layer below. The error is how far boxes
/// have moved.
inline Rig make_pyramid(std::int64_t bodies, std::uint64_t)
{
    int layers = 1;
    while ((layers + 1) * (layers + 2) / 2 <= bodies) ++layers;
    Rig rig;
    rig.collides = true;
    for (int layer = 0; layer < layers; ++layer) {
        for (int i = 0; i + layer < layers; ++i) {
            RigBody box;
            box.position = {1.02 * (i + 0.5 * layer), 0.5 + layer, 0};
            box.inertia = {1.0F / 6, 1.0F / 6, 1.0F / 6};
            box.half_extents = {0.5F, 0.5F, 0.5F};
            rig.bodies.push_back(box);
        }
    }
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

}  // namespace motley::bench
