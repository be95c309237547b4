// The one list of constraint types. Storage, batches, kernel tables and typed tests follow from it:
// to add a joint, write its header and put its name into JointTypes.
#pragma once

#include "motley/core/constraints/ball_socket.h"
#include "motley/core/constraints/contact.h"
#include "motley/core/constraints/distance.h"
#include "motley/core/constraints/drive.h"
#include "motley/core/constraints/frame_joint.h"

namespace motley {

template <class... Types>
struct TypeList {
    static constexpr int size = sizeof...(Types);
};

using ContactTypes = TypeList<SmoothContact, FrictionContact>;
template <class Definition>
struct FrameJointOf;
template <LinearLock linear, AngularLock angular>
struct FrameJointOf<FrameJointDefinition<linear, angular>> {
    using type = FrameJoint<linear, angular>;
};

using Fixed = FrameJointOf<FixedDefinition>::type;
using Hinge = FrameJointOf<HingeDefinition>::type;
using Slider = FrameJointOf<SliderDefinition>::type;

using SlideDrive = Drive<DriveAxis::slide>;
using TwistDrive = Drive<DriveAxis::twist>;

using JointTypes = TypeList<BallSocket, Distance, Fixed, Hinge, Slider, SlideDrive, TwistDrive>;

/// Types of constraint in all: contacts first, then joints, each at its place in the lists.
inline constexpr int contact_type_count = ContactTypes::size;
inline constexpr int constraint_type_count = ContactTypes::size + JointTypes::size;

}  // namespace motley
