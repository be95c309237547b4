// Shapes whose contacts the library finds itself, beside the discs and walls of crowd.h: spheres, capsules and
// half-spaces.
#pragma once

#include <cstdint>

#include "motley/core/crowd.h"
#include "motley/core/ids.h"
#include "motley/core/vector.h"

#pragma GCC visibility push(default)
namespace motley {

/// Names a shape of one scene; valid as a BodyId is.
struct ShapeId {
    std::uint32_t slot = 0;
    std::uint32_t generation = 0;
    friend bool operator==(const ShapeId&, const ShapeId&) = default;
};

/// All points within `radius` of a straight axis: a capsule, or a sphere where both ends of the axis are the same. A
/// body may have any number of them.
///
/// Capsules meet each other, half-spaces, walls and discs. A planar body reaches from the floor to the sky: what it meets,
/// it meets as seen from above, and is pushed in the plane. So do walls, however they are tilted. One-way walls, belts and
/// walls of bounded force are the same to a capsule as to a disc.
///
/// Two capsules touch if each has a category bit that the other one's mask has, unless they are of one body, of bodies
/// that a joint connects, or of one group. Contacts have the geometric mean of both coefficients of friction and the
/// larger restitution.
struct CapsuleDefinition {
    BodyId body{};  ///< the null handle: the ground
    /// The ends of the axis, m, in the frame of the body, from its centre of mass; each coordinate -1e6 to 1e6. Of a
    /// planar body z = 0; of a particle both 0.
    Vec3<float> from{}, to{};
    float radius = 0.1F;    ///< m, 1e-6 to 1e6
    float friction = 0;     ///< coefficient of Coulomb friction, 0 to 1e9; 0: no friction rows
    float restitution = 0;  ///< coefficient, 0 to 1
    std::uint32_t category = 1;
    std::uint32_t mask = UINT32_MAX;
    std::uint32_t group = 0;  ///< 0: of no group; at most 2^31 - 1, for add_assembly() gives out those above
};

/// Everything on one side of a plane, such as the ground below a floor. It meets capsules of rigid bodies and particles;
/// planar bodies have walls.
struct HalfSpaceDefinition {
    BodyId body{};         ///< static or kinematic; the null handle: the ground
    Vec3<double> point{};  ///< on the plane, m, in the frame of the body; each coordinate -1e12 to 1e12
    Vec3<float> normal{0, 0,
                       1};  ///< out of the half-space, likewise; length 1e-6 to 1e6, normalised on entry
    float friction = 0;     ///< as CapsuleDefinition::friction
    float restitution = 0;  ///< coefficient, 0 to 1
    std::uint32_t category = 1;
    std::uint32_t mask = UINT32_MAX;
};

/// A contact of a capsule that the library found in the last step.
struct ShapeContact {
    BodyId a{};              ///< of the half-space, wall, disc or other capsule
    BodyId b{};              ///< of a capsule
    WallId wall{};           ///< null unless it touches a wall
    Vec3<float> normal{};    ///< unit, from a to b, world, as it was when the last step began
    Vec3<float> arm_b{};     ///< m, world, likewise: from the centre of mass of b to the contact point
    float separation = 0;    ///< m along the normal, likewise; negative when overlapping
    float normal_force = 0;  ///< N, on b along the normal, mean over the last step; 0 if it did not push
    Vec3<float> friction_force{};  ///< N, world, on b, likewise
};

}  // namespace motley
#pragma GCC visibility pop
