// The definition of a joint that locks axes of a frame on one body to those of a frame on another: fixed, hinge,
// slider, ...
#pragma once

#include <cstdint>

#include "motley/core/ids.h"
#include "motley/core/vector.h"

#pragma GCC visibility push(default)
namespace motley {

/// A frame on a body: its position and rotation in the frame of the body.
struct JointFrame {
    Vec3<float> position{};            ///< m, -1e9 to 1e9, from the centre of mass
    Quat<float> rotation{0, 0, 0, 1};  ///< length 1e-6 to 1e6; its x axis is the axis of the joint
};

/// The stiffness of the locked rows of a joint. With a frequency the joint is a spring in every method.
struct JointStiffness {
    float hertz = 0;          ///< Hz, 0 to 1e6, capped at 0.25 / substep; 0: as SolverSettings says
    float damping_ratio = 2;  ///< 0 to 1e6; 1 is critical; read where hertz is above 0
};

/// Where the origin of frame b must stay in frame a.
enum class LinearLock : std::uint8_t {
    none,   ///< anywhere
    plane,  ///< in the y-z plane: 1 row
    line,   ///< on the x axis: 2 rows
    point   ///< at the origin: 3 rows
};
/// Which rotations of frame b relative to frame a are locked.
enum class AngularLock : std::uint8_t {
    none,           ///< none
    perpendicular,  ///< y of b stays perpendicular to x of a: 1 row
    swing,          ///< x of b stays parallel to x of a: 2 rows; b may turn about it
    all             ///< all: 3 rows
};

/// Locks axes of a frame on b to those of a frame on a. For rigid, planar, static and kinematic bodies; not for
/// particles, which do not turn.
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
/// Together with a parallel-axes joint: b slides on the y-z plane of a and turns about its normal.
using PointOnPlaneDefinition = FrameJointDefinition<LinearLock::plane, AngularLock::none>;
/// Together with a parallel-axes joint: a cylindrical joint, which slides along the axis and turns about it.
using PointOnLineDefinition = FrameJointDefinition<LinearLock::line, AngularLock::none>;
using RotationLockDefinition = FrameJointDefinition<LinearLock::none, AngularLock::all>;
using ParallelAxesDefinition = FrameJointDefinition<LinearLock::none, AngularLock::swing>;
/// Together with a ball-socket: a universal joint.
using PerpendicularAxesDefinition = FrameJointDefinition<LinearLock::none, AngularLock::perpendicular>;

}  // namespace motley
#pragma GCC visibility pop
