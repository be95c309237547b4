// Method::direct: a step of a scene, by the reference.
#pragma once

#include <span>

#include "maths/contact_surface.h"
#include "motley/core/constraints/contact_definition.h"
#include "motley/core/settings.h"
#include "motley/reference/direct_result.h"
#include "scene/scene_core.h"

namespace motley::reference {

/// Advances a scene by `dt` seconds, with all constraints solved at once in double. `contacts` are those that the scene's cache has
/// staged, and `surfaces` those of the last of them; the others have the default. The rows of contacts of discs are made. Writes
/// bodies, joint memories, staged contact impulses and those of discs. Bodies whose state has become infinite or NaN are left so,
/// for BodyStore::commit to contain.
DirectResult step_directly(SceneCore& scene, float dt, const SolverSettings& settings,
                           std::span<const Contact> contacts,
                           std::span<const ContactSurface<float>> surfaces);

}  // namespace motley::reference
