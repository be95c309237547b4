// Settings, contacts and reports of steps of the C interface beside those of C++.
#pragma once

#include "handles.h"
#include "motley/c/solver.h"
#include "motley/core/constraints/contact_definition.h"
#include "motley/core/settings.h"
#include "motley/core/step_report.h"
#include "motley/soa/isa.h"
#include "scene_errors.h"

namespace motley::c {

template <>
inline constexpr int value_count<Method> = 3;
template <>
inline constexpr int value_count<DriftCorrection> = 4;
template <>
inline constexpr int value_count<BadContacts> = 2;
static_assert(static_cast<int>(Method::soft_step) == MOTLEY_SOFT_STEP);
static_assert(static_cast<int>(Method::sequential_impulse) == MOTLEY_SEQUENTIAL_IMPULSE);
static_assert(static_cast<int>(Method::direct) == MOTLEY_DIRECT);
static_assert(static_cast<int>(DriftCorrection::by_method) == MOTLEY_DRIFT_BY_METHOD);
static_assert(static_cast<int>(DriftCorrection::none) == MOTLEY_DRIFT_NONE);
static_assert(static_cast<int>(DriftCorrection::baumgarte) == MOTLEY_DRIFT_BAUMGARTE);
static_assert(static_cast<int>(DriftCorrection::projection) == MOTLEY_DRIFT_PROJECTION);
static_assert(static_cast<int>(BadContacts::refuse) == MOTLEY_REFUSE_BAD_CONTACTS);
static_assert(static_cast<int>(BadContacts::skip) == MOTLEY_SKIP_BAD_CONTACTS);
static_assert(static_cast<int>(Isa::scalar) == MOTLEY_ISA_SCALAR);
static_assert(static_cast<int>(Isa::sse2) == MOTLEY_ISA_SSE2);
static_assert(static_cast<int>(Isa::avx2) == MOTLEY_ISA_AVX2);
static_assert(static_cast<int>(Isa::avx512) == MOTLEY_ISA_AVX512);
static_assert(static_cast<int>(Isa::neon) == MOTLEY_ISA_NEON);

template <>
struct Mirror<motley_solver_settings, SolverSettings> : Pair<motley_solver_settings, SolverSettings> {
    static constexpr const char* name = "motley_solver_settings";
    static constexpr auto fields = std::tuple(
        MOTLEY_FIELD(method), MOTLEY_FIELD(substeps), MOTLEY_FIELD(iterations), MOTLEY_FIELD(relaxations),
        MOTLEY_FIELD(exact_joints), MOTLEY_FIELD(exact_contacts), MOTLEY_FIELD(warm_start),
        MOTLEY_FIELD(tolerance), MOTLEY_FIELD(budget_ms), MOTLEY_FIELD(measures), MOTLEY_FIELD(bad_contacts),
        MOTLEY_FIELD(gravity), MOTLEY_FIELD(contact_hertz), MOTLEY_FIELD(contact_damping_ratio),
        MOTLEY_FIELD(push_out_speed), MOTLEY_FIELD(joint_hertz), MOTLEY_FIELD(joint_damping_ratio),
        MOTLEY_FIELD(restitution_threshold), MOTLEY_FIELD(drift_correction), MOTLEY_FIELD(baumgarte),
        MOTLEY_FIELD(projections), MOTLEY_FIELD(penetration_slop), MOTLEY_FIELD(sleep_speed),
        MOTLEY_FIELD(sleep_after), MOTLEY_FIELD(exact_limits), MOTLEY_FIELD(exact_above_ratio));
};
template <>
inline constexpr std::size_t first_size<motley_solver_settings> = offsetof(motley_solver_settings,
                                                                           exact_limits);
template <>
struct Mirror<motley_contact, Contact> : Pair<motley_contact, Contact> {
    static constexpr auto fields =
        std::tuple(MOTLEY_FIELD(body_a), MOTLEY_FIELD(body_b), MOTLEY_FIELD(key), MOTLEY_FIELD(normal),
                   MOTLEY_FIELD(separation), MOTLEY_FIELD(arm_a), MOTLEY_FIELD(friction), MOTLEY_FIELD(arm_b),
                   MOTLEY_FIELD(restitution));
};
template <>
struct Mirror<motley_contact_impulse, ContactImpulse> : Pair<motley_contact_impulse, ContactImpulse> {
    static constexpr auto fields = std::tuple(MOTLEY_FIELD(normal), MOTLEY_FIELD(friction));
};
template <>
struct Mirror<motley_body_load, BodyLoad> : Pair<motley_body_load, BodyLoad> {
    static constexpr auto fields = std::tuple(MOTLEY_FIELD(normal_force), MOTLEY_FIELD(largest_normal_force),
                                              MOTLEY_FIELD(net_force), MOTLEY_FIELD(pressure));
};
template <>
struct Mirror<motley_step_measures, StepMeasures> : Pair<motley_step_measures, StepMeasures> {
    static constexpr auto fields =
        std::tuple(MOTLEY_FIELD(residual_norm), MOTLEY_FIELD(residual_rms), MOTLEY_FIELD(residual_max),
                   MOTLEY_FIELD(penetration_rms), MOTLEY_FIELD(penetration_max), MOTLEY_FIELD(before),
                   MOTLEY_FIELD(after));
};
template <>
struct Mirror<motley_step_report, StepReport> : Pair<motley_step_report, StepReport> {
    static constexpr const char* name = "motley_step_report";
    static constexpr std::size_t by_hand = 1;  // the status
    static constexpr auto fields = std::tuple(
        MOTLEY_FIELD(error), MOTLEY_FIELD(skipped_error), MOTLEY_FIELD(contacts), MOTLEY_FIELD(disc_contacts),
        MOTLEY_FIELD(shape_contacts), MOTLEY_FIELD(contacts_skipped), MOTLEY_FIELD(joints),
        MOTLEY_FIELD(joints_in_lockstep), MOTLEY_FIELD(exact_joints_refused), MOTLEY_FIELD(first_light_body),
        MOTLEY_FIELD(exact_contact_islands), MOTLEY_FIELD(exact_contacts_refused),
        MOTLEY_FIELD(exact_contacts_residual), MOTLEY_FIELD(colours), MOTLEY_FIELD(overflow),
        MOTLEY_FIELD(blocks), MOTLEY_FIELD(lane_occupancy), MOTLEY_FIELD(bytes_per_constraint),
        MOTLEY_FIELD(sweeps), MOTLEY_FIELD(substeps), MOTLEY_FIELD(iterations), MOTLEY_FIELD(over_budget),
        MOTLEY_FIELD(islands), MOTLEY_FIELD(islands_above_tolerance), MOTLEY_FIELD(measures),
        MOTLEY_FIELD(direct_violation), MOTLEY_FIELD(direct_unsolved), MOTLEY_FIELD(bodies_asleep),
        MOTLEY_FIELD(bodies_contained), MOTLEY_FIELD(first_contained), MOTLEY_FIELD(seconds));
};

}  // namespace motley::c
