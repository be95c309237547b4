// What a host keeps and changes of the bodies themselves: their list, its own number of each, their masses.
#include "scene/scene_core.h"

#include "motley/core/invalid_input.h"
#include "scene/body_checks.h"
#include "stores/joint_store.h"

namespace motley {

void Scene::read_bodies(std::vector<BodyId>& bodies) const
{
    const BodyStore& store = core_->bodies;
    bodies.reserve(core_->body_count);
    bodies.clear();
    for (std::uint32_t slot = 1; slot < store.slot_count(); ++slot) {
        if (store.is_slot_live(slot) && slot != core_->ground.slot) bodies.push_back(store.id_of_slot(slot));
    }
}

void Scene::set_user_data(BodyId body, std::uint64_t value)
{
    core_->require_alive(body, "set_user_data.body");
    // The first value makes room for all bodies.
    if (body.slot >= core_->user_data.size()) core_->user_data.resize(core_->bodies.slot_count());
    core_->user_data[body.slot] = value;
}

std::uint64_t Scene::user_data(BodyId body) const
{
    core_->require_alive(body, "user_data.body");
    return body.slot < core_->user_data.size() ? core_->user_data[body.slot] : 0;
}

void Scene::set_mass(BodyId body, float mass, const Sym3<float>& inertia)
{
    core_->require_alive(body, "set_mass.body");
    if (core_->bodies.motion(body) != BodyMotion::dynamic_body)
        refuse("set_mass.body", "a static or kinematic body", "a dynamic body");
    check_mass("set_mass", core_->bodies.model(body), mass, inertia);
    core_->wake_island(body.slot);
    core_->bodies.set_mass(body, mass, inertia);
    // Contacts of discs keep their effective mass from search to search.
    if (core_->has_disc(body)) core_->discs.is_stale = true;
    // Which joints are solved at once depends on the ratio of the masses that they connect.
    if (core_->bodies.first_ends[body.slot] != 0) core_->joints->version.reset();
}

}  // namespace motley
