// The one list of constraint types. Storage, batches, kernels and typed tests follow from it: to add a joint, write its
// header x.h as constraint_type.h says, with the list XTypes of its types at its end, and put that name into
// JointTypes.
#pragma once

#include "motley/core/constraints/ball_socket.h"
#include "motley/core/constraints/contact.h"
#include "motley/core/constraints/distance.h"
#include "motley/core/constraints/drive.h"
#include "motley/core/constraints/frame_joint.h"
#include "motley/core/constraints/manifold.h"
#include "motley/core/constraints/pulley.h"
#include "motley/core/constraints/screw.h"
#include "motley/core/constraints/servo.h"
#include "motley/core/constraints/swing_limit.h"
#include "motley/core/constraints/transmission.h"

namespace motley {

/// The lists of the headers above: contacts first, then joints. The build compiles the kernels of each list separately.
using ConstraintLists =
    TypeList<ContactTypes, BallSocketTypes, DistanceTypes, FrameJointTypes, DriveTypes, SwingLimitTypes,
             ServoTypes, TransmissionTypes, PulleyTypes, ManifoldTypes, ScrewTypes>;

template <class Lists>
struct JointTypesOf;
template <class Contacts, class... Joints>
struct JointTypesOf<TypeList<Contacts, Joints...>> {
    using type = Joined<Joints...>;
};
using JointTypes = JointTypesOf<ConstraintLists>::type;

/// Types of constraint in all: contacts first, then joints, each at its place in the lists.
inline constexpr int contact_type_count = ContactTypes::size;
inline constexpr int constraint_type_count = ContactTypes::size + JointTypes::size;

}  // namespace motley
