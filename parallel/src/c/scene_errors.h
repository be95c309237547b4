// The errors of a scene, as they are and within the report of a step.
#pragma once

#include "mirror.h"
#include "motley/c/scene.h"
#include "motley/core/step_report.h"

namespace motley::c {

template <>
struct Mirror<motley_scene_errors, SceneErrors> : Pair<motley_scene_errors, SceneErrors> {
    static constexpr auto fields = std::tuple(
        MOTLEY_FIELD(joint_separation_rms), MOTLEY_FIELD(joint_separation_max), MOTLEY_FIELD(joint_angle_rms),
        MOTLEY_FIELD(joint_angle_max), MOTLEY_FIELD(kinetic_energy), MOTLEY_FIELD(momentum));
};

}  // namespace motley::c
