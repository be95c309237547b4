// The model of each joint that a host may define.
#pragma once

#include "motley/core/joint_definitions.h"
#include "motley/reference/joint.h"

namespace motley::reference {

using Model = std::shared_ptr<const JointModel>;

Model model_of(const BallSocketDefinition& joint);
Model model_of(const DistanceDefinition& joint);
Model model_of(const SwingLimitDefinition& limit);
Model model_of(const PointServoDefinition& servo);
Model model_of(const AngularServoDefinition& servo);
Model model_of(const GearDefinition& gear);
Model model_of(const RackAndPinionDefinition& rack);
Model model_of(const ScrewDefinition& screw);
Model model_of(const PulleyDefinition& pulley);
Model model_of(const ManifoldDefinition& contact);
Model frame_model(const JointFrame& frame_a, const JointFrame& frame_b, const JointStiffness& stiffness,
                  LinearLock linear, AngularLock angular);
Model drive_model(const SlideDriveDefinition& drive, DriveAxis axis);

template <LinearLock linear, AngularLock angular>
Model model_of(const FrameJointDefinition<linear, angular>& joint)
{
    return frame_model(joint.frame_a, joint.frame_b, joint.stiffness, linear, angular);
}
/// The definitions of all drives have the same fields as that of a slide drive.
template <DriveAxis axis>
Model model_of(const DriveDefinition<axis>& drive)
{
    const auto& [a, b, frame_a, frame_b, lower, upper, motor_speed, motor_max_force, hertz, damping_ratio,
                 stiffness, damping, target, max_force, armature, angle] = drive;
    return drive_model({a, b, frame_a, frame_b, lower, upper, motor_speed, motor_max_force, hertz,
                        damping_ratio, stiffness, damping, target, max_force, armature, angle},
                       axis);
}

}  // namespace motley::reference
