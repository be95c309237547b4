// See sleep_pipeline.h.
#include "sleep_pipeline.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "crowd/disc_strips.h"
#include "motley/core/settings.h"
#include "scene/wall_ends.h"
#include "stores/disc_fields.h"
#include "stores/growth.h"
#include "stores/joint_store.h"

namespace motley {
namespace {

/// Steps from one search for islands to the next.
constexpr std::int32_t steps_between_searches = 8;

const float* velocity_of(const BodyStore& bodies, BodyRow where)
{
    const auto quads = static_cast<std::size_t>(quads_of(where.kind()));
    return &bodies.rows(where.kind()).velocity[4 * quads * where.row()];
}

std::uint32_t slot_of(const BodyStore& bodies, BodyRow where)
{
    return bodies.rows(where.kind()).slot[where.row()];
}

/// The square of the root mean square speed of a dynamic body: see SolverSettings::sleep_speed.
float square_speed(const BodyStore& bodies, BodyRow where)
{
    const BodyRows& rows = bodies.rows(where.kind());
    const float* v = velocity_of(bodies, where);
    const float of_centre = v[0] * v[0] + v[1] * v[1];
    switch (where.kind()) {
        case BodyKind::planar:
            return of_centre + v[2] * v[2] * (v[3] / bodies.inverse_inertias[rows.slot[where.row()]]);
        case BodyKind::rigid: {
            const Quat<float> q = convert<float>(rows.orientation[where.row()]);
            const Vec3<float> w = rotate(conjugate(q), Vec3<float>{v[4], v[5], v[6]});
            return of_centre + v[2] * v[2] + v[3] * dot(w, rows.inertia[where.row()] * w);
        }
        default:
            return of_centre + v[2] * v[2];
    }
}

/// Whether a body that is not dynamic moves, or was moved since the last step.
bool is_moving(const BodyStore& bodies, BodyRow fixed)
{
    const float* v = velocity_of(bodies, fixed);
    return v[0] != 0 || v[1] != 0 || v[2] != 0 || v[4] != 0 || v[5] != 0 || v[6] != 0 ||
           bodies.sleep[slot_of(bodies, fixed)] == Sleep::roused;
}

/// How far a point of a body goes in a step at its present speed and acceleration, m. `arm`, m, leads to the point.
double reach_of(const SleepPipeline::Step& step, BodyRow where, const Vec3<float>& arm)
{
    const BodyStore& bodies = step.scene.bodies;
    const BodyRows& rows = bodies.rows(where.kind());
    const auto quads = static_cast<std::size_t>(quads_of(where.kind()));
    const float* v = velocity_of(bodies, where);
    const float* a = &rows.acceleration[4 * quads * where.row()];
    const bool in_plane = where.kind() == BodyKind::planar, moves = where.kind() != BodyKind::fixed;
    const Vec3<float>& g = step.settings.gravity;
    const Vec3<double> velocity = convert<double>(Vec3<float>{v[0], v[1], in_plane ? 0 : v[2]});
    const Vec3<double> acceleration =
        convert<double>(Vec3<float>{a[0] + g.x, a[1] + g.y, in_plane ? 0 : a[2] + g.z});
    const Vec3<double> spin = convert<double>(in_plane     ? Vec3<float>{0, 0, v[2]}
                                              : quads == 2 ? Vec3<float>{v[4], v[5], v[6]}
                                                           : Vec3<float>{});
    const auto length = [](const Vec3<double>& u) { return std::sqrt(dot(u, u)); };
    const double dt = static_cast<double>(step.dt);
    const double speed = length(velocity) + length(spin) * length(convert<double>(arm));
    return dt * (speed + (moves ? dt * length(acceleration) : 0));
}

/// The gap between the two discs of a lane as they are now, m.
template <DiscClass c>
double gap_of(const SceneCore& scene, const DiscBlocks& blocks, std::size_t block, std::size_t lane)
{
    const AlignedVector<BodyPose>& poses = scene.bodies.rows(BodyKind::planar).pose;
    const BlockBodies& bodies = blocks.bodies[block];
    const Vec2<double> between = in_plane(poses[row_at(bodies.b[lane], BodyKind::planar).row()].position) -
                                 in_plane(poses[row_at(bodies.a[lane], BodyKind::planar).row()].position);
    const auto row = load_lane<typename DiscFieldsOf<c>::Row>(blocks.rows.data(), block, lane);
    double radii = 0;
    if constexpr (is_rough(c)) {
        radii = static_cast<double>(row.radius_a) + static_cast<double>(row.radius_b);
    } else {
        radii = static_cast<double>(row.reach);
    }
    return std::sqrt(dot(between, between)) - radii;
}

/// Calls work(where, slot) for each dynamic body of a chunk of rows that can move and is awake.
template <class Work>
void for_each_awake(const BodyStore& bodies, BodyKind kind, std::int64_t chunk, const Work& work)
{
    const BodyRows& rows = bodies.rows(kind);
    if (!rows.is_chunk_awake(chunk)) return;
    for_each_row_of_chunk(chunk, rows.size(), [&](std::uint32_t row) {
        const std::uint32_t slot = rows.slot[row];
        if (slot != 0 && bodies.contained[slot] == 0 && !bodies.is_asleep(slot))
            work(BodyRow(kind, row), slot);
    });
}

/// A body that may fall asleep, if its island does.
bool is_candidate(const SleepPipeline::Step& step, std::uint32_t slot)
{
    const BodyStore& bodies = step.scene.bodies;
    const float slow_for = bodies.slow_for[slot];
    return slow_for > 0 && slow_for > step.settings.sleep_after - 0.5F * step.dt && !bodies.is_asleep(slot);
}

constexpr std::array moving_kinds{BodyKind::particle, BodyKind::planar, BodyKind::rigid};

}  // namespace

void SleepPipeline::wake(const Step& step)
{
    SceneCore& scene = step.scene;
    SleepStore& sleep = scene.sleep;
    if (step.settings.sleep_speed > 0) make_room(scene);
    const Vec3<float>&was = sleep.gravity, &is = step.settings.gravity;
    const bool all_wake = was.x != is.x || was.y != is.y || was.z != is.z || step.settings.sleep_speed == 0;
    if (all_wake && scene.bodies.sleepers > 0) scene.wake_all();
    sleep.gravity = is;
    sleep.speed = step.settings.sleep_speed;
    layout_.kept = {};
    if (scene.bodies.sleepers == 0) return;
    const float substep = step.dt / static_cast<float>(step.settings.substeps);
    if (scene.last_step > 0) layout_.kept = {step.dt / scene.last_step, substep / scene.last_substep};
    wake_roused(scene);
    wake_beside_moving_bodies(step);
    wake_for_contacts(step);
    wake_for_discs(step);
}

/// So that nothing is allocated once the bodies have moved.
void SleepPipeline::make_room(SceneCore& scene)
{
    const BodyStore& bodies = scene.bodies;
    grow_to(scene.sleep.sleepers, bodies.slot_count());
    std::size_t rows = 0;
    for (const BodyKind kind : moving_kinds) {
        rows += bodies.rows(kind).size();
        grow_to(candidates_, bodies.rows(kind).awake.size());
    }
    if (islands_.size() == rows) return;
    islands_.reset([&](BodyKind kind) { return bodies.rows(kind).size(); });
    restless_.resize(rows);
    rings_.resize(rows);
}

void SleepPipeline::wake_roused(SceneCore& scene)
{
    const std::vector<Sleep>& sleep = scene.bodies.sleep;
    const Sleep* const end = sleep.data() + sleep.size();
    const auto next = [end](const Sleep* from) {
        return static_cast<const Sleep*>(
            std::memchr(from, static_cast<int>(Sleep::roused), static_cast<std::size_t>(end - from)));
    };
    for (const Sleep* at = next(sleep.data()); at != nullptr; at = next(at + 1))
        scene.wake_island(static_cast<std::uint32_t>(at - sleep.data()));
}

void SleepPipeline::wake_beside_moving_bodies(const Step& step)
{
    SceneCore& scene = step.scene;
    const BodyRows& fixed = scene.bodies.rows(BodyKind::fixed);
    for (std::uint32_t row = 1; row < fixed.size(); ++row) {
        if (fixed.slot[row] != 0 && is_moving(scene.bodies, {BodyKind::fixed, row}))
            scene.wake_joined_to(scene.bodies.id_of_slot(fixed.slot[row]));
    }
    for (const WallSegment& segment : scene.discs.segments) {
        const double goes = static_cast<double>(step.dt) * speed_of_wall(scene, segment);
        if (goes > 0) scene.wake_near(segment, touching_distance + goes);
    }
}

void SleepPipeline::wake_touched(SceneCore& scene, std::size_t parts)
{
    for (std::size_t part = 0; part < parts; ++part) {
        for (const std::uint32_t slot : touched_[part]) scene.wake_island(slot);
    }
}

void SleepPipeline::wake_for_contacts(const Step& step)
{
    SceneCore& scene = step.scene;
    BodyStore& bodies = scene.bodies;
    const ContactCache& cache = scene.contacts;
    const ContactList& last = cache.current();
    const auto parts = static_cast<std::size_t>(cache.part_count());
    grow_to(touched_, parts);
    const auto look_at = [&](std::uint32_t i, std::vector<std::uint32_t>& touched) {
        const Placement& placement = layout_.intake.placements[i];
        const bool a_sleeps = bodies.is_asleep(placement.a), b_sleeps = bodies.is_asleep(placement.b);
        if (placement.is_bad || (!a_sleeps && !b_sleeps)) return;
        const Contact& contact = step.contacts[i];
        const BodyRow sleeper = a_sleeps ? placement.a : placement.b,
                      other = a_sleeps ? placement.b : placement.a;
        if (bodies.is_contained(other)) return;
        const auto before = static_cast<std::size_t>(layout_.intake.memory_index[i]);
        const bool pushed = before > 0 && last.step_impulses[before - 1].normal > 0;
        const auto gap = static_cast<double>(contact.separation);
        bool wakes = false;
        if ((a_sleeps && b_sleeps) || (other.kind() == BodyKind::fixed && !is_moving(bodies, other))) {
            wakes = before == 0 && gap <= touching_distance;  // it is new
        } else {
            const double goes = reach_of(step, other, a_sleeps ? contact.arm_b : contact.arm_a);
            wakes = gap <= touching_distance + goes || (pushed && other.kind() == BodyKind::fixed);
        }
        if (!wakes) return;
        touched.push_back(slot_of(bodies, sleeper));
        if (a_sleeps && b_sleeps) touched.push_back(slot_of(bodies, other));
    };
    runner_.run(static_cast<std::int64_t>(parts), [&](std::int64_t part) {
        std::vector<std::uint32_t>& touched = touched_[static_cast<std::size_t>(part)];
        touched.clear();
        const ContactCache::Range range = cache.part(part);
        for (std::uint32_t i = range.begin; i < range.end; ++i) look_at(i, touched);
    });
    wake_touched(scene, parts);
    if (last.has_sleepers) {
        cache.for_each_gone([&](std::uint32_t i) {
            if (last.sleepers[i] != 0 && last.step_impulses[i].normal > 0)
                scene.wake_island(last.sleepers[i]);
        });
    }
    // Nobody needs the marks of moved bodies any more.
    for (const std::uint32_t slot : bodies.rows(BodyKind::fixed).slot) bodies.sleep[slot] = Sleep::awake;
}

void SleepPipeline::wake_for_discs(const Step& step)
{
    SceneCore& scene = step.scene;
    const DiscStore& discs = scene.discs;
    grow_to(touched_, discs.band_count);
    runner_.run(static_cast<std::int64_t>(discs.band_count), [&](std::int64_t band) {
        std::vector<std::uint32_t>& touched = touched_[static_cast<std::size_t>(band)];
        touched.clear();
        const DiscBand& own = discs.bands[static_cast<std::size_t>(band)];
        if (own.half_awake == 0) return;
        for_each_disc_class([&](auto c) {
            if constexpr (!is_wall(c.value)) {
                const DiscBlocks& blocks = own.blocks[static_cast<std::size_t>(c.value)];
                for_each_lane(blocks, [&](std::size_t block, std::size_t lane) {
                    const BodyRow a = row_at(blocks.bodies[block].a[lane], BodyKind::planar),
                                  b = row_at(blocks.bodies[block].b[lane], BodyKind::planar);
                    const bool a_sleeps = scene.bodies.is_asleep(a), b_sleeps = scene.bodies.is_asleep(b);
                    if (a_sleeps == b_sleeps) return;
                    // A removed body may have left its row to another one.
                    if (discs.is_removed_row(a.row()) || discs.is_removed_row(b.row())) return;
                    const double goes = reach_of(step, a_sleeps ? b : a, {});
                    if (gap_of<c.value>(scene, blocks, block, lane) <= touching_distance + goes)
                        touched.push_back(slot_of(scene.bodies, a_sleeps ? a : b));
                });
            }
        });
    });
    wake_touched(scene, discs.band_count);
}

void SleepPipeline::keep_loads(SceneCore& scene)
{
    const Layout::Kept& kept = layout_.kept;
    if (scene.bodies.sleepers == 0 || (kept.step == 1 && kept.substep == 1)) return;
    runner_.run(static_cast<std::int64_t>(scene.discs.band_count), [&](std::int64_t band) {
        for (DiscBlocks& blocks : scene.discs.bands[static_cast<std::size_t>(band)].resting) {
            if (blocks.count == 0) continue;
            for (float& impulse : blocks.impulses) impulse *= kept.substep;
            for (float& sum : blocks.sums) sum *= kept.step;
        }
    });
    scene.joints->for_each([&](auto& store, int) {
        using Store = std::remove_cvref_t<decltype(store)>;
        for (std::size_t i = 0; i < store.size(); ++i) {
            if (!scene.bodies.is_asleep(store.definitions[i].body_a.slot) &&
                !scene.bodies.is_asleep(store.definitions[i].body_b.slot))
                continue;
            for (std::size_t f = 0; f < Store::wrench_floats; ++f)
                store.wrenches[Store::wrench_floats * i + f] *= kept.step;
        }
    });
}

void SleepPipeline::fall_asleep(const Step& step)
{
    if (step.settings.sleep_speed == 0) return;
    std::int32_t& pause = step.scene.sleep.pause;
    if (pause > 0) --pause;
    if (!is_any_slow_for_long(step) || pause > 0) return;
    pause = steps_between_searches;
    find_islands(step);
    put_to_sleep(step);
}

/// Counts for how long each body has been slow, and returns whether there is a candidate for sleep.
bool SleepPipeline::is_any_slow_for_long(const Step& step)
{
    BodyStore& bodies = step.scene.bodies;
    const float limit = step.settings.sleep_speed * step.settings.sleep_speed;
    bool any = false;
    for (const BodyKind kind : moving_kinds) {
        const std::int64_t chunks = disc_chunks(bodies.rows(kind).size());
        runner_.run(chunks, [&](std::int64_t chunk) {
            std::int64_t found = 0;
            for_each_awake(bodies, kind, chunk, [&](BodyRow where, std::uint32_t slot) {
                const bool is_slow = square_speed(bodies, where) < limit;
                bodies.slow_for[slot] = is_slow ? bodies.slow_for[slot] + step.dt : 0;
                found += is_candidate(step, slot) ? 1 : 0;
            });
            candidates_[static_cast<std::size_t>(chunk)] = found;
        });
        any = any || std::any_of(candidates_.begin(), candidates_.begin() + chunks,
                                 [](std::int64_t found) { return found > 0; });
    }
    return any;
}

/// Notes that two bodies belong to one island, or that one that is awake or moves keeps the other's awake.
void SleepPipeline::tie(const Step& step, BodyRow a, BodyRow b)
{
    const BodyStore& bodies = step.scene.bodies;
    const auto is_slow = [&](BodyRow body) {
        return body.kind() != BodyKind::fixed && is_candidate(step, slot_of(bodies, body));
    };
    const bool a_is_slow = is_slow(a), b_is_slow = is_slow(b);
    if (a_is_slow && b_is_slow) return islands_.tie(a, b);
    const BodyRow other = a_is_slow ? b : a;
    if (bodies.is_contained(other) || (other.kind() == BodyKind::fixed && !is_moving(bodies, other))) return;
    if (a_is_slow || b_is_slow) restless_[islands_.number(a_is_slow ? a : b)] = 1;
}

void SleepPipeline::tie_joints(const Step& step)
{
    const BodyStore& bodies = step.scene.bodies;
    step.scene.joints->for_each([&](const auto& store, int) {
        for (const auto& definition : store.definitions)
            tie(step, bodies.row_of(definition.body_a), bodies.row_of(definition.body_b));
    });
}

void SleepPipeline::tie_contacts(const Step& step)
{
    const ContactList& list = step.scene.contacts.current();
    for (std::size_t i = 0; i < list.count; ++i) {
        const Placement& placement = layout_.intake.placements[i];
        if (placement.is_left_out()) continue;
        const Contact& contact = step.contacts[i];
        if (!(list.step_impulses[i].normal > 0)) {
            const double goes =
                reach_of(step, placement.a, contact.arm_a) + reach_of(step, placement.b, contact.arm_b);
            if (static_cast<double>(contact.separation) > 2 * touching_distance + goes) continue;
        }
        tie(step, placement.a, placement.b);
    }
}

void SleepPipeline::tie_discs(const Step& step)
{
    SceneCore& scene = step.scene;
    const bool walls_move = fastest_wall_end(scene) > 0;
    const auto candidate = [&](BodyRow body) { return is_candidate(step, slot_of(scene.bodies, body)); };
    for (std::size_t band = 0; band < scene.discs.band_count; ++band) {
        for_each_disc_class([&](auto c) {
            using Fields = DiscFieldsOf<c.value>;
            const DiscBlocks& blocks = scene.discs.bands[band].blocks[static_cast<std::size_t>(c.value)];
            if (is_wall(c.value) && !walls_move) return;
            for_each_lane(blocks, [&](std::size_t block, std::size_t lane) {
                const BodyRow b = row_at(blocks.bodies[block].b[lane], BodyKind::planar);
                const auto pushes = [&] {
                    return load_lane<typename Fields::Impulse>(blocks.sums.data(), block, lane).normal > 0;
                };
                if constexpr (is_wall(c.value)) {
                    const auto row = load_lane<typename Fields::Row>(blocks.rows.data(), block, lane);
                    const WallSegment& segment =
                        scene.discs.segments[blocks.touches[block_lanes * block + lane].segment];
                    const double goes = static_cast<double>(step.dt) * speed_of_wall(scene, segment);
                    const auto gap = static_cast<double>(row.in_sweep.separation);
                    if (goes > 0 && (pushes() || gap <= 2 * touching_distance + goes + reach_of(step, b, {})))
                        tie(step, scene.bodies.row_of(segment.body), b);
                } else {
                    const BodyRow a = row_at(blocks.bodies[block].a[lane], BodyKind::planar);
                    if (!candidate(a) && !candidate(b)) return;
                    if (pushes() || gap_of<c.value>(scene, blocks, block, lane) <=
                                        2 * touching_distance + reach_of(step, a, {}) + reach_of(step, b, {}))
                        tie(step, a, b);
                }
            });
        });
    }
}

void SleepPipeline::find_islands(const Step& step)
{
    const BodyStore& bodies = step.scene.bodies;
    islands_.reset([&](BodyKind kind) { return bodies.rows(kind).size(); });
    restless_.assign(islands_.size(), 0);
    tie_joints(step);
    tie_contacts(step);
    tie_discs(step);
    islands_.flatten();
    for (const BodyKind kind : moving_kinds) {
        for (std::uint32_t row = 1; row < bodies.rows(kind).size(); ++row) {
            const BodyRow where(kind, row);
            if (restless_[islands_.number(where)] != 0)
                restless_[static_cast<std::size_t>(islands_.root(where))] = 1;
        }
    }
}

/// Candidates whose island is not restless fall asleep, each island as a ring.
void SleepPipeline::put_to_sleep(const Step& step)
{
    SceneCore& scene = step.scene;
    BodyStore& bodies = scene.bodies;
    rings_.assign(islands_.size(), {});
    std::size_t fell_asleep = 0;
    for (const BodyKind kind : moving_kinds) {
        const BodyRows& rows = bodies.rows(kind);
        const auto quads = static_cast<std::size_t>(quads_of(kind));
        for (std::int64_t chunk = 0; chunk < disc_chunks(rows.size()); ++chunk) {
            for_each_awake(bodies, kind, chunk, [&](BodyRow where, std::uint32_t slot) {
                const auto island = static_cast<std::size_t>(islands_.root(where));
                if (!is_candidate(step, slot) || restless_[island] != 0) return;
                Ring& ring = rings_[island];
                if (ring.head == 0) ring.head = ring.tail = slot;
                Sleeper& sleeper = scene.sleep.sleepers[slot];
                scene.sleep.sleepers[ring.tail].next = slot;
                sleeper.next = ring.head;
                ring.tail = slot;
                const float* a = &rows.acceleration[4 * quads * where.row()];
                sleeper.acceleration = {a[0], a[1], a[2]};
                if (quads == 2) std::copy_n(a + 4, 3, sleeper.acceleration.begin() + 3);
                bodies.fall_asleep(slot);
                ++fell_asleep;
            });
        }
    }
    if (fell_asleep == 0) return;
    scene.sleepers_changed();
}

}  // namespace motley
