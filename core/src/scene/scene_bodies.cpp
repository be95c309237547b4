// What a host changes of the bodies themselves.
#include "scene/scene_core.h"

#include "motley/core/invalid_input.h"
#include "scene/body_checks.h"
#include "stores/joint_store.h"

namespace motley {

void Scene::set_mass(BodyId body, float mass, const Sym3<float>& inertia)
{
    core_->require_alive(body, "set_mass.body");
    if (core_->bodies.motion(body) != BodyMotion::dynamic_body)
        refuse("set_mass.body", "a static or kinematic body", "a dynamic body");
    check_mass("set_mass", core_->bodies.model(body), mass, inertia);
    core_->bodies.set_mass(body, mass, inertia);
    // Which joints are solved at once depends on the ratio of the masses that they connect.
    if (core_->bodies.first_ends[body.slot] != 0) core_->joints->version.reset();
}

}  // namespace motley
