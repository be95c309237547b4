// Adding and removing bodies. Nothing is changed before everything is checked.
#include "scene/scene_core.h"

#include <atomic>

#include "motley/core/invalid_input.h"
#include "scene/body_checks.h"
#include "stores/generations.h"
#include "stores/growth.h"
#include "stores/joint_store.h"

namespace motley {

template class Boxed<SceneCore>;

namespace {

std::atomic<std::uint32_t> scenes_made{0};  // in this process: see first_generation()

}  // namespace

Scene::Scene()
{
    core_->begin_generations(first_generation(scenes_made.fetch_add(1, std::memory_order_relaxed)));
    BodyDefinition world;
    world.motion = BodyMotion::static_body;
    core_->ground = core_->bodies.add(world);
}

BodyId Scene::add_body(const BodyDefinition& definition)
{
    BodyId id;
    add_bodies({&definition, 1}, {&id, 1});
    return id;
}

void Scene::add_bodies(std::span<const BodyDefinition> definitions, std::span<BodyId> ids)
{
    if (ids.size() != definitions.size()) {
        refuse("add_bodies.ids.size()", static_cast<double>(ids.size()), "the size of definitions");
    }
    for (const BodyDefinition& definition : definitions) check_definition(definition);
    core_->bodies.make_room(definitions);
    for (std::size_t i = 0; i < definitions.size(); ++i) ids[i] = core_->bodies.add(definitions[i]);
    core_->body_count += definitions.size();
}

void Scene::remove_body(BodyId body)
{
    remove_bodies({&body, 1});
}

void Scene::remove_bodies(std::span<const BodyId> bodies)
{
    core_->require_alive(bodies, "remove_bodies.bodies");
    for (const BodyId body : bodies) {
        if (body == core_->ground) refuse("remove_bodies.bodies", "the ground", "a body that the host added");
    }
    // `contained` also holds a mark for bodies that were seen, which is removed before this call returns.
    constexpr std::uint8_t mark = 0x80;
    bool twice = false;
    for (const BodyId body : bodies) {
        twice = twice || (core_->bodies.contained[body.slot] & mark) != 0;
        core_->bodies.contained[body.slot] |= mark;
    }
    for (const BodyId body : bodies) core_->bodies.contained[body.slot] &= static_cast<std::uint8_t>(~mark);
    if (twice) refuse("remove_bodies.bodies", "a list with a body named twice", "each body once");

    core_->bodies.make_room_to_remove(bodies);
    make_room_for(core_->discs.free_walls, core_->discs.walls.size());
    make_room_for(core_->shapes.free_slots, core_->shapes.slots.size());
    for (const BodyId body : bodies) core_->wake_island(body.slot);
    core_->remove_joints_of(bodies);
    core_->remove_discs_of(bodies);
    for (const BodyId body : bodies) {
        core_->bodies.remove(body);
        if (body.slot < core_->user_data.size()) core_->user_data[body.slot] = 0;
    }
    core_->shapes.remove_if([&](BodyId body) { return !is_alive(body); });
    std::erase_if(core_->island_iterations,
                  [&](const IslandIterations& asked) { return !is_alive(asked.body); });
    core_->body_count -= bodies.size();
}

void Scene::renumber_bodies()
{
    core_->renumber_rows();
    core_->joints->change_altogether();  // blocks refer to rows
}

void SceneCore::begin_generations(std::uint32_t first)
{
    bodies.begin_generations(first);
    joints->slots[0].generation = first;
    discs.walls[0].generation = first;
    shapes.slots[0].generation = first;
}

bool Scene::is_alive(BodyId body) const
{
    return core_->bodies.is_alive(body);
}

void SceneCore::refuse_dead(BodyId body, const char* what)
{
    const std::string value = body == BodyId{} ? std::string("the null handle")
                                               : "slot " + std::to_string(body.slot) + ", not alive";
    refuse(what, value, "a body of this scene");
}

void SceneCore::require_alive(std::span<const BodyId> named, const char* what) const
{
    for (const BodyId body : named) require_alive(body, what);
}

BodyModel Scene::model(BodyId body) const
{
    core_->require_alive(body, "model.body");
    return core_->bodies.model(body);
}

BodyMotion Scene::motion(BodyId body) const
{
    core_->require_alive(body, "motion.body");
    return core_->bodies.motion(body);
}

BodyId Scene::ground() const
{
    return core_->ground;
}
std::size_t Scene::body_count() const
{
    return core_->body_count;
}
BodyState Scene::state(BodyId body) const
{
    return core_->state(body);
}
bool Scene::is_alive(ConstraintId joint) const
{
    return core_->is_alive(joint);
}
JointReport Scene::joint_report(ConstraintId joint) const
{
    return core_->joint_report(joint);
}
std::span<const BreakEvent> Scene::break_events() const
{
    return core_->break_events;
}
std::span<const ContactImpulse> Scene::contact_impulses() const
{
    return core_->contacts.step_impulses().first(core_->listed_contacts());
}
std::span<const ContactImpulse> Scene::last_substep_impulses() const
{
    return core_->contacts.impulses().first(core_->listed_contacts());
}
float Scene::last_step() const
{
    return core_->last_step;
}
float Scene::last_substep() const
{
    return core_->last_substep;
}

}  // namespace motley
