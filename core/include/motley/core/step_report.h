// What a step did.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "motley/core/ids.h"

namespace motley {

/// The stages of a step, in their order, for the time table.
enum class Stage {
    intake,  ///< contacts checked, and found again from the last step
    colour,  ///< colours, and constraints sorted into blocks by them
    prepare,
    figures,
    integrate_velocities,
    warm_start,
    solve,  ///< and, of more than 65,535 contacts, what patches move and relax at the same visit
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
    done,     ///< the scene has moved on by dt
    refused,  ///< bad input, or no memory: nothing was changed; `error` says why
};

/// The errors of a scene's positions, in double from the definitions, not from what the solver believes.
struct SceneErrors {
    double joint_separation_rms = 0;  ///< m, over all joints but servos, which pull and hold nothing
    double joint_separation_max = 0;
    double joint_angle_rms = 0;  ///< rad, over the same
    double joint_angle_max = 0;
    double kinetic_energy = 0;       ///< J
    double momentum[3] = {0, 0, 0};  ///< kg m/s
};

/// How well a step solved what it set out to solve. The same bits for any threads and instruction set.
struct StepMeasures {
    /// What is left of J v + bias, limits and friction cones included, after the last substep's sweeps of `solve`:
    /// sqrt(sum of r^T K^-1 r) over all constraints, in sqrt(J). Zero exactly when every equation and every
    /// complementarity condition holds; see lane_residual.h.
    double residual_norm = 0;
    double residual_rms = 0;     ///< m/s, over the constraints: sqrt(r^T K^-1 r (1/m_a + 1/m_b))
    double residual_max = 0;     ///< m/s
    double penetration_rms = 0;  ///< m, over the host's contacts that overlap, as the step began
    double penetration_max = 0;
    SceneErrors before, after;  ///< of the step: their differences are the changes of energy and momentum
};

/// Returned by Solver::step. Counting is free; times cost two clock reads a stage.
struct StepReport {
    StepStatus status = StepStatus::done;
    std::string
        error;  ///< why it was refused; of a step that is done what its executor threw afterwards, if anything

    std::int64_t contacts = 0;
    std::int64_t contacts_skipped = 0;  ///< with BadContacts::skip: those that were left out
    std::string skipped_error;          ///< of the first of them: field, value and valid range
    std::int64_t joints = 0;
    std::int64_t joints_in_lockstep = 0;  ///< of them, those of copies of a figure that nothing else touched
    /// With SolverSettings::exact_joints: locks that sweeps solve all the same. They are of figures without a fixed body, in which a
    /// body with two locks or more is 2,000 times as light as another: solved exactly in float, they would not keep momentum.
    std::int64_t exact_joints_refused = 0;
    BodyId first_light_body{};        ///< such a body, where there is one
    int colours = 0;                  ///< colours in use, the overflow not counted
    std::int64_t overflow = 0;        ///< constraints that found no colour and ran in order
    std::int64_t blocks = 0;          ///< blocks of 16 lanes
    double lane_occupancy = 0;        ///< constraints / (16 blocks); 0 without constraints
    double bytes_per_constraint = 0;  ///< streamed by one sweep of solve: rows, impulses and indices
    std::int64_t sweeps = 0;          ///< sweeps over all constraints: warm starts, solves and relaxations
    int substeps = 0;                 ///< that were made; with a budget: that were picked
    int iterations = 0;               ///< most sweeps of solve in a substep
    bool over_budget = false;         ///< took longer than SolverSettings::budget_ms, if there is one
    std::int64_t islands = 0;         ///< found when SolverSettings::tolerance is above 0
    std::int64_t islands_above_tolerance = 0;  ///< after the last sweep of solve that was allowed
    StepMeasures measures;  ///< with SolverSettings::measures; with a budget its residuals alone
    double direct_violation =
        0;  ///< Method::direct: largest left of its equations and inequalities, m/s or rad/s
    /// Method::direct: islands left with more than 1e-9 m/s or rad/s of it, counted in every substep. 0: all is solved.
    /// Contradictory joints have no solution; they are met in the least squares, and counted here.
    std::int64_t direct_unsolved = 0;
    std::int64_t bodies_contained = 0;  ///< bodies frozen in this step because their state was not finite
    BodyId first_contained{};           ///< one of them

    std::array<double, stage_count> seconds{};  ///< by Stage
    [[nodiscard]] double total_seconds() const
    {
        double sum = 0;
        for (const double s : seconds) sum += s;
        return sum;
    }
};

}  // namespace motley
