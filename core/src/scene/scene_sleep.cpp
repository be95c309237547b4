// What a host's calls wake: see sleep.h.
#include <algorithm>
#include <utility>

#include "scene/scene_core.h"
#include "scene/wall_ends.h"
#include "stores/joint_store.h"

namespace motley {
bool Scene::is_asleep(BodyId body) const
{
    core_->require_alive(body, "is_asleep.body");
    return core_->bodies.motion(body) == BodyMotion::dynamic_body &&
           core_->bodies.sleep[body.slot] == Sleep::asleep;
}

void Scene::wake(BodyId body)
{
    core_->require_alive(body, "wake.body");
    core_->wake_island(body.slot);
}

void SceneCore::wake_island(std::uint32_t slot)
{
    if (!bodies.is_asleep(slot)) return;
    while (bodies.is_asleep(slot)) {
        bodies.wake(slot);
        joints->change_all_on(bodies.first_ends[slot]);
        slot = std::exchange(sleep.sleepers[slot].next, 0);
    }
    discs.is_divided = false;
}

void SceneCore::wake_all()
{
    for (std::uint32_t slot = 1; slot < bodies.slot_count(); ++slot) wake_island(slot);
}

void SceneCore::wake_contained()
{
    if (bodies.sleepers == 0) return;
    for (std::uint32_t slot = 1; slot < bodies.slot_count(); ++slot) {
        if (!bodies.is_asleep(slot)) continue;
        const BodyRow where = bodies.row_of(bodies.id_of_slot(slot));
        const auto quads = static_cast<std::size_t>(quads_of(where.kind()));
        float* const first = &bodies.rows(where.kind()).velocity[4 * quads * where.row()];
        // A contact with a body whose state is not finite may have left such a speed.
        const bool is_finite_speed =
            std::all_of(first, first + 4 * quads, [](float v) { return v - v == 0; });
        if (!is_finite_speed) std::fill_n(first, 4 * quads, 0.0F);
        if (!is_finite_speed || bodies.contained[slot] != 0) wake_island(slot);
    }
}

void SceneCore::wake_joined_to(BodyId body)
{
    if (bodies.sleepers == 0) return;
    joints->for_each_on(bodies.first_ends[body.slot], [&](const JointStores::Slot& joint) {
        joints->for_each([&](const auto& store, int type) {
            if (type != joint.type) return;
            wake_island(store.definitions[joint.index].body_a.slot);
            wake_island(store.definitions[joint.index].body_b.slot);
        });
    });
}

void SceneCore::wake_near(const WallSegment& segment, double reach)
{
    if (bodies.sleepers == 0) return;
    const auto [from, to] = wall_ends_of(*this, segment);
    const BodyRows& rows = bodies.rows(BodyKind::planar);
    for (std::uint32_t row = 1; row < rows.size(); ++row) {
        const std::uint32_t slot = rows.slot[row];
        if (slot == 0 || !bodies.is_asleep(slot)) continue;
        const DiscShape* const disc = discs.shape_of(slot);
        if (disc == nullptr) continue;
        const double near = static_cast<double>(disc->radius) + reach;
        if (distance2(in_plane(rows.pose[row].position), from, to) <= near * near) wake_island(slot);
    }
}

void SceneCore::wake_near_walls_of(BodyId body)
{
    for (const WallSegment& segment : discs.segments) {
        if (segment.body == body) wake_near(segment, touching_distance);
    }
}

void SceneCore::rouse(BodyId body)
{
    if (bodies.is_asleep(body.slot) || (bodies.sleepers > 0 && bodies.row_of(body).kind() == BodyKind::fixed))
        bodies.sleep[body.slot] = Sleep::roused;
}

/// The squares of accelerations are compared as the squares of speeds are: their root mean square over the mass.
void SceneCore::rouse_if_pushed(BodyId body)
{
    if (!bodies.is_asleep(body.slot)) return;
    const BodyRow where = bodies.row_of(body);
    const BodyRows& rows = bodies.rows(where.kind());
    const auto quads = static_cast<std::size_t>(quads_of(where.kind()));
    const std::array<float, 6>& then = sleep.sleepers[body.slot].acceleration;
    const float* now = &rows.acceleration[4 * quads * where.row()];
    const auto changed = [&](std::size_t i) { return now[i < 3 ? i : i + 1] - then[i]; };
    const Vec3<float> by{changed(0), changed(1), changed(2)};
    float square = 0;
    if (where.kind() == BodyKind::planar) {
        square = by.x * by.x + by.y * by.y +
                 by.z * by.z * (bodies.inverse_masses[body.slot] / bodies.inverse_inertias[body.slot]);
    } else {
        square = dot(by, by);
    }
    if (where.kind() == BodyKind::rigid) {
        const Vec3<float> torque{changed(3), changed(4), changed(5)};
        const Sym3<float> inverse =
            rotate_tensor(convert<float>(rows.orientation[where.row()]), rows.inverse_inertia[where.row()]);
        square += bodies.inverse_masses[body.slot] * dot(torque, inverse * torque);
    }
    if (!(square < sleep.speed * sleep.speed)) rouse(body);
}

}  // namespace motley
