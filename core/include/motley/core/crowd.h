// People and walls whose contacts the library finds itself: discs on planar bodies, and walls of straight segments.
#pragma once

#include <cstdint>
#include <limits>
#include <span>

#include "motley/core/ids.h"
#include "motley/core/vector.h"

#pragma GCC visibility push(default)
namespace motley {

/// The shape of a planar body: a disc about its centre of mass. Two discs, or a disc and a wall, touch if each has a
/// category bit that the other one's mask has.
struct DiscDefinition {
    float radius = 0.2F;  ///< m, 1e-6 to 1e6
    /// Coefficient of Coulomb friction, 0 to 1e9; of a contact the geometric mean of both. 0: no friction rows.
    float friction = 0;
    std::uint32_t category = 1;
    std::uint32_t mask = UINT32_MAX;
};

/// Names a wall of one scene; valid as a BodyId is.
struct WallId {
    std::uint32_t slot = 0;
    std::uint32_t generation = 0;
    friend bool operator==(const WallId&, const WallId&) = default;
};

/// A wall without thickness along a chain of points. Discs are kept on the side of it on which they are; they may walk
/// around its ends.
struct WallDefinition {
    /// Two points or more, m, each coordinate -1e12 to 1e12, neighbours at least 1e-6 m apart: in the world, or, with
    /// `body`, in the frame of that body, of which only the motion in the plane counts.
    std::span<const Vec2<double>> points{};
    bool closed =
        false;           ///< whether a segment joins the last point with the first; then three points or more
    BodyId body{};       ///< static or kinematic; the null handle: the ground
    float friction = 0;  ///< as DiscDefinition::friction
    std::uint32_t category = 1;
    std::uint32_t mask = UINT32_MAX;
    /// A turnstile: discs and capsules pass from the right of the wall to its left, seen from the first point towards the last, and
    /// are held there once they are past it.
    bool one_way = false;
    /// m/s, -1e6 to 1e6: the surface runs along the wall, from the first point towards the last, as that of a moving belt
    /// does. It takes discs and capsules along by friction, so a wall without friction has none.
    float surface_speed = 0;
    /// N, above 0: the most with which the wall pushes a disc or a capsule along the normal. Who pushes harder passes. The
    /// points at which a capsule lies along a straight piece share it equally.
    float max_force = std::numeric_limits<float>::infinity();
};

/// A contact that the library found and that pushed in the last step.
struct DiscContact {
    BodyId a{};                ///< the body of the wall, if `wall` is not null
    BodyId b{};                ///< a disc
    WallId wall{};             ///< null between two discs
    Vec2<float> normal{};      ///< unit, from a to b, world, as it was when the last step began
    float separation = 0;      ///< m along the normal, likewise; negative when overlapping
    float normal_force = 0;    ///< N, on b along the normal, mean over the last step
    float friction_force = 0;  ///< N, on b along the normal turned by +90 degrees, likewise
};

}  // namespace motley
#pragma GCC visibility pop
