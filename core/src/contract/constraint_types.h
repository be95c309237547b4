// The one list of constraint types. Storage, batches, kernels and typed tests follow from it: to add a joint, write its
// header x.h as constraint_type.h says, with the list XTypes of its types at its end, and put that name into
// JointTypes.
#pragma once

#include "constraints/ball_socket.h"
#include "constraints/contact.h"
#include "constraints/distance.h"
#include "constraints/drive.h"
#include "constraints/frame_joint.h"
#include "constraints/manifold.h"
#include "constraints/pulley.h"
#include "constraints/screw.h"
#include "constraints/servo.h"
#include "constraints/swing_limit.h"
#include "constraints/transmission.h"

namespace motley {

/// The lists of the headers above: contacts first, then joints. The build compiles the kernels of each list separately.
using AllConstraintLists =
    TypeList<ContactTypes, BallSocketTypes, DistanceTypes, FrameJointTypes, DriveTypes, SwingLimitTypes,
             ServoTypes, TransmissionTypes, PulleyTypes, ManifoldTypes, ScrewTypes>;
/// Those that are built (MOTLEY_JOINTS of the build). Of others there is no code: see built.h.
#ifdef MOTLEY_BUILT_TYPES
using ConstraintLists = TypeList<MOTLEY_BUILT_TYPES>;
#else
using ConstraintLists = AllConstraintLists;
#endif

template <class Lists>
struct JointTypesOf;
template <class Contacts, class... Joints>
struct JointTypesOf<TypeList<Contacts, Joints...>> {
    using type = Joined<Joints...>;
};
using AllJointTypes = JointTypesOf<AllConstraintLists>::type;
using JointTypes = JointTypesOf<ConstraintLists>::type;

/// Types of constraint in all: contacts first, then joints, each at its place in the lists.
inline constexpr int contact_type_count = ContactTypes::size;
inline constexpr int constraint_type_count = ContactTypes::size + JointTypes::size;

}  // namespace motley
