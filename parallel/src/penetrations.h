// How deep the contacts of a step overlapped when it began.
#pragma once

#include <span>

#include "motley/core/constraints/contact_definition.h"
#include "motley/core/step_report.h"
#include "scene/scene_core.h"

namespace motley {

/// Fills in the penetrations of a step's measures, after its rows were made and before its contacts are taken for those of the last
/// step. `contacts` are those of the list and of capsules; those of discs are in their blocks.
void note_penetrations(const SceneCore& scene, std::span<const Contact> contacts, StepMeasures& measures);

}  // namespace motley
