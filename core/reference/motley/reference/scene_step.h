// Method::direct: a step of a scene, by the reference.
#pragma once

#include <span>

#include "motley/core/constraints/contact_definition.h"
#include "motley/core/scene_core.h"
#include "motley/core/settings.h"
#include "motley/reference/direct_result.h"

namespace motley::reference {

/// Moves a scene on by `dt` seconds with everything solved at once in double. The contacts are those that the scene's
/// cache has staged. Bodies, joint memories and staged contact impulses are written; bodies whose state is no longer
/// finite are left as such, for BodyStore::commit to contain.
DirectResult step_directly(SceneCore& scene, float dt, const SolverSettings& settings,
                           std::span<const Contact> contacts);

}  // namespace motley::reference
