// What a body is: how it may move (its model) and what moves it (its motion).
#pragma once

#include <cstdint>

#include "motley/core/vector.h"

namespace motley {

/// The degrees of freedom of a body. A scene pays only for those it models.
enum class BodyModel : std::uint8_t {
    particle,  ///< 3 linear degrees of freedom; no orientation
    planar,    ///< x, y and yaw about +z; z and tilt are held
    rigid,     ///< 3 linear and 3 angular degrees of freedom, full inertia tensor
};

/// What moves a body.
enum class BodyMotion : std::uint8_t {
    dynamic_body,    ///< impulses, forces and gravity
    kinematic_body,  ///< its own velocity only, set by the host; constraints never change it.
                     ///< Planar bodies see of it what happens in their plane: x, y and the turn about z
    static_body,     ///< nothing
};

/// A body at rest or in motion, in the world frame. SI units.
struct BodyDefinition {
    BodyModel model = BodyModel::rigid;
    BodyMotion motion = BodyMotion::dynamic_body;
    Vec3<double> position{};  ///< centre of mass, m, finite
    Quat<double> orientation{0, 0, 0,
                             1};     ///< rigid, kinematic, static: any finite non-zero quaternion, normalised
    double yaw = 0;                  ///< planar: rad about +z, finite
    Vec3<float> linear_velocity{};   ///< m/s, finite; planar: z = 0; static: zero
    Vec3<float> angular_velocity{};  ///< rad/s, finite; planar: x = y = 0; particle and static: zero
    float mass = 1;                  ///< kg, 1e-10 to 1e10; only of dynamic bodies
    /// About the centre of mass in the body frame, kg m2. rigid: symmetric positive definite, obeying the
    /// triangle inequality (A + B >= C), xx, yy and zz 1e-20 to 1e20; planar: zz 1e-20 to 1e20 only; others: not read.
    Sym3<float> inertia{1, 0, 0, 1, 0, 1};
};

/// The state of one body as the host reads it.
struct BodyState {
    Vec3<double> position{};
    Quat<double> orientation{0, 0, 0, 1};
    double yaw = 0;  ///< planar only: unwrapped, rad
    Vec3<float> linear_velocity{};
    Vec3<float> angular_velocity{};
};

/// From the anchor on a to the anchor on b, in the world, m; anchors are in the frames of their bodies.
inline Vec3<double> anchor_separation(const BodyState& a, const BodyState& b, const Vec3<float>& local_a,
                                      const Vec3<float>& local_b)
{
    return (b.position - a.position) + (rotate(b.orientation, convert<double>(local_b)) -
                                        rotate(a.orientation, convert<double>(local_a)));
}

}  // namespace motley
