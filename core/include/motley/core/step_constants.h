// The numbers of a step that every constraint shares.
#pragma once

#include "motley/core/settings.h"

namespace motley {

/// delta lambda = -mass_scale K^-1 (J v + rate C) - impulse_scale lambda.
struct Softness {
    float rate = 0;  ///< 1/s
    float mass_scale = 1;
    float impulse_scale = 0;
};

/// The softness of a mass-spring-damper integrated implicitly: with w = 2 pi hertz,
/// a1 = 2 zeta + h w, a2 = h w a1, a3 = 1/(1 + a2); rate = w/a1, mass_scale = a2 a3, impulse_scale = a3.
/// hertz is capped at 0.25/h, the stiffest spring the substep can follow. (E. Catto, Soft Constraints, GDC
/// 2011)
Softness soft(float hertz, float damping_ratio, float substep);

/// Made once a step from the settings.
struct StepConstants {
    float substep = 0;          ///< s
    float inverse_substep = 0;  ///< 1/s
    float seconds = 0;          ///< of all substeps
    /// h dt / 2, s2: how far v += h a, x += h v takes a body too far in a step, per m/s2 of constant acceleration a.
    float flight_excess = 0;
    /// 1/s: the share of a lock's error that SolverSettings::exact_joints removes a second. Soft steps remove all of it in a substep and
    /// take the speed that this needed away again when they relax.
    float exact_rate = 0;
    Softness joint, contact, static_contact;
    float push_out_speed = 0;    ///< m/s; infinite speed is the largest float
    float slop = 0;              ///< m of penetration left alone
    float warm_start_scale = 0;  ///< this substep over the last one; 0 starts cold
    float restitution_threshold = 0;
    float projection_rate = 0;  ///< share of a contact's penetration removed by a projection
    Vec3<float> gravity{};
};

/// What relaxation sweeps with: rigid, without bias, and nothing held back. So relaxing and solving are one sweep.
StepConstants relaxing(StepConstants step);

/// `last_substep` is what the cached impulses were accumulated over; 0 if there are none.
StepConstants step_constants(const SolverSettings& settings, float dt, float last_substep);

}  // namespace motley
