/* A host in C99: defaults as the headers give them, a pendulum against its closed form, a crowd that leaves by a door, bad
   input, saved scenes, and an executor of POSIX threads. */
#define _POSIX_C_SOURCE 200809L
#include <motley/c/motley.h>

#include <float.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const float time_step = 1.0F / 60;

static void fail(const char* what, int line)
{
    fprintf(stderr, "host.c:%d: %s; the last error: %s\n", line, what, motley_last_error());
    exit(1);
}
#define DEMAND(condition)                             \
    do {                                              \
        if (!(condition)) fail(#condition, __LINE__); \
    } while (0)
#define DO(call) DEMAND((call) == MOTLEY_DONE)
/** Demands that a call is refused with exactly these words. */
#define REFUSED(call, words)                                                                     \
    do {                                                                                         \
        DEMAND((call) == MOTLEY_REFUSED);                                                        \
        if (strcmp(motley_last_error(), words) != 0) fail("other words than: " words, __LINE__); \
    } while (0)

/* Numbers as the comments of the headers give them. */
static void check_defaults(void)
{
    const motley_body_definition body = motley_default_body_definition();
    const motley_disc_definition disc = motley_default_disc_definition();
    const motley_wall_definition wall = motley_default_wall_definition();
    const motley_capsule_definition capsule = motley_default_capsule_definition();
    const motley_half_space_definition floor = motley_default_half_space_definition();
    const motley_distance_definition rod = motley_default_distance_definition();
    const motley_hinge_definition hinge = motley_default_hinge_definition();
    const motley_twist_drive_definition drive = motley_default_twist_drive_definition();
    const motley_swing_limit_definition swing = motley_default_swing_limit_definition();
    const motley_point_servo_definition servo = motley_default_point_servo_definition();
    const motley_gear_definition gear = motley_default_gear_definition();
    const motley_rack_and_pinion_definition rack = motley_default_rack_and_pinion_definition();
    const motley_pulley_definition pulley = motley_default_pulley_definition();
    const motley_manifold_definition manifold = motley_default_manifold_definition();
    const motley_screw_definition screw = motley_default_screw_definition();
    const motley_six_dof_definition six = motley_default_six_dof_definition();
    const motley_wheel_definition wheel = motley_default_wheel_definition();
    const motley_solver_settings settings = motley_default_solver_settings();
    const motley_solver_options options = motley_default_solver_options();
    const motley_executor executor = motley_default_executor();
    DEMAND(body.struct_size == sizeof body && body.model == MOTLEY_RIGID &&
           body.motion == MOTLEY_DYNAMIC_BODY);
    DEMAND(body.mass == 1 && body.orientation.w == 1 && body.orientation.x == 0 && body.inertia.zz == 1);
    DEMAND(body.inertia.xy == 0 && body.yaw == 0 && body.position.x == 0 && body.linear_velocity.z == 0);
    DEMAND(disc.radius == 0.2F && disc.friction == 0 && disc.category == 1 && disc.mask == UINT32_MAX);
    DEMAND(wall.points == NULL && wall.point_count == 0 && !wall.closed && !wall.one_way &&
           wall.category == 1);
    DEMAND(isinf(wall.max_force) && wall.surface_speed == 0 && wall.mask == UINT32_MAX &&
           wall.body.generation == 0);
    DEMAND(capsule.radius == 0.1F && capsule.restitution == 0 && capsule.group == 0 && capsule.category == 1);
    DEMAND(floor.normal.z == 1 && floor.normal.x == 0 && floor.friction == 0 && floor.mask == UINT32_MAX);
    DEMAND(rod.min_length == 1 && rod.max_length == 1 && rod.rest_length == 1 && isinf(rod.spring_max_force));
    DEMAND(hinge.frame_a.rotation.w == 1 && hinge.stiffness.hertz == 0 && hinge.stiffness.damping_ratio == 2);
    DEMAND(drive.lower < -FLT_MAX && drive.upper > FLT_MAX && drive.motor_max_force == 0);
    DEMAND(drive.angle == MOTLEY_EULER_X && drive.armature == 0 && isinf(drive.spring_max_force));
    DEMAND(swing.max_angle == 1 && servo.hertz == 5 && servo.damping_ratio == 1 && isinf(servo.max_force));
    DEMAND(gear.ratio == -1 && gear.axis_a.x == 1 && rack.travel == 1 && pulley.ratio == 1);
    DEMAND(pulley.min_length == 0 && pulley.max_length == 1 && manifold.point_count == 1 &&
           manifold.normal.x == 1);
    DEMAND(screw.pitch == 0.01F && screw.axis_a.x == 1);
    DEMAND(six.max_swing == 3.14159265F && six.rotations == MOTLEY_ABOUT_AXES && six.position[2].upper == 0);
    DEMAND(isinf(six.rotation[1].spring_max_force));
    DEMAND(wheel.suspension.y == 1 && wheel.axle.z == 1 && wheel.wheel_axle.z == 1 && isinf(wheel.upper));
    DEMAND(wheel.spring_damping_ratio == 0.7F && wheel.motor_max_torque == 0);
    DEMAND(settings.method == MOTLEY_SOFT_STEP && settings.substeps == 4 && settings.iterations == 0);
    DEMAND(settings.relaxations == 1 && !settings.exact_joints && !settings.exact_limits &&
           !settings.exact_contacts && settings.warm_start && !settings.measures);
    DEMAND(settings.contact_damping_ratio == 10 && settings.push_out_speed == 3 &&
           settings.joint_hertz == 1e6F);
    DEMAND(settings.joint_damping_ratio == 2 && settings.restitution_threshold == 1 &&
           settings.baumgarte == 0.2F);
    DEMAND(settings.projections == 2 && settings.penetration_slop == 0.0005F && settings.sleep_after == 0.5F);
    DEMAND(settings.gravity.y == 0 && settings.tolerance == 0 && settings.budget_ms == 0 &&
           settings.sleep_speed == 0);
    DEMAND(settings.exact_above_ratio == 10);
    DEMAND(options.threads == 1 && options.isa == MOTLEY_ISA_DEFAULT && options.alone_below == 8192);
    DEMAND(options.executor == NULL && executor.concurrency == 1 && executor.run == NULL &&
           executor.user == NULL);
}

static motley_solver* make_solver(const motley_solver_settings* settings)
{
    motley_solver* solver = NULL;
    DO(motley_solver_create(settings, NULL, &solver));
    return solver;
}

/* A point on a rod of 1 m that swings by 0.05 rad is back after 2 pi sqrt(l / g) (1 + a^2 / 16), to 0.5 %. */
static void check_pendulum(void)
{
    const double pi = 3.14159265358979, gravity = 9.81, angle = 0.05;
    const double period = 2 * pi * sqrt(1 / gravity) * (1 + angle * angle / 16);
    motley_scene* scene = NULL;
    motley_solver_settings settings = motley_default_solver_settings();
    motley_body_definition body = motley_default_body_definition();
    motley_distance_definition rod = motley_default_distance_definition();
    motley_body_id bob;
    motley_constraint_id joint;
    motley_joint_report report;
    motley_solver* solver;
    double before = 0, crossed = 0, seconds = 0;
    int crossings = 0, step;
    settings.gravity.y = (float)-gravity;
    solver = make_solver(&settings);
    DO(motley_scene_create(&scene));
    body.model = MOTLEY_PARTICLE;
    body.position.x = sin(angle);
    body.position.y = -cos(angle);
    DO(motley_scene_add_body(scene, &body, &bob));
    DO(motley_scene_ground(scene, &rod.body_a));
    rod.body_b = bob;
    DO(motley_scene_add_distance(scene, &rod, &joint));
    for (step = 1; step <= 60 * 25; ++step) {
        motley_body_state state;
        DO(motley_solver_step(solver, scene, time_step, 0, NULL, NULL));
        DO(motley_scene_body_state(scene, bob, &state));
        if (step > 1 && before < 0 && state.position.x >= 0) { /* to the right through the lowest point */
            seconds = time_step * (step - state.position.x / (state.position.x - before));
            if (crossings++ == 0) crossed = seconds;
        }
        before = state.position.x;
    }
    DEMAND(crossings > 10);
    DEMAND(fabs((seconds - crossed) / (crossings - 1) / period - 1) < 0.005);
    /* The rod carries the weight of 1 kg, to a percent, for the swing is small. */
    DO(motley_scene_joint_report(scene, joint, &report));
    DEMAND(report.state == MOTLEY_JOINT_ACTIVE && fabs(report.force.y - gravity) < 0.01 * gravity);
    motley_solver_destroy(solver);
    motley_scene_destroy(scene);
}

/* What a host of a crowd keeps of a person. */
typedef struct agent {
    int number;
    motley_vec3d position;
    motley_vec3f force, velocity;
    motley_disc_definition disc;
    motley_body_definition body;
} agent;
enum { people = 100 };
static const double room = 6; /* m, its side */

static motley_scene* make_room(agent* agents, motley_body_id* bodies)
{
    const motley_vec2d outline[] = {{6, 3.5}, {6, 6}, {0, 6}, {0, 0}, {6, 0}, {6, 2.5}}; /* a door of 1 m */
    const motley_vec2d square[] = {{4.4, 3.4}, {4.6, 3.4}, {4.6, 3.6}, {4.4, 3.6}};
    const motley_vec2d plan[] = {{-10, -10}, {20, -10}, {20, 20}, {-10, 20}};
    motley_ring rings[2];
    motley_wall_id walls[2];
    motley_wall_definition wall = motley_default_wall_definition();
    motley_scene* scene = NULL;
    motley_bool is;
    int i;
    DO(motley_scene_create(&scene));
    for (i = 0; i < people; ++i) {
        agents[i].number = i;
        agents[i].body = motley_default_body_definition();
        agents[i].body.model = MOTLEY_PLANAR;
        agents[i].body.mass = 80;
        agents[i].body.inertia.zz = 0.5F * 80 * 0.2F * 0.2F;
        agents[i].body.position.x = 0.3 + 0.41 * (i % 10);
        agents[i].body.position.y = 0.8 + 0.45 * (i / 10);
        agents[i].disc = motley_default_disc_definition();
    }
    DO(motley_scene_add_bodies(scene, people, &agents[0].body, sizeof *agents, bodies));
    DO(motley_scene_set_discs(scene, people, bodies, &agents[0].disc, sizeof *agents));
    wall.points = outline;
    wall.point_count = 6;
    DO(motley_scene_add_wall(scene, &wall, NULL));
    rings[0].points = plan;
    rings[0].point_count = 4;
    rings[1].points = square; /* a pillar */
    rings[1].point_count = 4;
    DO(motley_scene_add_polygon(scene, 2, rings, NULL, walls));
    DO(motley_scene_is_wall_alive(scene, walls[1], &is));
    DEMAND(is);
    DO(motley_scene_has_disc(scene, bodies[7], &is));
    DEMAND(is);
    return scene;
}

/* Everybody walks towards the door, and then on. */
static void steer(motley_scene* scene, agent* agents, const motley_body_id* bodies)
{
    int i;
    DO(motley_scene_read_positions(scene, people, bodies, &agents[0].position, sizeof *agents));
    DO(motley_scene_read_velocities(scene, people, bodies, &agents[0].velocity, sizeof *agents, NULL, 0));
    for (i = 0; i < people; ++i) {
        agent* a = &agents[i];
        const double x = (a->position.x > room ? 30 : room + 0.3) - a->position.x, y = 3 - a->position.y;
        const double distance = sqrt(x * x + y * y);
        a->force.x = (float)(80 / 0.5 * (1.3 * x / distance - a->velocity.x));
        a->force.y = (float)(80 / 0.5 * (1.3 * y / distance - a->velocity.y));
        a->force.z = 0;
    }
    DO(motley_scene_set_forces(scene, people, bodies, &agents[0].force, sizeof *agents, NULL, 0));
}

static void check_crowd(void)
{
    static agent agents[people];
    motley_body_id bodies[people], listed[people];
    motley_scene* scene = make_room(agents, bodies);
    motley_solver* solver = make_solver(NULL);
    motley_step_report report = motley_default_step_report();
    static motley_disc_contact contacts[2000];
    static motley_body_load loads[people];
    size_t count, i, j;
    int step;
    for (step = 0; step < 60 * 4; ++step) {
        steer(scene, agents, bodies);
        DO(motley_solver_step(solver, scene, time_step, 0, NULL, &report));
        DEMAND(!report.refused && report.error[0] == 0 && report.substeps == 4);
    }
    DEMAND(report.disc_contacts > people && report.seconds[0] >= 0);
    DEMAND(strcmp(motley_stage_name(0), "intake") == 0 && motley_stage_name(16) == NULL);
    /* The sum of the normal forces that contacts list is the load that bodies report, each contact at its discs. */
    DO(motley_scene_disc_contacts(scene, 2000, contacts, &count));
    DEMAND(count > 0 && count <= 2000);
    DO(motley_scene_read_loads(scene, people, bodies, 0, NULL, loads, sizeof *loads, NULL, 0));
    for (i = 0; i < people; ++i) {
        double sum = 0;
        for (j = 0; j < count; ++j) {
            const int is_b = memcmp(&contacts[j].b, &bodies[i], sizeof bodies[i]) == 0;
            const int is_a = memcmp(&contacts[j].a, &bodies[i], sizeof bodies[i]) == 0;
            if (is_a || is_b) sum += contacts[j].normal_force;
        }
        DEMAND(fabs(sum - loads[i].normal_force) <= 1e-4 * (1 + sum));
    }
    for (; step < 60 * 60; ++step) {
        steer(scene, agents, bodies);
        DO(motley_solver_step(solver, scene, time_step, 0, NULL, NULL));
    }
    DO(motley_scene_read_positions(scene, people, bodies, &agents[0].position, sizeof *agents));
    for (i = 0; i < people; ++i) {
        const motley_vec3d* at = &agents[i].position;
        DEMAND(agents[i].number == (int)i);
        DEMAND(at->x > room && at->x < 20 && at->y > -10 &&
               at->y < 20); /* everybody is out, and nobody through a wall */
    }
    DO(motley_scene_read_bodies(scene, people, listed, &count));
    DEMAND(count == people && memcmp(listed, bodies, sizeof bodies) == 0);
    motley_solver_destroy(solver);
    motley_scene_destroy(scene);
}

static void check_bad_input(void)
{
    motley_scene* scene = NULL;
    motley_body_definition body = motley_default_body_definition();
    motley_body_id id, null = {0, 0};
    motley_body_state state;
    motley_bool alive;
    uint64_t before, after;
    DO(motley_scene_create(&scene));
    DO(motley_scene_add_body(scene, &body, &id));
    DO(motley_scene_state_hash(scene, &before));
    body.mass = -1;
    REFUSED(motley_scene_add_body(scene, &body, &id),
            "motley_scene_add_body: BodyDefinition.mass is -1; expected 1e-10 to 1e10 (kg)");
    body.mass = 1;
    body.model = 7;
    REFUSED(motley_scene_add_body(scene, &body, &id),
            "motley_scene_add_body: motley_body_definition.model is 7; expected 0 to 2");
    REFUSED(motley_scene_add_body(NULL, &body, &id),
            "motley_scene_add_body: scene is null; expected a pointer that is not null");
    DEMAND(motley_scene_body_state(scene, null, &state) == MOTLEY_REFUSED);
    DEMAND(strstr(motley_last_error(), "motley_scene_body_state: ") == motley_last_error());
    DO(motley_scene_state_hash(scene, &after));
    DEMAND(before == after);
    DO(motley_scene_remove_body(scene, id));
    DO(motley_scene_is_body_alive(scene, id, &alive));
    DEMAND(!alive && motley_scene_remove_body(scene, id) == MOTLEY_REFUSED);
    DEMAND(motley_scene_load_file("/no/such/file", &scene) == MOTLEY_FILE_ERROR);
    DEMAND(strstr(motley_last_error(), "/no/such/file") != NULL);
    motley_scene_destroy(scene);
}

/* Threads that take a job each, and the calling thread as worker 0. */
typedef struct pool {
    int runs;
} pool;
typedef struct share {
    motley_job* job;
    int32_t worker;
} share;
static void* run_share(void* of)
{
    const share* mine = of;
    DO(motley_job_run(mine->job, mine->worker));
    return NULL;
}
static int32_t run_on_threads(void* user, int32_t workers, motley_job* job)
{
    pthread_t threads[8];
    share shares[8];
    int32_t worker;
    ++((pool*)user)->runs;
    for (worker = 1; worker < workers; ++worker) {
        shares[worker].job = job;
        shares[worker].worker = worker;
        DEMAND(pthread_create(&threads[worker], NULL, run_share, &shares[worker]) == 0);
    }
    DO(motley_job_run(job, 0));
    DEMAND(motley_job_run(job, 0) == MOTLEY_REFUSED && motley_job_run(job, workers) == MOTLEY_REFUSED);
    for (worker = 1; worker < workers; ++worker) pthread_join(threads[worker], NULL);
    return 0;
}
static int32_t refuse_to_run(void* user, int32_t workers, motley_job* job)
{
    (void)user, (void)workers, (void)job;
    return 12;
}

/* The same steps on one thread, on threads of the host, and on from saved bytes and a file have the same bits. */
static void check_copies(const char* file)
{
    static agent agents[people];
    motley_body_id bodies[people];
    motley_scene *scene = make_room(agents, bodies), *copy = NULL, *loaded = NULL, *from_file = NULL;
    motley_solver *alone = make_solver(NULL), *lent = NULL, *failing = NULL;
    motley_solver_options options = motley_default_solver_options();
    motley_executor executor = motley_default_executor();
    pool of = {0};
    void* bytes = NULL;
    size_t size = 0;
    uint64_t hashes[4];
    int32_t threads;
    int step;
    executor.user = &of;
    executor.concurrency = 3;
    executor.run = run_on_threads;
    options.executor = &executor;
    options.alone_below = 0;
    DO(motley_solver_create(NULL, &options, &lent));
    DO(motley_solver_threads(lent, &threads));
    DEMAND(threads == 3);
    executor.run = refuse_to_run;
    DO(motley_solver_create(NULL, &options, &failing));
    for (step = 0; step < 30; ++step) {
        steer(scene, agents, bodies);
        DO(motley_solver_step(alone, scene, time_step, 0, NULL, NULL));
    }
    DO(motley_scene_copy(scene, &copy));
    DO(motley_scene_save(scene, &bytes, &size));
    DO(motley_scene_load(bytes, size, &loaded));
    DO(motley_scene_save_file(scene, file));
    DO(motley_scene_load_file(file, &from_file));
    DEMAND(motley_scene_load(bytes, size / 2, &loaded) == MOTLEY_FILE_ERROR);
    motley_free(bytes);
    DO(motley_scene_state_hash(copy, &hashes[0]));
    DEMAND(motley_solver_step(failing, copy, time_step, 0, NULL, NULL) == MOTLEY_REFUSED);
    DEMAND(strstr(motley_last_error(), "motley_executor.run returned 12") != NULL);
    DO(motley_scene_state_hash(copy, &hashes[1]));
    DEMAND(hashes[0] == hashes[1]);
    for (step = 0; step < 30; ++step) {
        steer(scene, agents, bodies);
        DO(motley_solver_step(alone, scene, time_step, 0, NULL, NULL));
        steer(copy, agents, bodies);
        DO(motley_solver_step(lent, copy, time_step, 0, NULL, NULL));
        steer(loaded, agents, bodies);
        DO(motley_solver_step(alone, loaded, time_step, 0, NULL, NULL));
        steer(from_file, agents, bodies);
        DO(motley_solver_step(lent, from_file, time_step, 0, NULL, NULL));
    }
    DEMAND(of.runs == 60);
    DO(motley_scene_state_hash(scene, &hashes[0]));
    DO(motley_scene_state_hash(copy, &hashes[1]));
    DO(motley_scene_state_hash(loaded, &hashes[2]));
    DO(motley_scene_state_hash(from_file, &hashes[3]));
    DEMAND(hashes[0] == hashes[1] && hashes[0] == hashes[2] && hashes[0] == hashes[3]);
    motley_solver_destroy(alone);
    motley_solver_destroy(lent);
    motley_solver_destroy(failing);
    motley_scene_destroy(scene);
    motley_scene_destroy(copy);
    motley_scene_destroy(loaded);
    motley_scene_destroy(from_file);
    remove(file);
}

int main(int count, char** arguments)
{
    DEMAND(count == 2); /* the name of a file that may be written */
    DEMAND(motley_c_version() == MOTLEY_C_VERSION);
    DEMAND(motley_last_error()[0] == 0);
    check_defaults();
    check_pendulum();
    check_crowd();
    check_bad_input();
    check_copies(arguments[1]);
    return 0;
}
