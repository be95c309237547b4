// The one list of constraint types. Storage, batches, kernel tables and typed tests follow from it:
// to add a joint, write its header and put its name into JointTypes.
#pragma once

#include "motley/core/constraints/ball_socket.h"
#include "motley/core/constraints/contact.h"
#include "motley/core/constraints/distance.h"

namespace motley {

template <class... Types>
struct TypeList {
    static constexpr int size = sizeof...(Types);
};

using ContactTypes = TypeList<SmoothContact, FrictionContact>;
using JointTypes = TypeList<BallSocket, Distance>;

/// Types of constraint in all: contacts first, then joints, each at its place in the lists.
inline constexpr int contact_type_count = ContactTypes::size;
inline constexpr int constraint_type_count = ContactTypes::size + JointTypes::size;

}  // namespace motley
