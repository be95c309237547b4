// See mjcf_joints.h.
#include "mjcf_joints.h"

#include <cmath>
#include <numbers>
#include <utility>

namespace motley::mjcf {
namespace {

using std::numbers::pi;

float not_negative(const Element& element, const char* name)
{
    const double value = element.number(name, 0);
    if (!(value >= 0))
        element.refuse(std::string(name) + " is " + element.text(name, "") + "; expected 0 or more");
    return static_cast<float>(value);
}

bool is_limited(const Element& element, const Compiler& compiler)
{
    const std::string limited = element.text("limited", "auto");
    if (limited == "true") return true;
    if (limited == "false") return false;
    if (limited != "auto") element.refuse("limited is " + limited + "; expected true, false or auto");
    return compiler.limits_by_range && element.has("range");
}

void read_limits(const Element& element, const Compiler& compiler, TwistDriveDefinition& drive)
{
    const std::vector<double> range = element.numbers("range", 2, 2);
    if (range.empty()) element.refuse("is limited and has no range");
    const double lower = compiler.per_unit * range[0], upper = compiler.per_unit * range[1];
    if (!(lower <= upper && lower >= -pi - 1e-6 && upper <= pi + 1e-6))
        element.refuse("range is '" + element.text("range", "") +
                       "'; expected two angles in order within half a turn");
    drive.lower = static_cast<float>(std::max(lower, -pi));
    drive.upper = static_cast<float>(std::min(upper, pi));
}

/// Whether two hinges turn about the same point, and about axes that are perpendicular, to a hundredth of a degree.
bool can_share_a_point(const Joint& one, const Joint& other)
{
    const Vec3<double> apart = one.anchor - other.anchor;
    return dot(apart, apart) < 1e-12 && std::abs(dot(one.axis, other.axis)) < 2e-4;
}

/// Euler angles jump where the middle one reaches a right angle.
bool stays_below_a_right_angle(const Joint& joint)
{
    constexpr float most = 1.5F;
    return joint.drive.lower > -most && joint.drive.upper < most;
}

bool fits(const JointGroup& group, const Joint& next)
{
    if (next.is_ball || group.front().is_ball || group.size() == 3) return false;
    for (const Joint& joint : group) {
        if (!can_share_a_point(joint, next)) return false;
    }
    // The second of them is the middle one.
    return stays_below_a_right_angle(group.size() == 1 ? next : group[1]);
}

JointFrame frame_on(const Placed& body, const Vec3<double>& anchor, const Quat<double>& turn)
{
    return {convert<float>(anchor - body.centre), convert<float>(turn)};
}

/// A drive's limits, spring and so on, with the sign of its angle changed.
TwistDriveDefinition reversed(TwistDriveDefinition drive)
{
    drive.lower = -std::exchange(drive.upper, -drive.lower);
    drive.spring_target = -drive.spring_target;
    return drive;
}

/// Adds a drive along one axis with what was read of a hinge.
template <class Drive>
void add_drive(Figure& figure, const TwistDriveDefinition& like, const JointFrame& frame_a,
               const JointFrame& frame_b, const Placed& a, const Placed& b, EulerAngle angle)
{
    Drive drive;
    drive.body_a = a.body;
    drive.body_b = b.body;
    drive.frame_a = frame_a;
    drive.frame_b = frame_b;
    drive.lower = like.lower;
    drive.upper = like.upper;
    drive.motor_max_force = like.motor_max_force;
    drive.spring_stiffness = like.spring_stiffness;
    drive.spring_damping = like.spring_damping;
    drive.spring_target = like.spring_target;
    drive.armature = like.armature;
    drive.angle = angle;
    figure.add_joint(drive);
}

void join_by_hinge(Figure& figure, const Joint& joint, const Placed& a, const Placed& b)
{
    const Quat<double> turn = turn_to(joint.axis, perpendicular_to(joint.axis));
    const JointFrame frame_a = frame_on(a, joint.anchor, turn), frame_b = frame_on(b, joint.anchor, turn);
    figure.add_joint(HingeDefinition{a.body, b.body, frame_a, frame_b, {}});
    if (joint.drives())
        add_drive<TwistDriveDefinition>(figure, joint.drive, frame_a, frame_b, a, b, EulerAngle::x);
}

/// Hinges one after another about x, then y', then z'': a ball-socket with Euler angles.
void join_by_angles(Figure& figure, const JointGroup& joints, const Placed& a, const Placed& b)
{
    const Vec3<double> x = joints[0].axis, y = joints[1].axis;
    const Quat<double> turn = turn_to(x, y);
    const Vec3<double>& anchor = joints[0].anchor;
    const JointFrame frame_a = frame_on(a, anchor, turn), frame_b = frame_on(b, anchor, turn);
    figure.add_joint(BallSocketDefinition{a.body, b.body, frame_a.position, frame_b.position});
    if (joints.size() == 2)
        figure.add_joint(PerpendicularAxesDefinition{a.body, b.body, frame_a, frame_b, {}});
    constexpr EulerAngle angles[] = {EulerAngle::x, EulerAngle::y, EulerAngle::z};
    for (std::size_t i = 0; i < joints.size(); ++i) {
        if (!joints[i].drives()) continue;
        const bool is_against_z = i == 2 && dot(joints[2].axis, cross(x, y)) < 0;
        add_drive<EulerDriveDefinition>(figure, is_against_z ? reversed(joints[i].drive) : joints[i].drive,
                                        frame_a, frame_b, a, b, angles[i]);
    }
}

}  // namespace

Joint read_joint(const Element& element, const Frame& body, const Compiler& compiler)
{
    const std::string type = element.text("type", "hinge");
    if (type != "hinge" && type != "ball")
        element.refuse("type is " + type + "; expected hinge, ball or, below the world, free");
    element.allow_only({"name", "class", "type", "pos", "axis", "range", "limited", "stiffness", "springref",
                        "damping", "armature", "frictionloss", "ref"},
                       {"group", "solreflimit", "solimplimit", "solreffriction", "solimpfriction", "margin"});
    element.demand_zero("ref");
    Joint joint{element,
                type == "ball",
                body.to_world(element.vector("pos", {})),
                rotate(body.orientation, element.direction("axis", {0, 0, 1})),
                {}};
    if (is_limited(element, compiler)) {
        if (joint.is_ball) element.refuse("is a ball joint with limits, which is not read");
        read_limits(element, compiler, joint.drive);
    }
    joint.drive.spring_stiffness = not_negative(element, "stiffness");
    joint.drive.spring_damping = not_negative(element, "damping");
    joint.drive.spring_target = static_cast<float>(compiler.per_unit * element.number("springref", 0));
    joint.drive.motor_max_force = not_negative(element, "frictionloss");
    joint.drive.armature = not_negative(element, "armature");
    if (joint.is_ball && joint.drives())
        element.refuse("is a ball joint with a spring, a damper or a rotor, which is not read");
    return joint;
}

std::vector<JointGroup> group(std::vector<Joint> joints)
{
    std::vector<JointGroup> groups;
    for (Joint& joint : joints) {
        if (groups.empty() || !fits(groups.back(), joint)) groups.emplace_back();
        groups.back().push_back(std::move(joint));
    }
    return groups;
}

void join(Figure& figure, const JointGroup& joints, const Placed& a, const Placed& b)
{
    if (joints.size() > 1) return join_by_angles(figure, joints, a, b);
    const Joint& joint = joints.front();
    if (!joint.is_ball) return join_by_hinge(figure, joint, a, b);
    figure.add_joint(BallSocketDefinition{a.body, b.body, convert<float>(joint.anchor - a.centre),
                                          convert<float>(joint.anchor - b.centre)});
}

}  // namespace motley::mjcf
