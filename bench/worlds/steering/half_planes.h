// The velocity nearest to a wish among those that half planes and a greatest speed allow: linear programming in two
// dimensions, as section 5 of van den Berg et al. (2011) uses it.
#pragma once

#include <span>

#include "motley/motley.h"

namespace motley::bench {

/// The velocities v with normal . (v - point) >= 0.
struct HalfPlane {
    Vec2<float> point{}, normal{};  ///< m/s; unit
};

/// The allowed velocity nearest to `wish`. The first `hard` planes hold whatever happens. If all cannot be met at once,
/// the others are moved back by the same smallest distance that lets them be. Returns the slowest velocity that the hard
/// planes allow if they exclude each other.
Vec2<float> nearest_allowed(std::span<const HalfPlane> planes, std::size_t hard, float greatest_speed,
                            Vec2<float> wish);

}  // namespace motley::bench
