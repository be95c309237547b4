// The ranges of settings, and the constants that a step derives from them.
#include "maths/step_constants.h"

#include <algorithm>
#include <limits>

#include "contract/built.h"
#include "motley/core/invalid_input.h"
#include "motley/core/settings.h"

namespace motley {
namespace {

void check(std::string_view field, double value, double low, double high, std::string_view expected)
{
    if (!(value >= low && value <= high)) refuse(field, value, expected);  // NaN fails too
}

}  // namespace

void SolverSettings::validate() const
{
    if (method < Method::soft_step || method > Method::direct) {
        refuse("SolverSettings.method", static_cast<double>(method),
               "soft_step, sequential_impulse or direct");
    }
    check_method_is_built(method);
    if (bad_contacts < BadContacts::refuse || bad_contacts > BadContacts::skip)
        refuse("SolverSettings.bad_contacts", static_cast<double>(bad_contacts), "refuse or skip");
    if (drift_correction < DriftCorrection::by_method || drift_correction > DriftCorrection::projection) {
        refuse("SolverSettings.drift_correction", static_cast<double>(drift_correction),
               "by_method, none, baumgarte or projection");
    }
    check("SolverSettings.substeps", substeps, 1, 1024, "1 to 1024");
    check("SolverSettings.iterations", iterations, 0, 10000, "0 (the method's) or 1 to 10000");
    check("SolverSettings.relaxations", relaxations, 0, 10000, "0 to 10000");
    check("SolverSettings.projections", projections, 0, 10000, "0 to 10000");
    constexpr double big = 1e9;
    if (!(exact_above_ratio >= 1))
        refuse("SolverSettings.exact_above_ratio", exact_above_ratio, "1 or more, or infinite");
    check("SolverSettings.tolerance", tolerance, 0, big, "0 to 1e9 (m/s)");
    check("SolverSettings.budget_ms", budget_ms, 0, 1e6, "0 to 1e6 (ms)");
    check("SolverSettings.gravity.x", gravity.x, -big, big, "a finite value from -1e9 to 1e9 (m/s2)");
    check("SolverSettings.gravity.y", gravity.y, -big, big, "a finite value from -1e9 to 1e9 (m/s2)");
    check("SolverSettings.gravity.z", gravity.z, -big, big, "a finite value from -1e9 to 1e9 (m/s2)");
    if (contact_hertz != 0)
        check("SolverSettings.contact_hertz", contact_hertz, 1e-3F, 1e6, "0 or 0.001 to 1e6 (Hz)");
    check("SolverSettings.contact_damping_ratio", contact_damping_ratio, 0, 1e6, "0 to 1e6");
    check("SolverSettings.joint_hertz", joint_hertz, 1e-3F, 1e6, "0.001 to 1e6 (Hz)");
    check("SolverSettings.joint_damping_ratio", joint_damping_ratio, 0, 1e6, "0 to 1e6");
    check("SolverSettings.push_out_speed", push_out_speed, 1e-6F, big, "1e-6 to 1e9 (m/s)");
    check("SolverSettings.restitution_threshold", restitution_threshold, 0, big, "0 to 1e9 (m/s)");
    check("SolverSettings.baumgarte", baumgarte, 0, 1, "0 to 1");
    check("SolverSettings.penetration_slop", penetration_slop, 0, big, "0 to 1e9 (m)");
    check("SolverSettings.sleep_speed", sleep_speed, 0, big, "0 to 1e9 (m/s)");
    check("SolverSettings.sleep_after", sleep_after, 0, big, "0 to 1e9 (s)");
    if (sleep_speed > 0 && method == Method::direct)
        refuse("SolverSettings.sleep_speed", sleep_speed, "0 with Method::direct, which lets nobody sleep");
}

SolverSettings SolverSettings::resolved() const
{
    SolverSettings settings = *this;
    const bool sweeps_rigidly = method == Method::sequential_impulse;
    if (iterations == 0) settings.iterations = sweeps_rigidly ? 8 : 1;
    settings.exact_contacts = exact_contacts && method != Method::direct;
    if (drift_correction == DriftCorrection::by_method)
        settings.drift_correction =
            sweeps_rigidly && !exact_joints ? DriftCorrection::projection : DriftCorrection::baumgarte;
    return settings;
}

Softness soft(float hertz, float damping_ratio, float substep)
{
    const float omega = 6.2831853F * std::min(hertz, 0.25F / substep);
    const float a1 = 2 * damping_ratio + substep * omega;
    const float a2 = substep * omega * a1;
    const float a3 = 1 / (1 + a2);
    return {omega / a1, a2 * a3, a3};
}

StepConstants relaxing(StepConstants step)
{
    step.joint = step.contact = step.static_contact = Softness{};
    // Above any speed, and no overflow when multiplied by the largest inertia that is accepted, 1e20 kg m2.
    step.push_out_speed = 1e17F;
    step.moved_for = step.substep;
    return step;
}

bool holds_limits(const SolverSettings& settings)
{
    return settings.exact_limits || !settings.exact_joints;
}

StepConstants step_constants(const SolverSettings& settings, float dt, float last_substep)
{
    StepConstants step;
    step.substep = dt / static_cast<float>(settings.substeps);
    step.inverse_substep = 1 / step.substep;
    step.seconds = dt;
    // Method::direct corrects free flight itself (core/reference).
    if (settings.method != Method::direct) step.flight_excess = 0.5F * step.substep * dt;
    step.gravity = settings.gravity;
    step.exact_limits = holds_limits(settings);
    step.restitution_threshold = settings.restitution_threshold;
    step.push_out_speed = settings.push_out_speed;
    // An impulse is a force times the substep, so a cached one is scaled when the substep changes; but never up,
    // because an impulse that corrected an error in a short substep is not a force, and would throw bodies in a long
    // one.
    step.warm_start_scale =
        settings.warm_start && last_substep > 0 ? std::min(1.0F, step.substep / last_substep) : 0.0F;
    // Method::direct scales impulses itself (core/reference).
    if (settings.method == Method::direct) step.warm_start_scale = 1;
    if (settings.method == Method::soft_step) {
        // Nor is an error that a longer substep left corrected faster than that one would have: that would be a blow.
        const float longer_substep = std::max(step.substep, last_substep);
        const float stiffest = 0.25F / longer_substep;
        step.exact_rate = 1 / longer_substep;
        step.joint =
            soft(std::min(settings.joint_hertz, stiffest), settings.joint_damping_ratio, step.substep);
        const float contact_hertz =
            settings.contact_hertz > 0 ? settings.contact_hertz : std::max(30.0F, 0.5F * stiffest);
        step.contact = soft(contact_hertz, settings.contact_damping_ratio, step.substep);
        // Contacts with bodies that cannot give way are twice as stiff, or a crowd would sink into its walls first.
        step.static_contact = soft(2 * contact_hertz, settings.contact_damping_ratio, step.substep);
    } else {
        const bool baumgarte = settings.drift_correction == DriftCorrection::baumgarte;
        const Softness rigid{baumgarte ? settings.baumgarte * step.inverse_substep : 0.0F, 1, 0};
        step.joint = step.contact = step.static_contact = rigid;
        step.exact_rate = rigid.rate;
        step.slop = settings.penetration_slop;
        step.projection_rate = settings.baumgarte;
    }
    return step;
}

}  // namespace motley
