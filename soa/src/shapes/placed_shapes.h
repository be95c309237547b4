// Where capsules and half-spaces are in the world, and how far they may go within a step.
#pragma once

#include <cmath>
#include <cstdint>

#include "scene/scene_core.h"
#include "shapes/closest_places.h"

namespace motley {

/// m: the speed that a body gains within a step may take it so much further than the speed at which it began.
inline constexpr double step_slack = 0.01;

struct PlacedCapsule {
    Axis axis;
    Vec3<double> middle{};  ///< m, of the axis
    Vec3<double> centre{};  ///< m, of mass of its body
    double radius = 0;
    double goes = 0;       ///< m: the furthest that a point of it goes within the step at its present speed
    bool is_flat = false;  ///< of a planar body, which is met as seen from above
    bool can_move = false;
    bool is_static = false;
};
struct PlacedHalfSpace {
    Vec3<double> point{}, normal{};
    Vec3<double> centre{};  ///< of its body
    double slides = 0;      ///< m: how far its body goes within the step
    double turns = 0;       ///< rad: how far it turns
};

PlacedCapsule placed(const SceneCore& scene, const Capsule& capsule, double dt);
PlacedHalfSpace placed(const SceneCore& scene, const HalfSpace& half_space, double dt);
/// A disc as a capsule without length.
PlacedCapsule placed_disc(const SceneCore& scene, std::uint32_t planar_row, const DiscShape& disc, double dt);

/// False where two axes are more than `distance` m apart for certain: a test that spares most pairs the search for their nearest
/// places. Along the line through their middles, which are `apart`, neither reaches further to the other than |along . apart| /
/// (2 |apart|); what is left between them is a least distance. All of it is multiplied by |apart|, so that nothing is divided.
inline bool may_be_within(const PlacedCapsule& a, const PlacedCapsule& b, double distance)
{
    Vec3<double> apart = b.middle - a.middle;
    if (a.is_flat || b.is_flat) apart.z = 0;
    constexpr double rounding = 1e-6;  // m, and a share of it
    const double most = (1 + rounding) * distance + rounding;
    const double apart2 = dot(apart, apart);
    const double left =
        apart2 - 0.5 * (std::abs(dot(a.axis.along, apart)) + std::abs(dot(b.axis.along, apart)));
    return left <= 0 || left * left <= most * most * apart2;
}

/// An axis as seen from above.
inline Axis flattened(const Axis& axis)
{
    return {{axis.from.x, axis.from.y, 0}, {axis.along.x, axis.along.y, 0}};
}

}  // namespace motley
