// What a host says of a contact at several points.
#pragma once

#include "motley/core/ids.h"
#include "motley/core/vector.h"

namespace motley {

/// Where two surfaces face each other.
struct ManifoldPoint {
    Vec3<float> local_anchor_a{};  ///< m, on the surface of a, in its frame
    Vec3<float> local_anchor_b{};  ///< m, on the surface of b, in its frame
};

/// Two bodies that touch, or soon will, at one to four points, with friction of the whole instead of each point. Unlike a
/// Contact, which is said anew in every step, a manifold is a joint: added when a pair comes near, said anew by
/// Scene::set_joint when its narrow phase finds other points (its impulses stay with the index of a point), and removed
/// when the pair parts. In between the points move with their bodies. Bodies that turn; no particles.
struct ManifoldDefinition {
    BodyId body_a{};
    BodyId body_b{};
    Vec3<float> normal{1, 0, 0};  ///< from a to b, in the frame of a, any length but 0
    int point_count = 1;          ///< 1 to 4
    ManifoldPoint points[4]{};
    float friction = 0;     ///< >= 0, finite: |force across the normal| <= friction times the force along it
    float restitution = 0;  ///< 0 to 1
    /// m, >= 0: moment about the normal <= friction * torsional_radius * force. 2/3 of the radius of a uniform disc.
    float torsional_radius = 0;
    float rolling_radius = 0;  ///< m, >= 0: moment across the normal <= rolling_radius * force
    /// m/s, in the frame of a, finite: how a's surface runs, a conveyor belt. Its part along the normal is not read.
    Vec3<float> surface_velocity{};
};

}  // namespace motley
