// Steps: their settings, the host's contacts, what a step reports, and who lends it threads.
#ifndef MOTLEY_C_SOLVER_H
#define MOTLEY_C_SOLVER_H

#include "motley/c/joints.h"
#include "motley/c/scene.h"

#ifdef __cplusplus
extern "C" {
#endif
#pragma GCC visibility push(default)

/// How the constraints of a step are solved.
typedef int32_t motley_method;
enum {
    MOTLEY_SOFT_STEP =
        0,  ///< many substeps with soft constraints, each of few sweeps and then a relaxation pass
    MOTLEY_SEQUENTIAL_IMPULSE =
        1,             ///< the textbook loop: warm start, sweep over rigid constraints, integrate
    MOTLEY_DIRECT = 2  ///< all rows of an island at once, in double: for small scenes, and as the reference
};

/// What MOTLEY_SEQUENTIAL_IMPULSE and MOTLEY_DIRECT do about the position error that velocity constraints leave.
typedef int32_t motley_drift_correction;
enum {
    MOTLEY_DRIFT_BY_METHOD = 0,  ///< projection; baumgarte for MOTLEY_DIRECT and with exact_joints
    MOTLEY_DRIFT_NONE = 1,       ///< no correction: the drift stays
    MOTLEY_DRIFT_BAUMGARTE = 2,  ///< adds beta C / h to the velocity constraint
    MOTLEY_DRIFT_PROJECTION = 3  ///< moves positions along M^-1 J^T after their integration
};

/// What a step does about an invalid contact (see motley_contact for the valid ranges).
typedef int32_t motley_bad_contacts;
enum {
    MOTLEY_REFUSE_BAD_CONTACTS = 0,  ///< the whole step is refused
    MOTLEY_SKIP_BAD_CONTACTS =
        1  ///< it is left out and counted; a key that occurs twice still refuses the step
};

/// Settings of a step. The default values suit a crowd at 60 steps a second.
typedef struct motley_solver_settings {
    size_t struct_size;    ///< set by motley_default_solver_settings()
    motley_method method;  ///< default MOTLEY_SOFT_STEP
    int32_t substeps;      ///< 1 to 1024; position and velocity integrations a step; default 4
    /// sweeps a substep, 1 to 10000; 0, which is the default: 1, or 8 for MOTLEY_SEQUENTIAL_IMPULSE
    int32_t iterations;
    int32_t relaxations;  ///< 0 to 10000; MOTLEY_SOFT_STEP: sweeps without bias a substep; default 1
    /// Solves locks between rigid bodies all at once, exactly at any mass ratio, where they connect the bodies as a tree
    /// with few loops. Costs about one to two sweeps more a substep. Default 0.
    motley_bool exact_joints;
    /// Solves the contacts of an island all at once after each sweep, where the island is sparse, as towers, queues and
    /// small heaps are; one substep is then enough. Default 0.
    motley_bool exact_contacts;
    motley_bool warm_start;  ///< start from the accumulated impulses of the last substep; default 1
    /// m/s, 0 to 1e9; 0, which is the default: off. Above 0 the sweeps over an island end within a substep once none of its
    /// constraints would change a speed by more than this; `iterations` and `relaxations` are then upper bounds.
    float tolerance;
    /// ms, 0 to 1e6; 0, which is the default: off. Above 0 each step picks its own number of substeps or iterations so that
    /// it takes about this time. NOT the same bits from run to run: what is picked depends on the clock.
    float budget_ms;
    motley_bool measures;  ///< fill motley_step_report.measures; costs about two sweeps a step; default 0
    motley_bad_contacts bad_contacts;  ///< default MOTLEY_REFUSE_BAD_CONTACTS
    motley_vec3f gravity;              ///< m/s2, world, -1e9 to 1e9; planar bodies ignore z; default 0
    /// Hz; MOTLEY_SOFT_STEP: stiffness of contacts, 0.001 to 1e6, capped at 0.25 / substep. 0, which is the default: half of
    /// that cap, but at least 30.
    float contact_hertz;
    float contact_damping_ratio;  ///< MOTLEY_SOFT_STEP: 0 to 1e6; default 10
    /// m/s or rad/s, 1e-6 to 1e9: the greatest speed at which penetration is removed and a joint beyond its limit comes
    /// back. It bounds no force. Default 3.
    float push_out_speed;
    /// Hz; MOTLEY_SOFT_STEP: of joints, 0.001 to 1e6, capped at 0.25 / substep; default 1e6
    float joint_hertz;
    float joint_damping_ratio;    ///< MOTLEY_SOFT_STEP: 0 to 1e6; default 2
    float restitution_threshold;  ///< m/s, 0 to 1e9: slower impacts do not bounce; default 1
    /// ignored by MOTLEY_SOFT_STEP; default MOTLEY_DRIFT_BY_METHOD
    motley_drift_correction drift_correction;
    /// 0 to 1: share of a position error removed in a substep (baumgarte), or of a penetration in a position
    /// sweep (projection); default 0.2
    float baumgarte;
    int32_t projections;  ///< 0 to 10000: position sweeps a substep with MOTLEY_DRIFT_PROJECTION; default 2
    float penetration_slop;  ///< m, 0 to 1e9: penetration that baumgarte and projection leave; default 0.0005
    /// m/s, 0 to 1e9; 0, which is the default: nobody sleeps. Above 0 an island falls asleep once all of its bodies have been
    /// slower than this for `sleep_after`, and costs nearly nothing until something wakes it. 0.01 suits a crowd. Refused
    /// with MOTLEY_DIRECT.
    float sleep_speed;
    /// s, 0 to 1e9; to a step, and up to 7 steps more where islands move beside; default 0.5
    float sleep_after;
    /// With exact_joints: solves limits, motors and springs of drives, and swing limits, with the locks while they act, exactly
    /// at any load. Default 0. Hosts of the first release do not have this field.
    motley_bool exact_limits;
    /// MOTLEY_SOFT_STEP: as exact_joints, but only in figures in which locks hang a body on one that is more than
    /// this many times lighter, or an armature is so much heavier than what it turns; and in these with exact_limits; 1 or more, or infinite: never. Default 10. Hosts of the first release do not have this field.
    float exact_above_ratio;
} motley_solver_settings;
MOTLEY_DECLARE_DEFAULT(solver_settings)

/// An instruction set. Every one of them computes the same bits.
typedef int32_t motley_isa;
enum {
    /// What the environment variable MOTLEY_ISA names, else the widest this machine has.
    MOTLEY_ISA_DEFAULT = -1,
    MOTLEY_ISA_SCALAR = 0,
    MOTLEY_ISA_SSE2 = 1,
    MOTLEY_ISA_AVX2 = 2,
    MOTLEY_ISA_AVX512 = 3,
    MOTLEY_ISA_NEON = 4
};

/// What an executor runs.
typedef struct motley_job motley_job;
/// Runs the share of a worker, 0 to workers - 1, of a job that motley_executor.run got, which may be called on any thread
/// until that run returns. Refuses a worker out of this range, and one that has been run before.
motley_status motley_job_run(motley_job* job, int32_t worker);

/// Lends threads of the host to steps.
typedef struct motley_executor {
    size_t struct_size;   ///< set by motley_default_executor()
    void* user;           ///< the host's own, handed to `run`; default null
    int32_t concurrency;  ///< threads that may run a job at once, including the caller; 1 to 1024; default 1
    /// Calls motley_job_run(job, 0) on the calling thread, and may call it for the workers 1 to workers - 1 on other threads
    /// at any time meanwhile, or not at all: the step finishes with any number of them. Returns 0 when every call that began
    /// has returned and no further one will begin. Anything else says that it failed: before it ran worker 0, the step is
    /// refused; afterwards the step is done, and motley_step_report.error tells. A lent thread computes or spins until the
    /// step is over, never sleeps, and calls nothing of the host. Default null, which is refused.
    int32_t (*run)(void* user, int32_t workers, motley_job* job);
} motley_executor;
MOTLEY_DECLARE_DEFAULT(executor)

/// What a solver runs on. None of it changes a bit of the result.
typedef struct motley_solver_options {
    size_t struct_size;  ///< set by motley_default_solver_options()
    /// >= 1, which is the default and starts no thread at all. Ignored with `executor`, and taken for 1 where the library is
    /// built without threads of its own: motley_solver_threads() tells.
    int32_t threads;
    motley_isa isa;  ///< default MOTLEY_ISA_DEFAULT
    /// Steps of fewer contacts (a joint counts as four, two bodies as one) run on the calling thread alone. Default 8192.
    size_t alone_below;
    /// The host's own threads, or null, which is the default. It is copied; what `user` points to must outlive the solver.
    const motley_executor* executor;
} motley_solver_options;
MOTLEY_DECLARE_DEFAULT(solver_options)

/// One contact point of the list that a step is given: C = n . (p_b - p_a) >= 0, lambda_n >= 0, |lambda_t| <= mu lambda_n,
/// with the normal n, the surface points p, the normal impulse lambda_n, the friction impulse lambda_t and the friction
/// coefficient mu. Both arms must lead to the same point of the world. The default is zero everywhere: memset() makes it.
/// This struct never changes.
typedef struct motley_contact {
    motley_body_id body_a, body_b;
    uint64_t key;         ///< unique in the list; the same key and bodies in the next step: a warm start
    motley_vec3f normal;  ///< unit (1 +- 1e-3), from a to b, world; z = 0 where the pair stays in the plane
    float separation;     ///< m along the normal, -1e9 to 1e9, negative when overlapping
    motley_vec3f arm_a;   ///< m, world, -1e9 to 1e9: from the centre of mass of a to the contact point
    float friction;       ///< coefficient mu, 0 to 1e9; 0: no friction rows at all
    motley_vec3f arm_b;   ///< m, world, likewise from the centre of mass of b
    float restitution;    ///< coefficient, 0 to 1
} motley_contact;

/// The impulse of a contact in a step or in a substep. This struct never changes.
typedef struct motley_contact_impulse {
    float normal;           ///< N s, >= 0, along the normal on b
    motley_vec3f friction;  ///< N s, world, on b
} motley_contact_impulse;

/// The load that its contacts put on a body, on average over the last step. This struct never changes.
typedef struct motley_body_load {
    float normal_force;          ///< N, sum of the normal forces of its contacts
    float largest_normal_force;  ///< N, of a single contact
    motley_vec3f net_force;      ///< N, world: vector sum over its contacts, friction included
    float pressure;              ///< N/m: normal_force over the body's circumference; 0 where none was given
} motley_body_load;

/// How well a step solved its constraints, contacts of discs left out. This struct never changes.
typedef struct motley_step_measures {
    /// sqrt(J), of J v + bias after the last sweep: sqrt(sum of r^T K^-1 r), K = J M^-1 J^T
    double residual_norm;
    double residual_rms;     ///< m/s, over the constraints: sqrt(r^T K^-1 r (1/m_a + 1/m_b))
    double residual_max;     ///< m/s, the largest of them
    double penetration_rms;  ///< m, over the contacts that overlap, at the beginning of the step
    double penetration_max;  ///< m
    /// Of the step: their differences are the changes of energy and momentum.
    motley_scene_errors before, after;
} motley_step_measures;

/// What a step did. Counting is free; times cost two clock reads a stage.
typedef struct motley_step_report {
    size_t struct_size;   ///< set by motley_default_step_report()
    motley_bool refused;  ///< the step changed nothing: `error` says why
    char error[512];  ///< why it was refused; if it is done, how the executor failed afterwards, if it did
    char skipped_error[512];  ///< of the first contact that MOTLEY_SKIP_BAD_CONTACTS left out
    int64_t contacts;         ///< that are solved: those of sleepers rest
    int64_t disc_contacts;  ///< of these, those of discs near each other or near walls that the library found
    int64_t shape_contacts;      ///< of these, those of capsules that the library found
    int64_t contacts_skipped;    ///< invalid contacts that MOTLEY_SKIP_BAD_CONTACTS left out
    int64_t joints;              ///< that are solved
    int64_t joints_in_lockstep;  ///< joints of copies of a figure that touched no other moving body
    /// with exact_joints: locks that are swept nevertheless, beside light bodies
    int64_t exact_joints_refused;
    motley_body_id first_light_body;  ///< such a light body, if there is one
    int64_t exact_contact_islands;    ///< with exact_contacts: islands that were solved at once
    int64_t exact_contacts_refused;   ///< with exact_contacts: islands too dense for it, which were swept
    double exact_contacts_residual;   ///< m/s: the most that one more sweep would have changed a speed by
    int32_t colours;                  ///< colours in use, the overflow not counted
    int64_t overflow;                 ///< constraints that got no colour and were solved one after another
    int64_t blocks;                   ///< blocks of 16 lanes
    double lane_occupancy;            ///< constraints / (16 blocks); 0 without constraints
    double bytes_per_constraint;      ///< streamed by one sweep of solve: rows, impulses and indices
    int64_t sweeps;                   ///< sweeps over all constraints: warm starts, solves and relaxations
    int32_t substeps;                 ///< substeps made
    int32_t iterations;               ///< most sweeps of solve in a substep
    motley_bool over_budget;          ///< took longer than budget_ms, if that is above 0
    int64_t islands;                  ///< counted when `tolerance` is above 0
    int64_t islands_above_tolerance;  ///< those still above it after the last allowed sweep of solve
    /// with motley_solver_settings.measures; with a budget only its residuals
    motley_step_measures measures;
    /// MOTLEY_DIRECT: largest residual of its equations and inequalities, m/s or rad/s
    double direct_violation;
    /// MOTLEY_DIRECT: islands with a larger one than 1e-9 m/s or rad/s, summed over the substeps.
    int64_t direct_unsolved;
    int64_t bodies_asleep;           ///< when the step has ended
    int64_t bodies_contained;        ///< bodies frozen in this step because their state was not finite
    motley_body_id first_contained;  ///< one of them
    double seconds[16];              ///< of each stage, in the order of motley_stage_name(); the rest is 0
} motley_step_report;
MOTLEY_DECLARE_DEFAULT(step_report)

/// The name of a stage of a step, "intake", "colour" and so on; null for a number that is not below the number of stages.
const char* motley_stage_name(int32_t stage);

/// Makes a solver, which the host destroys. Null for `settings` or `options`: the defaults. Refuses values out of range,
/// and an instruction set that is not available here.
motley_status motley_solver_create(const motley_solver_settings* settings,
                                   const motley_solver_options* options, motley_solver** solver);
/// Null is allowed. No other call may use the solver at the same time or later.
void motley_solver_destroy(motley_solver* solver);

/// Advances the scene by `dt` seconds (0 to 1; 0 changes nothing), with the contacts of this step, which are read during
/// the call only. A step is fastest if the list is in about the order of the step before. `contacts` may be null where
/// `contact_count` is 0. Writes what it did to `report`, unless that is null; also when the step is refused, but not when a
/// pointer, a count or a size is. MOTLEY_REFUSED for bad input, a lack of memory and an executor that fails: then the scene
/// is untouched. Allocates nothing once the scene has stopped growing.
motley_status motley_solver_step(motley_solver* solver, motley_scene* scene, float dt, size_t contact_count,
                                 const motley_contact* contacts, motley_step_report* report);

/// Writes the settings to `settings`, whose struct_size is set.
motley_status motley_solver_read_settings(const motley_solver* solver, motley_solver_settings* settings);
/// Refuses settings out of range; then the old ones stay.
motley_status motley_solver_set_settings(motley_solver* solver, const motley_solver_settings* settings);
motley_status motley_solver_isa(const motley_solver* solver, motley_isa* isa);
motley_status motley_solver_threads(const motley_solver* solver, int32_t* threads);

/// Writes where the impulses of the contacts of the last step are, summed over its substeps, in the order of the host's
/// list, and their number. They are valid until the next step, or until the scene is destroyed.
motley_status motley_scene_contact_impulses(const motley_scene* scene,
                                            const motley_contact_impulse** impulses, size_t* count);
/// Their impulses in the last substep alone.
motley_status motley_scene_last_substep_impulses(const motley_scene* scene,
                                                 const motley_contact_impulse** impulses, size_t* count);
/// A report on contact `index` of the last step in the form of a joint's: the mean force on b at the contact point, the
/// depth that the host gave as the error, and active if it pushed in the last substep. `contacts` is the list of that step.
/// Refuses an index beyond the list, and a list that has another contact there.
motley_status motley_scene_contact_report(const motley_scene* scene, size_t contact_count,
                                          const motley_contact* contacts, size_t index,
                                          motley_joint_report* report);
/// The loads that the contacts of the last step put on bodies: load i is of bodies[i]. `contacts` is the list of that step;
/// another list is refused. Contacts of discs and of capsules count as well. `circumferences` (m, above 0, to 1e9), unless
/// null, turn forces into pressures. Strides as in the bulk calls of bodies.h. Allocates.
motley_status motley_scene_read_loads(const motley_scene* scene, size_t count, const motley_body_id* bodies,
                                      size_t contact_count, const motley_contact* contacts,
                                      motley_body_load* loads, size_t load_stride,
                                      const float* circumferences, size_t circumference_stride);

/// Writes the whole input of a step to a file, which `motley replay FILE` solves again under any settings: a bug report.
motley_status motley_save_problem(const motley_scene* scene, const motley_solver_settings* settings, float dt,
                                  size_t contact_count, const motley_contact* contacts, const char* file);

#pragma GCC visibility pop
#ifdef __cplusplus
}
#endif
#endif
