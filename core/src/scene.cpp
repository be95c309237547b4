// Adding and removing bodies. Nothing is changed before everything is checked.
#include "motley/core/scene.h"

#include "motley/core/body_checks.h"
#include "motley/core/invalid_input.h"
#include "motley/core/joint_store.h"

namespace motley {

Scene::Scene()
{
    BodyDefinition world;
    world.motion = BodyMotion::static_body;
    ground_ = bodies_.add(world);
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
    bodies_.make_room(definitions);
    for (std::size_t i = 0; i < definitions.size(); ++i) ids[i] = bodies_.add(definitions[i]);
    body_count_ += definitions.size();
}

void Scene::remove_body(BodyId body)
{
    remove_bodies({&body, 1});
}

void Scene::remove_bodies(std::span<const BodyId> bodies)
{
    require_alive(bodies, "remove_bodies.bodies");
    for (const BodyId body : bodies) {
        if (body == ground_) refuse("remove_bodies.bodies", "the ground", "a body that the host added");
    }
    // `contained` also holds a mark for bodies that were seen, which is removed before this call returns.
    constexpr std::uint8_t mark = 0x80;
    bool twice = false;
    for (const BodyId body : bodies) {
        twice = twice || (bodies_.contained[body.slot] & mark) != 0;
        bodies_.contained[body.slot] |= mark;
    }
    for (const BodyId body : bodies) bodies_.contained[body.slot] &= static_cast<std::uint8_t>(~mark);
    if (twice) refuse("remove_bodies.bodies", "a list with a body named twice", "each body once");

    bodies_.make_room_to_remove(bodies);
    remove_joints_of(bodies);
    for (const BodyId body : bodies) bodies_.remove(body);
    std::erase_if(island_iterations_, [&](const IslandIterations& asked) { return !is_alive(asked.body); });
    body_count_ -= bodies.size();
}

void Scene::renumber_bodies()
{
    bodies_.renumber();
    joints_->version.reset();  // blocks refer to rows
}

bool Scene::is_alive(BodyId body) const
{
    return bodies_.is_alive(body);
}

void Scene::refuse_dead(BodyId body, const char* what)
{
    const std::string value = body == BodyId{} ? std::string("the null handle")
                                               : "slot " + std::to_string(body.slot) + " generation " +
                                                     std::to_string(body.generation) + ", not alive";
    refuse(what, value, "a body of this scene");
}

void Scene::require_alive(std::span<const BodyId> bodies, const char* what) const
{
    for (const BodyId body : bodies) require_alive(body, what);
}

BodyModel Scene::model(BodyId body) const
{
    require_alive(body, "model.body");
    return bodies_.model(body);
}

BodyMotion Scene::motion(BodyId body) const
{
    require_alive(body, "motion.body");
    return bodies_.motion(body);
}

}  // namespace motley
