// Geoms as solids: what they weigh and how they resist being turned.
#pragma once

#include <vector>

#include "mjcf_elements.h"
#include "motley/core/shapes.h"

namespace motley::mjcf {

/// A frame in the world, in the pose of the file.
struct Frame {
    Vec3<double> position{};
    Quat<double> orientation{0, 0, 0, 1};
    [[nodiscard]] Vec3<double> to_world(const Vec3<double>& p) const
    {
        return position + rotate(orientation, p);
    }
    [[nodiscard]] Frame below(const Frame& inner) const
    {
        return {to_world(inner.position), orientation * inner.orientation};
    }
};

/// Mass, kg, its centre, m, world, and its inertia about the centre, kg m2, along the axes of the world.
struct MassProperties {
    double mass = 0;
    Vec3<double> centre{};
    Sym3<double> inertia{};
    /// Both as one (Huygens and Steiner).
    void add(const MassProperties& other);
};

/// A sphere or capsule in the world, in the pose of the file.
struct Solid {
    Vec3<double> from{}, to{};  ///< m
    double radius = 0;          ///< m
    float friction = 0;
    MassProperties mass;
};

/// Reads a geom that is a sphere or a capsule. `per_unit`: rad in a unit of angles.
Solid read_solid(const Element& geom, const Frame& around, double per_unit);
/// Reads a plane of the world.
HalfSpaceDefinition read_plane(const Element& geom, double per_unit);
/// Reads <inertial>.
MassProperties read_inertial(const Element& inertial, const Frame& around, double per_unit);

}  // namespace motley::mjcf
