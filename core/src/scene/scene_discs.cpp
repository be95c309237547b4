// Discs and walls as the host sets and reads them. Nothing is changed before everything is checked.
#include <string>

#include "motley/core/invalid_input.h"
#include "scene/body_checks.h"
#include "scene/disc_impulses.h"
#include "scene/scene_core.h"
#include "stores/array.h"
#include "stores/growth.h"
#include "stores/joint_store.h"

namespace motley {
namespace {

void check_points(const WallDefinition& wall)
{
    const std::size_t least = wall.closed ? 3 : 2, count = wall.points.size();
    if (count < least)
        refuse("WallDefinition.points.size()", static_cast<double>(count),
               wall.closed ? "3 or more of a closed wall" : "2 or more");
    for (std::size_t i = 0; i < count; ++i) {
        const std::string name = "WallDefinition.points[" + std::to_string(i) + "]";
        if (i + 1 < count || wall.closed) {
            check_segment(name.c_str(), wall.points[i], wall.points[(i + 1) % count]);
        } else {
            check_position(name.c_str(), {wall.points[i].x, wall.points[i].y, 0});
        }
    }
}

}  // namespace

void SceneCore::check_has_disc(BodyId body, const char* what) const
{
    require_alive(body, what);
    if (!has_disc(body)) refuse(what, "a body without a disc", "a body with a disc");
}

void Scene::set_disc(BodyId body, const DiscDefinition& disc)
{
    set_discs({&body, 1}, StridedSpan<const DiscDefinition>(&disc, 1));
}

void Scene::set_discs(std::span<const BodyId> bodies, StridedSpan<const DiscDefinition> discs)
{
    if (discs.size() != bodies.size())
        refuse("set_discs.discs.size()", static_cast<double>(discs.size()), "the size of bodies");
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        core_->require_alive(bodies[i], "set_discs.bodies");
        if (core_->bodies.model(bodies[i]) != BodyModel::planar ||
            core_->bodies.motion(bodies[i]) != BodyMotion::dynamic_body)
            refuse("set_discs.bodies", "a body that is not planar and dynamic", "planar, dynamic bodies");
        check_disc(discs[i]);
    }
    grow_to(core_->discs.shapes, core_->bodies.slot_count());
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        core_->wake_island(bodies[i].slot);
        core_->discs.set_shape(bodies[i].slot,
                               {discs[i].radius, discs[i].friction, discs[i].category, discs[i].mask});
    }
    core_->shapes.version.reset();  // capsules may meet them
}

void Scene::clear_disc(BodyId body)
{
    core_->check_has_disc(body, "clear_disc.body");
    core_->wake_island(body.slot);
    core_->discs.set_shape(body.slot, {});
    core_->forget_discs_of(body);
    core_->shapes.version.reset();
}

bool Scene::has_disc(BodyId body) const
{
    core_->require_alive(body, "has_disc.body");
    return core_->has_disc(body);
}

WallId Scene::add_wall(const WallDefinition& wall)
{
    core_->check_wall(wall);
    core_->make_room_for_walls(1, wall.points.size());
    return core_->put_wall(wall);
}

void SceneCore::check_wall(const WallDefinition& wall) const
{
    check_points(wall);
    check_wall_surface(wall.friction, wall.surface_speed);
    check_wall_force(wall.max_force);
    const BodyId body = wall.body == BodyId{} ? ground : wall.body;
    require_alive(body, "WallDefinition.body");
    if (bodies.motion(body) == BodyMotion::dynamic_body)
        refuse("WallDefinition.body", "a dynamic body", "a static or kinematic body");
}

void SceneCore::make_room_for_walls(std::size_t walls, std::size_t segments)
{
    make_room_for(discs.segments, segments);
    make_room_for(discs.walls, walls);
    make_room_for(discs.free_walls, walls);
}

WallId SceneCore::put_wall(const WallDefinition& wall)
{
    if (discs.free_walls.empty()) {
        discs.walls.push_back({discs.walls[0].generation, 0});
        discs.free_walls.push_back(static_cast<std::uint32_t>(discs.walls.size() - 1));
    }
    const std::uint32_t slot = discs.free_walls.back();
    discs.free_walls.pop_back();
    discs.walls[slot].live = 1;
    const BodyId body = wall.body == BodyId{} ? ground : wall.body;
    const std::size_t count = wall.points.size() - (wall.closed ? 0 : 1);
    for (std::size_t i = 0; i < count; ++i)
        discs.segments.push_back({wall.points[i], wall.points[(i + 1) % wall.points.size()], body,
                                  wall.friction, wall.category, wall.mask, slot, wall.surface_speed,
                                  wall.max_force, wall.one_way ? 1U : 0U, static_cast<std::uint32_t>(i)});
    for (std::size_t i = discs.segments.size() - count; i < discs.segments.size(); ++i)
        wake_near(discs.segments[i], touching_distance);
    discs.is_stale = true;
    shapes.version.reset();
    return {slot, discs.walls[slot].generation};
}

void Scene::remove_wall(WallId wall)
{
    if (!is_alive(wall))
        refuse("remove_wall.wall", "slot " + std::to_string(wall.slot) + ", not alive",
               "a wall of this scene");
    make_room_for(core_->discs.free_walls, 1);
    for (const WallSegment& segment : core_->discs.segments) {
        if (segment.wall == wall.slot) core_->wake_near(segment, touching_distance);
    }
    core_->discs.remove_wall(wall.slot);
    core_->shapes.version.reset();
}

bool Scene::is_alive(WallId wall) const
{
    return core_->discs.is_alive(wall);
}

void SceneCore::remove_discs_of(std::span<const BodyId> removed)
{
    for (const BodyId body : removed) {
        wake_near_walls_of(body);
        if (has_disc(body)) {
            discs.set_shape(body.slot, {});
            shapes.version.reset();
        }
        forget_discs_of(body);
        const BodyRow where = bodies.row_of(body);
        if (where.kind() == BodyKind::planar) discs.forget_removed_row(where.row());
        if (bodies.motion(body) == BodyMotion::dynamic_body) continue;
        for (std::size_t i = 0; i < discs.segments.size();) {
            if (discs.segments[i].body == body) {
                discs.remove_wall(discs.segments[i].wall);
                shapes.version.reset();
            } else {
                ++i;
            }
        }
    }
}

void SceneCore::forget_discs_of(BodyId moved)
{
    const BodyRow where = bodies.row_of(moved);
    if (where.kind() == BodyKind::planar) {
        discs.forget_row(where.row());
    } else if (where.kind() == BodyKind::fixed) {
        discs.is_stale = true;
    }
}

void SceneCore::renumber_rows()
{
    const BodyRows& planar = bodies.rows(BodyKind::planar);
    Array<std::uint32_t> rows(planar.size(), 0);
    const Array<std::uint32_t> slots = planar.slot;
    bodies.renumber();
    for (std::uint32_t row = 1; row < slots.size(); ++row) {
        if (slots[row] != 0) rows[row] = bodies.row_of(bodies.id_of_slot(slots[row])).row();
    }
    discs.renumber(rows);
}

void SceneCore::sort_disc_rows()
{
    discs.wants_sorting = false;
    discs.steps_since_sorting = 0;
    const std::uint32_t rows = bodies.rows(BodyKind::planar).size();
    discs.sorted_rows.assign(rows, 0);
    // Bodies that were added since the last search have no disc yet.
    grow_to(discs.anchors, rows);
    grow_to(discs.found_at, rows);
    std::uint32_t next = 1;
    for (std::uint32_t& row : discs.rows_by_place) {
        discs.sorted_rows[row] = next;
        row = next++;
    }
    for (std::uint32_t row = 1; row < rows; ++row) {
        if (discs.sorted_rows[row] == 0) discs.sorted_rows[row] = next++;
    }
    discs.renumber_contacts(discs.sorted_rows);
    bodies.permute_planar(discs.sorted_rows, [&](std::uint32_t i, std::uint32_t j) {
        std::swap(discs.anchors[i], discs.anchors[j]);
        std::swap(discs.found_at[i], discs.found_at[j]);
    });
    // Blocks of joints refer to rows. (The null handle has a slot, too.)
    const Array<std::uint32_t>& slots = bodies.rows(BodyKind::planar).slot;
    const bool has_joints = joints->slots.size() > joints->free_slots.size() + 1;
    if (has_joints && std::any_of(slots.begin(), slots.end(),
                                  [&](std::uint32_t slot) { return bodies.first_ends[slot] != 0; }))
        joints->change_altogether();
}

namespace {

DiscContact contact_of(const SceneCore& scene, const DiscImpulse& impulse)
{
    DiscContact contact;
    contact.a = scene.bodies.id_of_slot(impulse.slot_a);
    contact.b = scene.bodies.id_of_slot(impulse.slot_b);
    if (impulse.segment != UINT32_MAX) contact.wall = scene.discs.wall_of(impulse.segment);
    contact.normal = impulse.normal;
    contact.separation = impulse.separation;
    const double per_second = scene.last_step > 0 ? 1 / static_cast<double>(scene.last_step) : 0;
    contact.normal_force = static_cast<float>(per_second * impulse.along);
    contact.friction_force = static_cast<float>(per_second * impulse.across);
    return contact;
}

}  // namespace

std::vector<DiscContact> Scene::disc_contacts() const
{
    std::vector<DiscContact> contacts;
    core_->for_each_disc_impulse(
        [&](const DiscImpulse& impulse) { contacts.push_back(contact_of(*core_, impulse)); });
    return contacts;
}

std::vector<DiscContact> Scene::disc_contacts_of(BodyId body) const
{
    core_->check_has_disc(body, "disc_contacts_of.body");
    std::vector<DiscContact> contacts;
    core_->for_each_disc_impulse([&](const DiscImpulse& impulse) {
        if (impulse.slot_a == body.slot || impulse.slot_b == body.slot)
            contacts.push_back(contact_of(*core_, impulse));
    });
    return contacts;
}

}  // namespace motley
