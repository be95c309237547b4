// The definition of a contact at several points.
#pragma once

#include "motley/core/ids.h"
#include "motley/core/vector.h"

#pragma GCC visibility push(default)
namespace motley {

/// A point where two surfaces face each other.
struct ManifoldPoint {
    Vec3<float> local_anchor_a{};  ///< m, -1e9 to 1e9: on the surface of a, in its frame
    Vec3<float> local_anchor_b{};  ///< m, -1e9 to 1e9: on the surface of b, in its frame
};

/// Two bodies that touch, or soon will, at one to four points, with friction of the whole instead of each point. Unlike
/// a Contact, which is given to every step, a manifold is a joint: the host adds it when a pair comes near, replaces it
/// with Scene::set_joint when the narrow phase finds other points (impulses stay with the index of a point), and
/// removes it when the pair parts. Meanwhile the points move with their bodies. Not for particles, which do not turn.
struct ManifoldDefinition {
    BodyId body_a{};
    BodyId body_b{};
    Vec3<float> normal{1, 0, 0};  ///< from a to b, in the frame of a, length 1e-6 to 1e6
    int point_count = 1;          ///< 1 to 4
    ManifoldPoint points[4]{};    ///< the first point_count are read
    float friction = 0;           ///< coefficient, 0 to 1e9: |tangential force| <= friction * normal force
    float restitution = 0;        ///< coefficient, 0 to 1
    /// m, 0 to 1e9: moment about the normal <= friction * torsional_radius * normal force. For a uniformly loaded disc
    /// 2/3 of its radius.
    float torsional_radius = 0;
    float rolling_radius = 0;  ///< m, 0 to 1e9: moment about tangents <= rolling_radius * normal force
    /// m/s, in the frame of a, -1e9 to 1e9: velocity of a's surface relative to a, as of a conveyor belt. Its component
    /// along the normal is not read.
    Vec3<float> surface_velocity{};
};

}  // namespace motley
#pragma GCC visibility pop
