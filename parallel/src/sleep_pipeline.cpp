// Who falls asleep when a step has ended: see sleep_pipeline.h.
#include "sleep_pipeline.h"

#include <algorithm>

#include "crowd/disc_strips.h"
#include "scene/wall_ends.h"
#include "sleep_measures.h"
#include "stores/joint_store.h"

namespace motley {
namespace {

/// Steps from one search for islands to the next.
constexpr std::int32_t steps_between_searches = 8;

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

/// Calls work(where, slot) for each dynamic body of a chunk of rows that can move and is awake.
template <class Work>
void for_each_awake(const BodyStore& bodies, BodyKind kind, std::int64_t chunk, const Work& work)
{
    const BodyRows& rows = bodies.rows(kind);
    rows.for_each_awake_row(chunk, [&](std::uint32_t row) {
        const std::uint32_t slot = rows.slot[row];
        if (bodies.contained[slot] == 0) work(BodyRow(kind, row), slot);
    });
}

/// A body that may fall asleep, if its island does.
bool is_candidate(const SleepPipeline::Step& step, std::uint32_t slot)
{
    const BodyStore& bodies = step.scene.bodies;
    const float slow_for = bodies.slow_for[slot];
    return slow_for > 0 && slow_for > step.settings.sleep_after - 0.5F * step.dt && !bodies.is_asleep(slot);
}

}  // namespace

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
    if (region != nullptr) {
        make_room(step.scene);              // people may have come since the step began
        region->spread_waking(step.scene);  // of bodies that this step has contained
    }
    std::int32_t& pause = step.scene.sleep.pause;
    if (pause > 0) --pause;
    bool is_any = is_any_slow_for_long(step);
    if (pause > 0) return;
    if (region != nullptr) is_any = region->is_so_anywhere(is_any);
    if (!is_any) return;
    pause = steps_between_searches;
    if (region != nullptr) region->renew_slowness(step.scene);
    find_islands(step);
    if (region != nullptr) region->join_islands(step.scene, islands_, restless_);
    put_to_sleep(step);
    if (region != nullptr) region->note_sleepers(step.scene);
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
                if (is_copy(slot)) return;
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

/// The same of bodies that are near each other but do not push. A sleeper does not keep the other one
/// awake: it does not move, and nobody has touched it, or it would have woken.
void SleepPipeline::tie_near(const Step& step, BodyRow a, BodyRow b)
{
    const BodyStore& bodies = step.scene.bodies;
    if (!bodies.is_asleep(a) && !bodies.is_asleep(b)) tie(step, a, b);
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
        if (list.step_impulses[i].normal > 0) {
            tie(step, placement.a, placement.b);
            continue;
        }
        const double goes =
            reach_of(step, placement.a, contact.arm_a) + reach_of(step, placement.b, contact.arm_b);
        if (static_cast<double>(contact.separation) <= 2 * touching_distance + goes)
            tie_near(step, placement.a, placement.b);
    }
}

void SleepPipeline::tie_discs(const Step& step)
{
    SceneCore& scene = step.scene;
    const bool walls_move = fastest_wall_end(scene) > 0;
    const auto candidate = [&](BodyRow body) { return is_candidate(step, slot_of(scene.bodies, body)); };
    for_each_solved_blocks(scene.discs, [&](auto c, const DiscBlocks& blocks) {
        using Fields = DiscFieldsOf<c.value>;
        if (is_wall(c.value) && !walls_move) return;
        for_each_lane(blocks, [&](std::size_t block, std::size_t lane) {
            const BodyRow b = row_at(BodyKind::planar, blocks.bodies[block].b[lane]);
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
                const BodyRow a = row_at(BodyKind::planar, blocks.bodies[block].a[lane]);
                if (!candidate(a) && !candidate(b)) return;
                if (pushes())
                    tie(step, a, b);
                else if (gap_of<c.value>(scene, blocks, block, lane) <=
                         2 * touching_distance + reach_of(step, a, {}) + reach_of(step, b, {}))
                    tie_near(step, a, b);
            }
        });
    });
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

/// Candidates whose island is not restless fall asleep, each island as a ring. In a region of a larger crowd each of them
/// is a ring of its own, because RegionLink wakes islands by their names.
void SleepPipeline::put_to_sleep(const Step& step)
{
    SceneCore& scene = step.scene;
    BodyStore& bodies = scene.bodies;
    rings_.assign(islands_.size(), {});
    for (const BodyKind kind : moving_kinds) {
        const BodyRows& rows = bodies.rows(kind);
        const auto quads = static_cast<std::size_t>(quads_of(kind));
        for (std::int64_t chunk = 0; chunk < disc_chunks(rows.size()); ++chunk) {
            for_each_awake(bodies, kind, chunk, [&](BodyRow where, std::uint32_t slot) {
                const auto island = static_cast<std::size_t>(islands_.root(where));
                if (!is_candidate(step, slot) || restless_[island] != 0) return;
                Ring& ring = rings_[island];
                if (ring.head == 0 || region != nullptr) ring.head = ring.tail = slot;
                Sleeper& sleeper = scene.sleep.sleepers[slot];
                scene.sleep.sleepers[ring.tail].next = slot;
                sleeper.next = ring.head;
                ring.tail = slot;
                const float* a = &rows.acceleration[4 * quads * where.row()];
                sleeper.acceleration = {a[0], a[1], a[2]};
                if (quads == 2) std::copy_n(a + 4, 3, sleeper.acceleration.begin() + 3);
                bodies.fall_asleep(slot);
                scene.joints->change_all_on(bodies.first_ends[slot]);
                scene.discs.is_divided = false;
            });
        }
    }
}

}  // namespace motley
