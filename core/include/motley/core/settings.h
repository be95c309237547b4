// The settings of a step. Each trades speed for accuracy, or stiffness for smooth motion; bench/README.md gives the
// costs.
#pragma once

#include <limits>

#include "motley/core/vector.h"

#pragma GCC visibility push(default)
namespace motley {

/// How the constraints of a step are solved.
enum class Method {
    /// Many substeps with soft constraints, each of few sweeps and then a relaxation pass, which sweeps without bias.
    soft_step,
    /// The textbook loop: integrate velocities, warm start, sweep over rigid constraints, integrate positions.
    sequential_impulse,
    /// Solves all rows of an island at once, in double: equalities exactly at any mass ratio; limits, friction and
    /// contacts to 1e-9 m/s. StepReport::direct_unsolved counts the islands that were left with more (friction between
    /// masses 1 : 1000, or many contacts that hold what joints pull apart). One sparse system for each substep and
    /// island, on one thread: for small scenes, and as the reference for the other methods. Constraints are rigid, with
    /// `drift_correction`; `iterations`, `relaxations`, `warm_start` and the softness of contacts and joints are
    /// ignored (springs keep theirs). Allocates. For a thousand rows a step takes milliseconds while they rest or
    /// nearly so, and 0.1 s to 1 s while most of them begin or stop to slide. Refused by a library built with
    /// MOTLEY_DIRECT=OFF.
    direct,
};

/// What `sequential_impulse` and `direct` do about the position error that velocity constraints leave.
enum class DriftCorrection {
    /// projection for `sequential_impulse`, but baumgarte for `direct` and with `exact_joints`
    by_method,
    none,  ///< no correction: the drift stays
    /// Adds beta C / h to the velocity constraint J v = 0: C is the position error, h the substep, beta
    /// SolverSettings::baumgarte. `direct` also corrects positions at the end of each substep, so that the error of a
    /// lock is what this velocity implies. Sweeps that have not converged leave some of the correction in the
    /// velocities: long or loaded chains gain energy.
    baumgarte,
    projection,  ///< moves positions along M^-1 J^T after their integration
};

/// What a step does about an invalid contact (see Contact for the valid ranges).
enum class BadContacts {
    refuse,  ///< the whole step is refused
    skip,  ///< the contact is left out and counted in the report. A key that occurs twice still refuses the step
};

/// Settings of a step. The default values suit a crowd at 60 steps a second.
struct SolverSettings {
    Method method = Method::soft_step;
    int substeps = 4;     ///< 1 to 1024; position and velocity integrations a step
    int iterations = 0;   ///< sweeps a substep, 1 to 10000; 0: 1 for soft_step, 8 for sequential_impulse
    int relaxations = 1;  ///< 0 to 10000; soft_step: sweeps without bias a substep
    /// soft_step, and sequential_impulse with baumgarte: locks (ball-sockets, fixed joints, hinges, sliders and their
    /// parts) between rigid bodies are solved all at once, exactly at any mass ratio, where they connect the bodies as
    /// a tree with few loops (at most 24 rows of locks that close loops; nets stay iterative). Figures without a fixed
    /// body that have a light body between heavy ones are excepted (StepReport::exact_joints_refused). Limits, motors,
    /// springs and contacts are still swept. Costs about one to two sweeps more a substep. `joint_hertz` then applies
    /// to the other joints only.
    bool exact_joints = false;
    /// soft_step: as `exact_joints`, but only in figures in which locks hang a heavy body on a light one: a
    /// body has, behind one lock, a body more than this many times as heavy, and behind another lock also such a body or a
    /// static or kinematic one; or in which an armature is more than this many times as heavy as the two bodies that it turns.
    /// Sweeps pass so little of such a load on that its joints part, and rotors throw bodies. Limits, motors and springs of
    /// such figures are solved as with `exact_limits`. 1 or more; infinite: never. Ignored with `exact_joints`.
    float exact_above_ratio = 10;
    /// With `exact_joints`: limits, motors and springs of drives, and swing limits, are solved with the locks while they act,
    /// exactly at any load, so that links of 1 kg hold and lift tons by them; sweeps alone let such limits and springs give way
    /// without bound. Springs of other joints, a spring beside a motor or a limit that acts, and what
    /// is beyond six rows between two bodies are still swept, and so is all of this in nets. A row may begin to act, and a limit
    /// let go, a substep late; no motor or spring pushes harder than it may. Ragdolls whose limits act take 1.6 times as long
    /// as with exact_joints alone at one substep, 1.8 times at four.
    bool exact_limits = false;
    /// soft_step and sequential_impulse: contacts of an island, which are bodies that contacts connect, are solved all at
    /// once after each sweep, rigidly and in double, so that towers, queues and presses are right in every step: 50 boxes
    /// stand, and of 300 people who lean each bears what is behind. Islands must be sparse, as chains, stacks and small
    /// heaps are; large packs are left to the sweeps (StepReport::exact_contacts_refused). Joints, and with them
    /// manifolds, are swept beside. One substep is then enough where the default takes four. Costs 1.6 to 5 times a step
    /// of the default for stacks and rows, more where contacts change in every step: see bench/README.md.
    bool exact_contacts = false;
    bool warm_start = true;  ///< start from the accumulated impulses of the last substep
    /// m/s, 0 to 1e9; 0: off. Above 0 the sweeps over an island end within a substep once none of its constraints would
    /// change a speed by more than this (the measure of StepMeasures::residual_max); `iterations` and `relaxations` are
    /// then upper bounds. Same bits for any number of threads and instruction set. Costs 15 to 35 % where it is never
    /// reached.
    float tolerance = 0;
    /// ms, 0 to 1e6; 0: off. Above 0 each step picks its own number of substeps (soft_step) or iterations
    /// (sequential_impulse) so that it takes about this time, judged by the times of earlier steps; `substeps` or
    /// `iterations` is then an upper bound. StepReport says what was picked, whether the step took longer, and, in
    /// `measures`, the residual that was left. Ignored by `direct`. NOT the same bits from run to run: what is picked
    /// depends on the clock.
    float budget_ms = 0;
    bool measures =
        false;  ///< fill StepReport::measures; costs about two sweeps a step, and reading every joint twice
    BadContacts bad_contacts = BadContacts::refuse;
    Vec3<float> gravity{0, 0, 0};  ///< m/s2, world, -1e9 to 1e9; planar bodies ignore z

    /// Hz; soft_step: stiffness of contacts, 0.001 to 1e6, capped at 0.25 / substep. 0: half of that cap, but at least
    /// 30, so that contacts become rigid as substeps become shorter. Doubled for contacts with static and kinematic
    /// bodies.
    float contact_hertz = 0;
    float contact_damping_ratio = 10;  ///< soft_step: 0 to 1e6
    /// m/s or rad/s, 1e-6 to 1e9: the greatest speed at which penetration is removed and a joint beyond its limit comes
    /// back. It bounds no force: contacts and limits hold any load.
    float push_out_speed = 3;
    /// Hz; soft_step: stiffness of joints, 0.001 to 1e6, capped at 0.25 / substep. The default is that cap, which is
    /// the stiffest spring that a substep can follow.
    float joint_hertz = 1e6F;
    float joint_damping_ratio = 2;    ///< soft_step: 0 to 1e6
    float restitution_threshold = 1;  ///< m/s, 0 to 1e9: slower impacts do not bounce

    DriftCorrection drift_correction = DriftCorrection::by_method;  ///< ignored by soft_step
    float baumgarte = 0.2F;  ///< 0 to 1: share of a position error removed in a substep (baumgarte), or of a
                             ///< penetration in a position sweep (projection)
    int projections = 2;     ///< 0 to 10000: position sweeps a substep with DriftCorrection::projection
    float penetration_slop = 0.0005F;  ///< m, 0 to 1e9: penetration that baumgarte and projection leave

    /// m/s, 0 to 1e9; 0: nobody sleeps. Above 0 an island falls asleep once all of its bodies have been slower than this
    /// for `sleep_after`: it stays where it is and costs nearly nothing, until something wakes it (Scene::is_asleep). The
    /// speed of a body is the root mean square over its mass, sqrt(v^2 + w . I w / m) with velocity v, angular velocity
    /// w, inertia I and mass m. 0.01 suits a crowd. Refused with Method::direct.
    float sleep_speed = 0;
    float sleep_after = 0.5F;  ///< s, 0 to 1e9; to a step, and up to 7 steps more where islands move beside

    /// Throws InvalidInput naming the first field out of its range.
    void validate() const;
    /// The same settings with the method's choices filled in: `iterations` above 0, no `by_method`, and no `exact_contacts`
    /// with `direct`, which solves contacts exactly anyway.
    [[nodiscard]] SolverSettings resolved() const;
};

}  // namespace motley
#pragma GCC visibility pop
