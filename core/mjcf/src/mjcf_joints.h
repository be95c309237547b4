// Hinges and balls of a body, as joints of motley.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "mjcf_elements.h"
#include "mjcf_solids.h"
#include "motley/core/assembly.h"

namespace motley::mjcf {

/// A joint of a body with the body above it.
struct Joint {
    Element element;
    bool is_ball = false;
    Vec3<double> anchor{};       ///< m, world, in the pose of the file
    Vec3<double> axis{};         ///< unit, world; of a hinge
    TwistDriveDefinition drive;  ///< its limits, spring, friction and rotor; its bodies and frames are empty
    [[nodiscard]] bool drives() const
    {
        return drive.lower > -INFINITY || drive.upper < INFINITY || drive.has_spring() ||
               drive.motor_max_force > 0 || drive.armature > 0;
    }
};

/// What the <compiler> element says.
struct Compiler {
    double per_unit = 3.141592653589793 / 180;  ///< rad in a unit of angles
    bool limits_by_range = true;                ///< a joint with a range is limited unless it says otherwise
};

/// Reads a hinge or a ball.
Joint read_joint(const Element& element, const Frame& body, const Compiler& compiler);

/// Joints in a row that become one of motley: a ball, a hinge, or hinges as Euler angles.
using JointGroup = std::vector<Joint>;
/// Cuts the joints of a body, in the order in which they turn it, into groups.
std::vector<JointGroup> group(std::vector<Joint> joints);

/// A body of a figure and where its centre of mass is, m, world, in the pose of the file.
struct Placed {
    BodyId body{};
    Vec3<double> centre{};
};
/// Joins body b to body a above it.
void join(Figure& figure, const JointGroup& joints, const Placed& a, const Placed& b);

}  // namespace motley::mjcf
