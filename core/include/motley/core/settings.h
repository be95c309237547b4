// The dials of a step. Every one trades speed for accuracy or stiffness for calm; the README has the prices.
#pragma once

#include "motley/core/vector.h"

namespace motley {

/// How the constraints of a step are solved.
enum class Method {
    /// Substeps with soft constraints and a relaxation pass. Few sweeps a substep, many substeps.
    soft_step,
    /// The theory's loop: integrate velocities, warm start, iterate rigid constraints, integrate positions.
    sequential_impulse,
    /// Everything at once, in double: exact for equalities at any mass ratio, and limits, friction and contacts to 1e-9 m/s,
    /// or StepReport::direct_unsolved says that an island was left with more (friction between masses 1 : 1000, or many
    /// contacts that hold what joints pull apart). One sparse system a substep and island, on one thread: for small
    /// scenes, and as the truth for the others. Rigid, with `drift_correction`; ignores `iterations`, `relaxations`,
    /// `warm_start` and the softness of contacts and joints (springs keep theirs). Allocates. Milliseconds a step for a
    /// thousand rows at rest or nearly so, a tenth of a second to one where most of them start or stop to slide.
    direct,
};

/// What `sequential_impulse` and `direct` do about the position error that velocity constraints leave.
enum class DriftCorrection {
    /// projection for `sequential_impulse`, but baumgarte for `direct` and with `exact_joints`
    by_method,
    none,  ///< nothing: shows the drift
    /// Adds beta C / h to the velocity constraint; `direct` also holds what that promises where a substep ends. Sweeps that
    /// have not converged leave some of it in the velocities: long or loaded chains gain energy.
    baumgarte,
    projection,  ///< moves positions along J^T after the integration, weighted by inverse mass
};

/// What a step does about a contact that it cannot take (see Contact for the valid ranges).
enum class BadContacts {
    refuse,  ///< the whole step is refused
    skip,    ///< it is left out, and the report tells. A key that comes twice is refused all the same
};

/// Settings of a step. A default-constructed value is a sensible crowd at 60 Hz.
struct SolverSettings {
    Method method = Method::soft_step;
    int substeps = 4;     ///< 1 to 1024; position and velocity integrations a step
    int iterations = 0;   ///< sweeps a substep, 1 to 10000; 0: 1 for soft_step, 8 for sequential_impulse
    int relaxations = 1;  ///< 0 to 10000; soft_step: sweeps without bias a substep
    /// soft_step, and sequential_impulse with baumgarte: locks (ball-sockets, fixed joints, hinges, sliders and their
    /// parts) between rigid bodies are solved all at once, exactly at any mass ratio, where they hang together as a
    /// tree with few loops (24 rows of closing locks at most; nets stay iterative); but not without a fixed body and with a light one
    /// between heavy ones (StepReport::exact_joints_refused). Limits, motors, springs and contacts
    /// are swept on top. Costs about one to two sweeps more a substep. `joint_hertz` is then of the others.
    bool exact_joints = false;
    bool warm_start = true;  ///< start from the impulses of the step before
    /// m/s, >= 0. Above 0 an island gets no more sweeps of a substep once none of its constraints would change a
    /// speed by more (StepMeasures::residual_max); `iterations` and `relaxations` are then the most. Same bits
    /// for any threads and instruction set. Where it is never reached it costs 15 to 35 %.
    float tolerance = 0;
    /// ms, 0 to 1e6. Above 0 each step picks its own substeps (soft_step) or iterations (sequential_impulse), so that it
    /// takes about so long on this machine, from what the steps before took; `substeps` or `iterations` are then the most.
    /// StepReport tells what was picked, whether it took longer, and, in `measures`, the residual that was left. Not of `direct`. NOT the same bits
    /// from run to run: what is picked depends on the clock.
    float budget_ms = 0;
    bool measures =
        false;  ///< fill StepReport::measures; costs about two sweeps a step, and reading every joint twice
    BadContacts bad_contacts = BadContacts::refuse;
    Vec3<float> gravity{0, 0, 0};  ///< m/s2; planar bodies ignore z

    /// soft_step: stiffness of contacts, > 0, capped at 0.25 / substep; 0: half of that cap and 30 at least, so that shorter substeps
    /// come to the rigid truth. Against what cannot move it is doubled.
    float contact_hertz = 0;
    float contact_damping_ratio = 10;  ///< >= 0
    /// m/s or rad/s, > 0: the fastest that penetration is resolved, and that a joint beyond its limit comes back. Bounds no
    /// force: what presses on a contact or a limit is held.
    float push_out_speed = 3;
    /// soft_step: stiffness of joints, > 0, capped at 0.25 / substep: by default the stiffest that a substep can follow.
    float joint_hertz = 1e6F;
    float joint_damping_ratio = 2;    ///< >= 0
    float restitution_threshold = 1;  ///< m/s, >= 0: slower impacts do not bounce

    DriftCorrection drift_correction = DriftCorrection::by_method;  ///< not of soft_step
    float baumgarte = 0.2F;  ///< 0 to 1: share of the error removed a step
    int projections = 2;     ///< 0 to 10000: position sweeps a substep with DriftCorrection::projection
    float penetration_slop = 0.0005F;  ///< m, >= 0: penetration that baumgarte and projection leave alone

    /// Throws InvalidInput naming the first field out of its range.
    void validate() const;
    /// The same with what the method picks picked: `iterations` above 0, and no `by_method`.
    [[nodiscard]] SolverSettings resolved() const;
};

}  // namespace motley
