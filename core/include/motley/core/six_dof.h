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
    float spring_target = 0;                                          ///< m or rad
    float spring_max_force = std::numeric_limits<float>::infinity();  ///< N or N m

    static AxisSetup locked() { return {}; }
    static AxisSetup free();
    static AxisSetup limited(float lower, float upper) { return {.lower = lower, .upper = upper}; }
};

/// Frame b in frame a: three positions along the axes of a, a twist about x, and a swing of x away from x.
///
/// Positions may each be locked, limited, driven or free. Of rotations: all locked; the swing locked and the twist loose
/// (a hinge); the swing loose, free or within a cone, and the twist locked, limited, driven or free; or the swing loose
/// about y alone (with the position locked a universal joint). Two rotations locked about other axes are a hinge about
/// the third, which the frames can be turned to.
struct SixDofDefinition {
    BodyId body_a{};
    BodyId body_b{};
    JointFrame frame_a{};
    JointFrame frame_b{};
    AxisSetup position[3];  ///< along x, y, z of frame a
    AxisSetup twist;        ///< about x
    /// rad, 0 to pi: 0 locks the swing, pi leaves it free, between is a cone.
    float max_swing = 0;
    bool locks_swing_about_z = false;  ///< y of b stays across x of a; the swing must be loose
    JointStiffness stiffness{};        ///< of the locked coordinates
};

/// Adds the joints that a definition needs, and nothing more: locked coordinates become one joint of as many rows (the
/// very joint that a host would have chosen, a hinge or a slider), and each limited or driven one a drive of one row.
/// Returns their handles. Refuses what SixDofDefinition and the joints refuse; then nothing is added.
std::vector<ConstraintId> add_six_dof(Scene& scene, const SixDofDefinition& definition);

}  // namespace motley
