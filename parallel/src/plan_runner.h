// Runs the plan of a step over the colours of a whole scene.
#pragma once

#include <cstdint>
#include <span>

#include "contacts/exact_contacts.h"
#include "disc_pipeline.h"
#include "layout/layout.h"
#include "renewal.h"
#include "step/convergence.h"
#include "step/plan.h"
#include "step_clock.h"
#include "sweeper.h"

namespace motley {

class PlanRunner {
  public:
    PlanRunner(Sweeper& sweeper, DiscPipeline& discs, Layout& layout)
        : sweeper_(sweeper), discs_(discs), layout_(layout), renewal_(sweeper, layout)
    {
    }

    /// What a step needs in addition to its plan.
    struct Step {
        SceneCore& scene;
        std::span<const Contact> contacts;
        float dt;  ///< s
        const SolverSettings& settings;
        bool picks_islands;  ///< some islands want more sweeps than others: see Convergence
        StepReport& report;
    };
    /// With SolverSettings::exact_contacts: finds the islands of contacts, and makes space to solve them.
    void find_contact_islands(const SceneCore& scene, float dt);
    /// Runs the stages of `plan`. Figures that touch no other moving body run `figure_plan`, in which no stages are fused.
    void run(const Plan& plan, const Plan& figure_plan, const Step& step, StepClock& clock);

    /// Whether there are so many sweeps that velocities are computed anew from impulses between them; see Renewal.
    static bool sweeps_long(const SolverSettings& settings);

  private:
    Sweeper& sweeper_;
    DiscPipeline& discs_;
    Layout& layout_;
    Convergence convergence_;
    Renewal renewal_;
    ExactContacts exact_contacts_;
    int solves_in_substep_ = 0;

    void run_stage(const PlanStage& stage, int substep, const Plan& plan, const Plan& figure_plan,
                   const Step& step);
    void sweep(ConstraintKernels::Sweep ConstraintKernels::*kernel, const PlanStage& stage, const Step& step);
    int iterate(ConstraintKernels::Sweep ConstraintKernels::*kernel, int times, const Step& step);
    int iterate_by_island(ConstraintKernels::Sweep ConstraintKernels::*kernel, int times, const Step& step);
    [[nodiscard]] bool renews(const SolverSettings& settings) const;
    void renew_after(int done, int most);
    [[nodiscard]] float exact_rate(ConstraintKernels::Sweep ConstraintKernels::*kernel) const;
    void measure_residual(const Step& step);
    void begin_exact_contacts(const Step& step);
    void solve_exactly(ConstraintKernels::Sweep ConstraintKernels::*kernel, const Step& step);
    void move_bodies(const Step& step);
};

}  // namespace motley
