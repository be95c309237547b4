// Who wakes when a step begins: see sleep_pipeline.h.
#include <cstring>

#include "crowd/disc_strips.h"
#include "scene/wall_ends.h"
#include "sleep_measures.h"
#include "sleep_pipeline.h"
#include "stores/array.h"
#include "stores/growth.h"

namespace motley {

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
    if (region == nullptr ? scene.bodies.sleepers == 0 : !region->anybody_sleeps()) return;
    const float substep = step.dt / static_cast<float>(step.settings.substeps);
    if (scene.last_step > 0) layout_.kept = {step.dt / scene.last_step, substep / scene.last_substep};
    wake_roused(scene);
    wake_beside_moving_bodies(step);
    wake_for_contacts(step);
    // Whom hosts have woken must be awake in all regions before others are looked for whom they may touch.
    if (region != nullptr) region->spread_waking(scene);
    wake_for_discs(step);
    if (region != nullptr) region->spread_waking(scene);
}

/// So that nothing is allocated once the bodies have moved.
void SleepPipeline::make_room(SceneCore& scene)
{
    const BodyStore& bodies = scene.bodies;
    grow_to(scene.sleep.sleepers, bodies.slot_count());
    std::size_t rows = 0;
    for (const BodyKind kind : moving_kinds) {
        rows += bodies.rows(kind).size();
        grow_to(candidates_, static_cast<std::size_t>(disc_chunks(bodies.rows(kind).size())));
    }
    if (islands_.size() == rows) return;
    islands_.reset([&](BodyKind kind) { return bodies.rows(kind).size(); });
    restless_.resize(rows);
    rings_.resize(rows);
}

void SleepPipeline::wake_roused(SceneCore& scene)
{
    const Array<Sleep>& sleep = scene.bodies.sleep;
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
    const auto look_at = [&](std::uint32_t i, Array<std::uint32_t>& touched) {
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
        Array<std::uint32_t>& touched = touched_[static_cast<std::size_t>(part)];
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
        Array<std::uint32_t>& touched = touched_[static_cast<std::size_t>(band)];
        touched.clear();
        const DiscBand& own = discs.bands[static_cast<std::size_t>(band)];
        if (own.half_awake == 0) return;
        for_each_disc_class([&](auto c) {
            if constexpr (!is_wall(c.value)) {
                const DiscBlocks& blocks = own.blocks[static_cast<std::size_t>(c.value)];
                for_each_lane(blocks, [&](std::size_t block, std::size_t lane) {
                    const BodyRow a = row_at(BodyKind::planar, blocks.bodies[block].a[lane]),
                                  b = row_at(BodyKind::planar, blocks.bodies[block].b[lane]);
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

}  // namespace motley
