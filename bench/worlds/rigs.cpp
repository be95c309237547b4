// The list of rigs. To add one: its function in rigs/, and its line here.
#include "worlds/rig.h"
#include "worlds/rigs/loads.h"
#include "worlds/rigs/mechanisms.h"
#include "worlds/rigs/nets.h"
#include "worlds/rigs/walls.h"

namespace motley::bench {
namespace {

constexpr const char* apart = "joint separation, rms (m)";
constexpr const char* moved = "movement from rest, rms (m)";
constexpr const char* off = "distance from the true position, rms (m)";

constexpr RigEntry entries[] = {
    {"grid",
     "an N x N net of bodies tied by ball-sockets, hung by its top row (N = square root of the bodies)",
     apart, 10000, 1, 4, false, make_grid},
    {"chains", "chains of 20 bodies tied by ball-sockets, starting level", apart, 20000, 1, 4, false,
     make_chains},
    {"ragdolls", "figures of 11 boxes with limited hinges and swing-twists, hung by the pelvis, spinning",
     apart, 11000, 1, 4, false, make_ragdolls},
    {"load-hanging", "chains of 10 links of 1 kg and 1,000 kg at their end, hanging", apart, 1100, 1, 4, true,
     make_load_of<1000>},
    {"load-level", "chains of 10 links of 1 kg and 1,000 kg at their end, starting level", apart, 1100, 1, 4,
     true, make_load_level},
    {"load-100", "chains of 10 links of 1 kg and 100 kg at their end, hanging", apart, 1100, 1, 4, true,
     make_load_of<100>},
    {"load-10000", "chains of 10 links of 1 kg and 10 t at their end, hanging", apart, 1100, 1, 4, true,
     make_load_of<10000>},
    {"load-1000000", "chains of 10 links of 1 kg and 1,000 t at their end, hanging", apart, 1100, 1, 4, true,
     make_load_of<1000000>},
    {"pendulum", "bodies on a ball-socket each, starting level", off, 1000, 0, 5, true, make_pendulum},
    {"double-pendulum", "pairs of rods on hinges, starting level, for two seconds", off, 1000, 0, 2, true,
     make_double_pendulum},
    {"four-bar", "parallelograms on four hinges: redundant loops", off, 999, 0, 10, true, make_four_bar},
    {"pyramid", "a pyramid of boxes at rest", moved, 55, 0, 5, false, make_pyramid},
    {"tower", "boxes on each other, up to 1 mm aside", moved, 50, 0, 10, true, make_tower<1>},
    {"tower-loaded", "the same under a box of 1,000 kg", moved, 10, 0, 10, true, make_tower<1000>},
    {"bricks", "a wall of bricks without mortar", moved, 100, 0, 5, false, make_bricks},
};

}  // namespace

std::span<const RigEntry> rig_list()
{
    return entries;
}

const RigEntry* find_rig(const std::string& name)
{
    for (const RigEntry& entry : entries) {
        if (name == entry.name) return &entry;
    }
    return nullptr;
}

Rig repeat(const Rig& rig, std::int64_t copies, double spacing)
{
    Rig all;
    all.collides = rig.collides;
    const int bodies = static_cast<int>(rig.bodies.size());
    for (int copy = 0; copy < std::max<std::int64_t>(1, copies); ++copy) {
        const double z = spacing * copy;
        for (RigBody body : rig.bodies) {
            body.position.z += z;
            all.bodies.push_back(body);
        }
        for (RigJoint joint : rig.joints) {
            if (joint.a != rig_world) joint.a += copy * bodies;
            joint.b += copy * bodies;
            joint.anchor.z += z;
            all.joints.push_back(joint);
        }
    }
    if (!rig.truth) return all;
    all.truth = [truth = rig.truth, count = rig.bodies.size(), spacing](std::span<const RigPose> poses,
                                                                        double time) {
        const std::size_t rigs = poses.size() / count;
        double squares = 0;
        std::vector<RigPose> own(count);
        for (std::size_t copy = 0; copy < rigs; ++copy) {
            for (std::size_t i = 0; i < count; ++i) {
                own[i] = poses[copy * count + i];
                own[i].position.z -= spacing * static_cast<double>(copy);
            }
            const double error = truth(own, time);
            squares += error * error;
        }
        return std::sqrt(squares / static_cast<double>(rigs));
    };
    return all;
}

Separation separation_of(const Rig& rig, std::span<const RigPose> poses)
{
    Separation separation;
    double squares = 0;
    for (const RigJoint& joint : rig.joints) {
        const auto anchor_now = [&](int body) {
            if (body == rig_world) return joint.anchor;
            const auto i = static_cast<std::size_t>(body);
            return poses[i].position + rotate(poses[i].orientation, joint.anchor - rig.bodies[i].position);
        };
        const Vec3<double> gap = anchor_now(joint.b) - anchor_now(joint.a);
        const double length2 = dot(gap, gap);
        squares += length2;
        separation.max = std::max(separation.max, std::sqrt(length2));
    }
    if (!rig.joints.empty()) separation.rms = std::sqrt(squares / static_cast<double>(rig.joints.size()));
    return separation;
}

}  // namespace motley::bench
