/* A game in C: a curtain of beads that a ball flies through. The game has a job system of its own, on which steps run,
   and draws between two steps at the rate of its screen.

     game_loop     prints the ball's place in some frames, and whether one thread gives the same bits */
#define _POSIX_C_SOURCE 200809L
#include <motley/c/motley.h>

#include <inttypes.h>
#include <pthread.h>
#include <stdio.h>

enum { workers = 2, strings = 16, beads = 10, bodies = strings * beads + 1 };
static const float step_seconds = 1.0F / 120;

/* ---- the job system: a queue and threads that take from it ---- */

typedef struct task {
    void (*run)(void* of, int32_t index);
    void* of;
    int32_t index;
} task;
typedef struct job_system {
    pthread_mutex_t lock;
    pthread_cond_t changed;
    pthread_t threads[workers - 1];
    task queue[64];
    int queued, running, ends;
} job_system;

static void* work(void* of)
{
    job_system* jobs = of;
    pthread_mutex_lock(&jobs->lock);
    while (!jobs->ends) {
        if (jobs->queued == 0) {
            pthread_cond_wait(&jobs->changed, &jobs->lock);
            continue;
        }
        const task next = jobs->queue[--jobs->queued];
        ++jobs->running;
        pthread_mutex_unlock(&jobs->lock);
        next.run(next.of, next.index);
        pthread_mutex_lock(&jobs->lock);
        --jobs->running;
        pthread_cond_broadcast(&jobs->changed);
    }
    pthread_mutex_unlock(&jobs->lock);
    return NULL;
}
static int start(job_system* jobs)
{
    jobs->queued = jobs->running = jobs->ends = 0;
    if (pthread_mutex_init(&jobs->lock, NULL) || pthread_cond_init(&jobs->changed, NULL)) return -1;
    for (int i = 0; i < workers - 1; ++i)
        if (pthread_create(&jobs->threads[i], NULL, work, jobs)) return -1;
    return 0;
}
static void stop(job_system* jobs)
{
    pthread_mutex_lock(&jobs->lock);
    jobs->ends = 1;
    pthread_cond_broadcast(&jobs->changed);
    pthread_mutex_unlock(&jobs->lock);
    for (int i = 0; i < workers - 1; ++i) pthread_join(jobs->threads[i], NULL);
}

/* What motley calls: worker 0 runs here and the others where a thread is free. What has not begun by then is taken back, for
   a step is done by however many come. Only the game's main thread puts tasks into the queue. */
static void run_worker(void* job, int32_t worker)
{
    motley_job_run(job, worker);
}
static int32_t run_step(void* user, int32_t count, motley_job* job)
{
    job_system* jobs = user;
    pthread_mutex_lock(&jobs->lock);
    const int before = jobs->queued;
    for (int32_t worker = 1; worker < count; ++worker) {
        const task share = {run_worker, job, worker};
        jobs->queue[jobs->queued++] = share;
    }
    pthread_cond_broadcast(&jobs->changed);
    pthread_mutex_unlock(&jobs->lock);
    const motley_status status = motley_job_run(job, 0);
    pthread_mutex_lock(&jobs->lock);
    if (jobs->queued > before) jobs->queued = before;
    while (jobs->running > 0) pthread_cond_wait(&jobs->changed, &jobs->lock);
    pthread_mutex_unlock(&jobs->lock);
    return status;
}

/* ---- the game ---- */

typedef struct game {
    motley_scene* scene;
    motley_body_id handles[bodies];           /* the beads, and last the ball */
    motley_vec3d before[bodies], now[bodies]; /* where they were a step ago, and are */
} game;

/* Adds a body with a sphere about its centre. Not 0 if that failed, as with all calls of motley. */
static int add_sphere(game* of, int index, motley_vec3d place, float radius, float mass)
{
    motley_body_definition body = motley_default_body_definition();
    motley_capsule_definition sphere = motley_default_capsule_definition();
    motley_shape_id shape;
    body.position = place;
    body.mass = mass;
    body.inertia.xx = body.inertia.yy = body.inertia.zz = 0.4F * mass * radius * radius;
    sphere.radius = radius;
    sphere.friction = 0.3F;
    if (motley_scene_add_body(of->scene, &body, &of->handles[index])) return -1;
    sphere.body = of->handles[index];
    return motley_scene_add_capsule(of->scene, &sphere, &shape) != MOTLEY_DONE;
}
static int build(game* of)
{
    const float spacing = 0.12F;
    motley_body_id ground;
    if (motley_scene_create(&of->scene) || motley_scene_ground(of->scene, &ground)) return -1;
    for (int string = 0; string < strings; ++string) {
        for (int bead = 0; bead < beads; ++bead) {
            const motley_vec3d place = {spacing * (float)string, 0, 2 - spacing * (float)(bead + 1)};
            const int index = string * beads + bead;
            motley_distance_definition thread = motley_default_distance_definition();
            if (add_sphere(of, index, place, 0.04F, 0.1F)) return -1;
            thread.body_a = bead == 0 ? ground : of->handles[index - 1];
            thread.body_b = of->handles[index];
            if (bead == 0) {
                thread.local_anchor_a.x = spacing * (float)string;
                thread.local_anchor_a.z = 2;
            }
            thread.min_length = 0;
            thread.max_length = spacing;
            if (motley_scene_add_distance(of->scene, &thread, NULL)) return -1;
        }
    }
    const motley_vec3d start = {0.9, -2, 1.4};
    const motley_vec3f thrown = {0, 6, 1}, still = {0, 0, 0};
    if (add_sphere(of, bodies - 1, start, 0.15F, 2)) return -1;
    if (motley_scene_set_velocity(of->scene, of->handles[bodies - 1], thrown, still)) return -1;
    return motley_scene_read_positions(of->scene, bodies, of->handles, of->now, sizeof(motley_vec3d)) !=
           MOTLEY_DONE;
}

/* Where a body is drawn, `share` of a step after the step before the last. */
static motley_vec3d drawn(const game* of, int index, double share)
{
    const motley_vec3d a = of->before[index], b = of->now[index];
    const motley_vec3d between = {a.x + share * (b.x - a.x), a.y + share * (b.y - a.y),
                                  a.z + share * (b.z - a.z)};
    return between;
}

/* Plays 90 frames of uneven duration and writes the hash of the end. */
static int play(const motley_solver_options* options, int is_drawn, uint64_t* hash)
{
    static const double frame_seconds[] = {1 / 60.0, 1 / 60.0, 1 / 30.0, 1 / 75.0};
    static game of;
    motley_solver_settings settings = motley_default_solver_settings();
    motley_solver* solver = NULL;
    double owed = 0;
    settings.gravity.z = -9.81F;
    if (build(&of) || motley_solver_create(&settings, options, &solver)) return -1;
    for (int frame = 0; frame < 90; ++frame) {
        /* A real game measures its frames, and caps them, so that a long one does not make the next one longer. */
        owed += frame_seconds[frame % 4];
        for (; owed >= step_seconds; owed -= step_seconds) {
            for (int i = 0; i < bodies; ++i) of.before[i] = of.now[i];
            if (motley_solver_step(solver, of.scene, step_seconds, 0, NULL, NULL)) return -1;
            if (motley_scene_read_positions(of.scene, bodies, of.handles, of.now, sizeof(motley_vec3d)))
                return -1;
        }
        if (is_drawn && frame % 15 == 0) {
            const motley_vec3d ball = drawn(&of, bodies - 1, owed / step_seconds);
            printf("frame %2d: the ball is at %6.3f %6.3f %6.3f m\n", frame, ball.x, ball.y, ball.z);
        }
    }
    const int failed = motley_scene_state_hash(of.scene, hash) != MOTLEY_DONE;
    motley_solver_destroy(solver);
    motley_scene_destroy(of.scene);
    return failed;
}

int main(void)
{
    static job_system jobs;
    motley_executor executor = motley_default_executor();
    motley_solver_options on_jobs = motley_default_solver_options();
    uint64_t hashes[2] = {0, 1};
    executor.user = &jobs;
    executor.concurrency = workers;
    executor.run = run_step;
    on_jobs.executor = &executor;
    on_jobs.alone_below = 0; /* lends threads to steps as small as this one, for the example's sake */
    if (start(&jobs)) return fprintf(stderr, "game_loop: no threads\n"), 1;
    const int failed = play(&on_jobs, 1, &hashes[0]) || play(NULL, 0, &hashes[1]);
    if (failed) fprintf(stderr, "game_loop: %s\n", motley_last_error());
    stop(&jobs);
    if (failed) return 1;
    printf("jobs %016" PRIx64 ", one thread %016" PRIx64 ": %s\n", hashes[0], hashes[1],
           hashes[0] == hashes[1] ? "the same bits" : "not the same");
    return hashes[0] == hashes[1] ? 0 : 1;
}
