// A scene of joints that any engine can be asked to simulate: bodies, joints and gravity, and nothing of motley. All
// bodies start unturned, so that world axes are body axes.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "motley/core/vector.h"

namespace motley::bench {

struct RigBody {
    Vec3<double> position{};       ///< m, centre of mass
    float mass = 1;                ///< kg
    Vec3<float> inertia{1, 1, 1};  ///< kg m2, about x, y, z
    Vec3<float> velocity{};        ///< m/s
    Vec3<float> spin{};            ///< rad/s
    bool moves = true;
    Vec3<float> half_extents{};  ///< m; of boxes that collide with something
};

enum class RigTie {
    ball,        ///< a point on a point
    hinge,       ///< turns about `axis`, from lower to upper where they differ
    swing_twist  ///< a point on a point; the axis stays in a cone, the turn about it from lower to upper
};

constexpr int rig_world = -1;  ///< RigJoint::a of a joint to the world

struct RigJoint {
    int a = rig_world;  ///< index of a body, or rig_world
    int b = 0;
    Vec3<double> anchor{};  ///< m, world, as the rig starts
    RigTie tie = RigTie::ball;
    Vec3<float> axis{1, 0, 0};   ///< unit
    float lower = 0, upper = 0;  ///< rad
    float cone = 0;              ///< rad, half its opening
};

struct RigPose {
    Vec3<double> position{};
    Quat<double> orientation{0, 0, 0, 1};
};

/// How far the bodies are from the truth at `time`: one number, in the unit of RigEntry::error_name.
using RigTruth = std::function<double(std::span<const RigPose>, double time)>;

struct Rig {
    std::vector<RigBody> bodies;
    std::vector<RigJoint> joints;
    bool collides = false;  ///< boxes on a floor at y = 0, friction 0.6
    RigTruth truth;         ///< empty: the joints' separation is the error
    [[nodiscard]] int add(const RigBody& body)
    {
        bodies.push_back(body);
        return static_cast<int>(bodies.size()) - 1;
    }
};

struct RigEntry {
    const char* name;
    const char* description;
    const char* error_name;  ///< with its unit
    std::int64_t bodies;     ///< about how many, by default
    double warm_up;          ///< s before anything is measured
    double seconds;          ///< s measured
    bool suits_direct;  ///< islands small enough, and without limits, for simultaneous solutions in seconds
    Rig (*make)(std::int64_t bodies, std::uint64_t seed);
};

/// `copies` of a rig side by side along z, with nothing between them; its truth is then the rms over the copies.
Rig repeat(const Rig& rig, std::int64_t copies, double spacing = 4);

/// All rigs; the list is in rigs.cpp.
std::span<const RigEntry> rig_list();
/// Null when there is none of that name.
const RigEntry* find_rig(const std::string& name);

/// Gravity of every rig.
inline constexpr Vec3<float> rig_gravity{0, -9.81F, 0};

/// The distances of the anchors of every joint, m.
struct Separation {
    double rms = 0, max = 0;
};
Separation separation_of(const Rig& rig, std::span<const RigPose> poses);

}  // namespace motley::bench
