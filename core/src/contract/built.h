// Which joints, body models and methods the library was built with: MOTLEY_JOINTS, MOTLEY_MODELS and MOTLEY_DIRECT of the
// build. What is not built has no code, and is refused when it is added or asked for.
#pragma once

#include <string_view>

#include "motley/core/body.h"
#include "motley/core/settings.h"

namespace motley {

/// Refuses a joint that is not built, by the name of its definition.
[[noreturn]] void refuse_unbuilt_joint(std::string_view definition);
/// Refuses a model of dynamic bodies that is not built; `field` is where the host named it.
void check_model_is_built(const char* field, BodyModel model);
/// Refuses a method that is not built.
void check_method_is_built(Method method);

}  // namespace motley
