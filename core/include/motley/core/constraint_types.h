// The one list of constraint types. Storage, batches, kernel tables and typed tests follow from it: to add a joint, write
// its header as joint_type.h says and put its name into JointTypes.
#pragma once

#include "motley/core/constraints/ball_socket.h"
#include "motley/core/constraints/contact.h"
#include "motley/core/constraints/distance.h"
#include "motley/core/constraints/drive.h"
#include "motley/core/constraints/frame_joint.h"
#include "motley/core/constraints/manifold.h"
#include "motley/core/constraints/pulley.h"
#include "motley/core/constraints/servo.h"
#include "motley/core/constraints/swing_limit.h"
#include "motley/core/constraints/transmission.h"

namespace motley {

template <class... Types>
struct TypeList {
    static constexpr int size = sizeof...(Types);
};

/// In the order of Touch.
using ContactTypes = TypeList<SmoothContact, RoughContact, BouncingContact>;
template <class Definition>
struct FrameJointOf;
template <LinearLock linear, AngularLock angular>
struct FrameJointOf<FrameJointDefinition<linear, angular>> {
    using type = FrameJoint<linear, angular>;
};

using JointTypes =
    TypeList<BallSocket, Distance, FrameJointOf<FixedDefinition>::type, FrameJointOf<HingeDefinition>::type,
             FrameJointOf<SliderDefinition>::type, FrameJointOf<PointOnPlaneDefinition>::type,
             FrameJointOf<PointOnLineDefinition>::type, FrameJointOf<RotationLockDefinition>::type,
             FrameJointOf<ParallelAxesDefinition>::type, FrameJointOf<PerpendicularAxesDefinition>::type,
             Drive<DriveAxis::slide>, Drive<DriveAxis::twist>, SwingLimit, PointServo, AngularServo, Gear,
             RackAndPinion, Pulley, Manifold>;

/// Types of constraint in all: contacts first, then joints, each at its place in the lists.
inline constexpr int contact_type_count = ContactTypes::size;
inline constexpr int constraint_type_count = ContactTypes::size + JointTypes::size;

}  // namespace motley
