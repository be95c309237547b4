// Six degrees of freedom, each free, limited or locked: one definition that becomes the fewest rows that do it.
#pragma once

#include <limits>
#include <vector>

#include "motley/core/scene.h"

namespace motley {

/// What one coordinate of a six-degree-of-freedom joint may do, and what drives it.
struct AxisSetup {
    float lower = 0;  ///< m or rad, <= upper; both 0: locked; -infinity and infinity: free
    float upper = 0;
    float motor_speed = 0;      ///< m/s or rad/s
    float motor_max_force = 0;  ///< N or N m; 0: no motor
    float spring_hertz = 0;     ///< 0: no spring
    float spring_damping_ratio = 0;
    float spring_stiffness = 0;  ///< N/m or N m/rad, instead of spring_hertz
    float spring_damping = 0;    ///< N s/m or N m s/rad
    float spring_target = 0;     ///< m or rad
    float spring_max_force = std::numeric_limits<float>::infinity();  ///< N or N m
    float armature = 0;  ///< kg or kg m2: of a rotor geared to the coordinate

    static AxisSetup locked() { return {}; }
    static AxisSetup free();
    static AxisSetup limited(float lower, float upper) { return {.lower = lower, .upper = upper}; }
};

/// What the rotations of a joint of six degrees of freedom are.
enum class SixDofRotation : std::uint8_t {
    about_axes,  ///< 2 atan2(q_i, q_w) of the quaternion q from a to b: alike in all directions; where one rotation moves alone, its angle
    euler        ///< EulerAngles, as a chain of three hinges has them
};

/// Frame b in frame a: three positions along the axes of a, and three rotations (SixDofRotation);
/// each locked, limited, driven or free. Beside the limits of single rotations a cone may keep x of
/// b near x of a: for loose joints it has no corners.
struct SixDofDefinition {
    BodyId body_a{};
    BodyId body_b{};
    JointFrame frame_a{};
    JointFrame frame_b{};
    AxisSetup position[3];  ///< along x, y, z of frame a
    AxisSetup rotation[3];  ///< about x (the twist), y, z; limits from -pi to pi
    SixDofRotation rotations = SixDofRotation::about_axes;
    float max_swing = 3.14159265F;  ///< rad, > 0 to pi: half the opening of the cone; pi: none
    JointStiffness stiffness{};     ///< of the locked coordinates
};

/// Adds the joints that a definition needs, and nothing more: locked coordinates become one joint of as many rows (the
/// very joint that a host would have chosen, a hinge or a slider), and each limited or driven one a drive of one row.
/// Returns their handles. Refuses what SixDofDefinition and the joints refuse; then nothing is added.
std::vector<ConstraintId> add_six_dof(Scene& scene, const SixDofDefinition& definition);

}  // namespace motley
