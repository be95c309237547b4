// The numbers of a step that every constraint shares.
#pragma once

#include "motley/core/vector.h"

namespace motley {

struct SolverSettings;

/// How soft a constraint is. With K = J M^-1 J^T and the accumulated impulse lambda, a sweep changes lambda by
/// -mass_scale K^-1 (J v + rate C) - impulse_scale lambda.
struct Softness {
    float rate = 0;  ///< 1/s
    float mass_scale = 1;
    float impulse_scale = 0;
};

/// The softness of a mass-spring-damper integrated implicitly: with w = 2 pi hertz, the damping ratio zeta and the
/// substep h, a1 = 2 zeta + h w, a2 = h w a1, a3 = 1/(1 + a2); rate = w/a1, mass_scale = a2 a3, impulse_scale = a3.
/// hertz is capped at 0.25/h, the stiffest spring the substep can follow. (E. Catto, Soft Constraints, GDC 2011)
Softness soft(float hertz, float damping_ratio, float substep);

/// Made once a step from the settings.
struct StepConstants {
    float substep = 0;          ///< s
    float inverse_substep = 0;  ///< 1/s
    float seconds = 0;          ///< s, all substeps together
    float moved_for = 0;  ///< s: for how long bodies have moved since rows were built: see carried_arms.h
    /// h dt / 2, s2: under a constant acceleration a, v += h a, x += h v moves a body by a times this too far in a
    /// step.
    float flight_excess = 0;
    /// 1/s: the rate at which SolverSettings::exact_joints removes the error of locks. Soft steps remove all of it in a
    /// substep; relaxation then takes away the speed that this needed.
    float exact_rate = 0;
    bool exact_limits = false;  ///< holds_limits()
    Softness joint, contact, static_contact;
    float push_out_speed = 0;         ///< m/s
    float slop = 0;                   ///< m, penetration that is not corrected
    float warm_start_scale = 0;       ///< this substep over the last one, at most 1; 0 starts cold
    float restitution_threshold = 0;  ///< m/s
    float projection_rate = 0;        ///< share of a contact's penetration removed by a projection
    Vec3<float> gravity{};
};

/// Whether trees hold limits, motors and springs: where the host asks for it, and in figures that are exact because of their loads,
/// which would hang on swept ones.
bool holds_limits(const SolverSettings& settings);

/// The constants of relaxation: rigid, without bias and without a bound on push-out. With them `solve` relaxes.
StepConstants relaxing(StepConstants step);

/// `last_substep` is the duration, s, of the substep that the cached impulses are of; 0 if there are none.
StepConstants step_constants(const SolverSettings& settings, float dt, float last_substep);

}  // namespace motley
