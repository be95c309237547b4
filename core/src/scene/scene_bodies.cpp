// What a host keeps and changes of the bodies themselves: their list, its own number of each, their masses and models.
#include "scene/scene_core.h"

#include <string>

#include "contract/built.h"
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
    if (core_->bodies.first_ends[body.slot] != 0) core_->joints->change_altogether();
}

void Scene::set_damping(BodyId body, float linear, float angular)
{
    core_->require_alive(body, "set_damping.body");
    if (core_->bodies.motion(body) != BodyMotion::dynamic_body)
        refuse("set_damping.body", "a static or kinematic body", "a dynamic body");
    check_damping("set_damping", linear, angular);
    core_->wake_island(body.slot);
    core_->bodies.set_damping(body.slot, {linear, angular});
}

void SceneCore::check_change(BodyId body, const BodyChange& change) const
{
    require_alive(body, "change_body.body");
    if (bodies.motion(body) != BodyMotion::dynamic_body)
        refuse("change_body.body", "a static or kinematic body", "a dynamic body");
    if (bodies.contained[body.slot] != 0)
        refuse("change_body.body", "a contained body", "one that moves: revive() comes first");
    check_model("BodyChange.model", change.model);
    check_model_is_built("BodyChange.model", change.model);
    if (has_disc(body) && change.model != BodyModel::planar)
        refuse("BodyChange.model", change.model == BodyModel::rigid ? "rigid" : "particle",
               "planar for a body with a disc: clear_disc() comes first");
    check_inertia_of("BodyChange", change.model, change.inertia);
    check_joints_after(body, change.model);
    for (const Capsule& capsule : shapes.capsules) {
        if (capsule.body == body) check_capsule_on(change.model, capsule.from, capsule.to);
    }
    const Vec3<double> turns = bodies.angular_velocity_after(body, change);
    for (const double component : {turns.x, turns.y, turns.z})
        check("BodyChange.inertia's angular velocity, which keeps the angular momentum,", component,
              -largest_speed, largest_speed, "-1e9 to 1e9 (rad/s)");
}

void Scene::change_body(BodyId body, const BodyChange& change)
{
    core_->check_change(body, change);
    core_->bodies.make_room_to_change(body, change.model);
    core_->wake_island(body.slot);
    const BodyRow from = core_->bodies.row_of(body);
    core_->bodies.change(body, change);
    // As of a removed body: contacts of discs in blocks must not be taken for those of the next body in the row.
    if (from.kind() == BodyKind::planar && change.model != BodyModel::planar)
        core_->discs.forget_removed_row(from.row());
    if (core_->has_disc(body)) core_->discs.is_stale = true;  // as in set_mass
    // What is met as seen from above may be met in space now.
    if (core_->shapes.has_capsule(body)) core_->shapes.version.reset();
    // Blocks of joints refer to rows and are for pairs of kinds.
    if (core_->bodies.first_ends[body.slot] != 0) core_->joints->change_altogether();
}

}  // namespace motley
