// What a host says of a joint that locks axes of one frame to those of another: fixed, hinge, slider and their kin.
#pragma once

#include <cstdint>

#include "motley/core/ids.h"
#include "motley/core/vector.h"

namespace motley {

/// A frame on a body: where it is and how it is turned, in the frame of the body.
struct JointFrame {
    Vec3<float> position{};            ///< m, from the centre of mass
    Quat<float> rotation{0, 0, 0, 1};  ///< any finite non-zero quaternion; its x axis is the joint's axis
};

/// How stiff the locked rows of a joint are under Method::soft_step. hertz = 0: as the solver's settings say.
struct JointStiffness {
    float hertz = 0;          ///< 0 to 1e6 (Hz), capped at 0.25 / substep
    float damping_ratio = 2;  ///< 0 to 1e6
};

/// What the origin of frame b may do in frame a.
enum class LinearLock : std::uint8_t {
    none,   ///< anything
    plane,  ///< stay in the y-z plane: 1 row
    line,   ///< stay on the x axis: 2 rows
    point   ///< stay in the origin: 3 rows
};
/// How frame b may turn against frame a.
enum class AngularLock : std::uint8_t {
    none,           ///< anyhow
    perpendicular,  ///< y of b stays across x of a: 1 row
    swing,          ///< x of b stays along x of a: 2 rows; it may twist
    all             ///< not at all: 3 rows
};

/// Locks axes of a frame on b to those of a frame on a. Bodies that turn: rigid, planar, static, kinematic; no
/// particles.
template <LinearLock linear_lock, AngularLock angular_lock>
struct FrameJointDefinition {
    BodyId body_a{};
    BodyId body_b{};
    JointFrame frame_a{};
    JointFrame frame_b{};
    JointStiffness stiffness{};
};

using FixedDefinition = FrameJointDefinition<LinearLock::point, AngularLock::all>;
using HingeDefinition = FrameJointDefinition<LinearLock::point, AngularLock::swing>;
using SliderDefinition = FrameJointDefinition<LinearLock::line, AngularLock::all>;
/// Beside a parallel-axes joint a joint that slides and turns on the y-z plane.
using PointOnPlaneDefinition = FrameJointDefinition<LinearLock::plane, AngularLock::none>;
/// Beside a parallel-axes joint a cylinder in its sleeve.
using PointOnLineDefinition = FrameJointDefinition<LinearLock::line, AngularLock::none>;
using RotationLockDefinition = FrameJointDefinition<LinearLock::none, AngularLock::all>;
using ParallelAxesDefinition = FrameJointDefinition<LinearLock::none, AngularLock::swing>;
/// Beside a ball-socket a universal joint.
using PerpendicularAxesDefinition = FrameJointDefinition<LinearLock::none, AngularLock::perpendicular>;

}  // namespace motley
