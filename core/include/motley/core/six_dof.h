// A joint of six degrees of freedom, each free, limited, driven or locked: one definition that becomes as few rows as
// possible.
#pragma once

#include <limits>
#include <vector>

#include "motley/core/scene.h"

#pragma GCC visibility push(default)
namespace motley {

/// The limits of one coordinate of a joint of six degrees of freedom, and what drives it. Ranges as in DriveDefinition.
struct AxisSetup {
    float lower = 0;                 ///< m or rad, <= upper; both 0: locked; -infinity and infinity: free
    float upper = 0;                 ///< m or rad
    float motor_speed = 0;           ///< m/s or rad/s
    float motor_max_force = 0;       ///< N or N m; 0: no motor
    float spring_hertz = 0;          ///< Hz; 0: no spring
    float spring_damping_ratio = 0;  ///< of a spring with spring_hertz; 1 is critical
    float spring_stiffness = 0;      ///< N/m or N m/rad, instead of spring_hertz
    float spring_damping = 0;        ///< N s/m or N m s/rad
    float spring_target = 0;         ///< m or rad
    float spring_max_force = std::numeric_limits<float>::infinity();  ///< N or N m
    float armature = 0;  ///< kg or kg m2: of a rotor geared to the coordinate

    static AxisSetup locked() { return {}; }
    static AxisSetup free();
    static AxisSetup limited(float lower, float upper) { return {.lower = lower, .upper = upper}; }
};

/// How the three rotations of a joint of six degrees of freedom are measured.
enum class SixDofRotation : std::uint8_t {
    /// 2 atan2(q_i, q_w), i = x, y, z, of the quaternion q from frame a to frame b: treats all directions alike. While
    /// only one rotation differs from 0, this is its angle.
    about_axes,
    euler  ///< EulerAngle: the angles of a chain of three hinges
};

/// The position and rotation of frame b in frame a: three coordinates along the axes of a and three rotations
/// (SixDofRotation), each locked, limited, driven or free. In addition to limits of single rotations, a cone may bound
/// the angle between the x axes of the frames; unlike such limits it has no corners, which suits loose joints.
struct SixDofDefinition {
    BodyId body_a{};
    BodyId body_b{};
    JointFrame frame_a{};
    JointFrame frame_b{};
    AxisSetup position[3];  ///< along x, y, z of frame a
    AxisSetup rotation[3];  ///< about x (the twist), y, z; limits from -pi to pi, or infinite
    SixDofRotation rotations = SixDofRotation::about_axes;
    float max_swing = 3.14159265F;  ///< rad, > 0 to pi: half the opening of the cone; pi: none
    JointStiffness stiffness{};     ///< of the locked coordinates
};

/// Adds the joints that a definition needs: locked coordinates become as few joints as possible (a fixed joint, a hinge
/// or a slider where it fits), and each limited or driven coordinate becomes a drive of one row. Returns their handles.
/// Refuses values out of the ranges of SixDofDefinition and of these joints, and a joint that is free in every
/// coordinate; then nothing is added.
std::vector<ConstraintId> add_six_dof(Scene& scene, const SixDofDefinition& definition);

}  // namespace motley
#pragma GCC visibility pop
