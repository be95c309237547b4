// What a step did.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "motley/core/ids.h"

#pragma GCC visibility push(default)
namespace motley {

/// The stages of a step, in their order, for the time table.
enum class Stage {
    intake,  ///< checks contacts, and matches them with those of the last step
    colour,  ///< colours constraints, and sorts them into blocks by colour
    prepare,
    figures,
    integrate_velocities,
    warm_start,
    solve,  ///< with more than 65,535 contacts also the positions and relaxation of patches, each visited once
    integrate_positions,
    relax,
    restitution,
    store
};
inline constexpr int stage_count = 11;
/// "intake", "colour", ...
const char* stage_name(Stage stage);

/// How a step ended.
enum class StepStatus {
    done,     ///< the scene has advanced by dt
    refused,  ///< bad input, or no memory: nothing was changed; `error` says why
};

/// Errors, energy and momentum of a scene, computed in double from definitions and poses, not from the solver's own
/// rows.
struct SceneErrors {
    double joint_separation_rms = 0;  ///< m, over all joints but servos, which pull and hold nothing
    double joint_separation_max = 0;  ///< m
    double joint_angle_rms = 0;       ///< rad, over the same joints
    double joint_angle_max = 0;       ///< rad
    double kinetic_energy = 0;        ///< J
    double momentum[3] = {0, 0, 0};   ///< kg m/s, linear, world
};

/// How well a step solved its constraints. The same bits for any number of threads and instruction set.
struct StepMeasures {
    /// The residual r of J v + bias, limits and friction cones included, after the last sweep of `solve` in the last
    /// substep: sqrt(sum of r^T K^-1 r) over all constraints, K = J M^-1 J^T, in sqrt(J). Zero exactly when every
    /// equation and every complementarity condition holds; see lane_residual.h.
    double residual_norm = 0;
    double residual_rms = 0;     ///< m/s, over the constraints: sqrt(r^T K^-1 r (1/m_a + 1/m_b))
    double residual_max = 0;     ///< m/s, the largest of them
    double penetration_rms = 0;  ///< m, over the contacts that overlap, at the beginning of the step
    double penetration_max = 0;  ///< m
    SceneErrors before, after;   ///< of the step: their differences are the changes of energy and momentum
};

/// Returned by Solver::step. Counting is free; times cost two clock reads a stage.
struct StepReport {
    StepStatus status = StepStatus::done;
    std::string
        error;  ///< why the step was refused; if it is done, what the executor threw afterwards, if anything

    std::int64_t contacts = 0;  ///< that are solved: those of sleepers rest
    std::int64_t disc_contacts =
        0;  ///< of these, those of discs near each other or near walls that the library found
    std::int64_t shape_contacts = 0;      ///< of these, those of capsules that the library found
    std::int64_t contacts_skipped = 0;    ///< invalid contacts that BadContacts::skip left out
    std::string skipped_error;            ///< of the first of them: field, value and valid range
    std::int64_t joints = 0;              ///< likewise
    std::int64_t joints_in_lockstep = 0;  ///< joints of copies of a figure that touched no other moving body
    /// With SolverSettings::exact_joints: number of locks that sweeps solve nevertheless. They belong to figures
    /// without a fixed body in which a body with two or more locks has less than a millionth of the mass of another: too
    /// little for float to solve them exactly.
    std::int64_t exact_joints_refused = 0;
    BodyId first_light_body{};  ///< such a light body, if there is one
    /// With SolverSettings::exact_contacts: islands whose contacts are solved at once, those that are left to the sweeps
    /// because their matrix would be too dense, and the most that one more sweep would change a speed by, m/s.
    std::int64_t exact_contact_islands = 0, exact_contacts_refused = 0;
    double exact_contacts_residual = 0;
    int colours = 0;                  ///< colours in use, the overflow not counted
    std::int64_t overflow = 0;        ///< constraints that got no colour and were solved one after another
    std::int64_t blocks = 0;          ///< blocks of 16 lanes
    double lane_occupancy = 0;        ///< constraints / (16 blocks); 0 without constraints
    double bytes_per_constraint = 0;  ///< streamed by one sweep of solve: rows, impulses and indices
    std::int64_t sweeps = 0;          ///< sweeps over all constraints: warm starts, solves and relaxations
    int substeps = 0;                 ///< substeps made
    int iterations = 0;               ///< most sweeps of solve in a substep
    bool over_budget = false;         ///< took longer than SolverSettings::budget_ms, if that is above 0
    std::int64_t islands = 0;         ///< counted when SolverSettings::tolerance is above 0
    std::int64_t islands_above_tolerance = 0;  ///< those still above it after the last allowed sweep of solve
    StepMeasures measures;  ///< with SolverSettings::measures; with a budget only its residuals
    double direct_violation =
        0;  ///< Method::direct: largest residual of its equations and inequalities, m/s or rad/s
    /// Method::direct: islands with a larger residual than 1e-9 m/s or rad/s, summed over the substeps. 0: all are
    /// solved. Contradictory joints have no solution; they are solved in the least squares sense, and counted here.
    std::int64_t direct_unsolved = 0;
    std::int64_t bodies_asleep = 0;     ///< when the step has ended: see SolverSettings::sleep_speed
    std::int64_t bodies_contained = 0;  ///< bodies frozen in this step because their state was not finite
    BodyId first_contained{};           ///< one of them

    std::array<double, stage_count> seconds{};  ///< of each Stage
    [[nodiscard]] double total_seconds() const
    {
        double sum = 0;
        for (const double s : seconds) sum += s;
        return sum;
    }
};

}  // namespace motley
#pragma GCC visibility pop
