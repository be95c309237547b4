// Which joints and body models the library was built with: MOTLEY_JOINTS and MOTLEY_MODELS of the build. What is not
// built has no kernels, and is refused when it is added.
#pragma once

#include "motley/core/body.h"

namespace motley {

/// Refuses a type of joint, by its number in JointTypes, that is not built.
void check_joint_is_built(int type);
/// Refuses a model of dynamic bodies that is not built; `field` is where the host named it.
void check_model_is_built(const char* field, BodyModel model);

}  // namespace motley
