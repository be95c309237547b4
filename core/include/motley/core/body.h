// What a body is: how it may move (its model) and what moves it (its motion).
#pragma once

#include <cstdint>

#include "motley/core/vector.h"

#pragma GCC visibility push(default)
namespace motley {

/// The degrees of freedom of a body. Those that a model lacks cost neither memory nor time.
enum class BodyModel : std::uint8_t {
    particle,  ///< 3 linear degrees of freedom; no orientation
    planar,    ///< x, y and yaw about +z; z and tilt are held
    rigid,     ///< 3 linear and 3 angular degrees of freedom, full inertia tensor
};

/// What moves a body.
enum class BodyMotion : std::uint8_t {
    dynamic_body,    ///< impulses, forces and gravity
    kinematic_body,  ///< its own velocity, which only the host changes; constraints never do.
                     ///< Against a planar body only its motion in the plane counts: x, y and rotation about z
    static_body,     ///< nothing: it stays where it is
};

/// A body to be added to a scene: its state in the world frame, and its mass. SI units. An orientation is used by
/// rigid, kinematic and static bodies, a yaw by dynamic planar ones.
struct BodyDefinition {
    BodyModel model = BodyModel::rigid;
    BodyMotion motion = BodyMotion::dynamic_body;
    Vec3<double> position{};               ///< centre of mass, m; each coordinate -1e12 to 1e12
    Quat<double> orientation{0, 0, 0, 1};  ///< body to world; length 1e-6 to 1e6, normalised on entry
    double yaw = 0;                        ///< rad about +z, -1e9 to 1e9
    Vec3<float> linear_velocity{};         ///< m/s, -1e9 to 1e9; planar: z = 0; static: zero
    Vec3<float> angular_velocity{};  ///< rad/s, -1e9 to 1e9; planar: x = y = 0; particle and static: zero
    float mass = 1;                  ///< kg, 1e-10 to 1e10; read of dynamic bodies only
    /// About the centre of mass in the body frame, kg m2; read of dynamic bodies only. rigid: positive definite, with
    /// principal moments that obey the triangle inequality A + B >= C, and xx, yy and zz from 1e-20 to 1e20.
    /// planar: only zz is read, 1e-20 to 1e20. particle: not read.
    Sym3<float> inertia{1, 0, 0, 1, 0, 1};
    /// 1/s, 0 to 1e6; read of dynamic bodies only. The medium slows the body by the force -mass * linear_damping *
    /// velocity and the torque -inertia * angular_damping * angular velocity, each integrated implicitly: a substep h
    /// divides the velocities by 1 + h damping, after forces and gravity have changed them and before constraints do. A
    /// particle has no angular damping.
    float linear_damping = 0;
    float angular_damping = 0;  ///< 1/s, likewise
};

/// What a body becomes: see Scene::change_body().
struct BodyChange {
    BodyModel model = BodyModel::rigid;
    /// About the centre of mass in the body frame, kg m2, of which the new model reads what BodyDefinition::inertia
    /// says, in the same ranges.
    Sym3<float> inertia{1, 0, 0, 1, 0, 1};
};

/// The state of one body as the host reads it, in the world frame.
struct BodyState {
    Vec3<double> position{};               ///< centre of mass, m
    Quat<double> orientation{0, 0, 0, 1};  ///< body to world, unit; the identity for a particle
    double yaw = 0;                        ///< rad about +z, not wrapped to a turn; planar bodies only
    Vec3<float> linear_velocity{};         ///< m/s
    Vec3<float> angular_velocity{};        ///< rad/s
};

/// The vector from the anchor on a to the anchor on b, world frame, m. `local_a` and `local_b` are the anchors in the
/// frames of their bodies, from the centres of mass, m.
inline Vec3<double> anchor_separation(const BodyState& a, const BodyState& b, const Vec3<float>& local_a,
                                      const Vec3<float>& local_b)
{
    return (b.position - a.position) + (rotate(b.orientation, convert<double>(local_b)) -
                                        rotate(a.orientation, convert<double>(local_a)));
}

}  // namespace motley
#pragma GCC visibility pop
