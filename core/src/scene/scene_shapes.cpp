// Capsules and half-spaces as the host sets and reads them. Nothing is changed before everything is checked.
#include <cmath>
#include <string>

#include "motley/core/invalid_input.h"
#include "scene/body_checks.h"
#include "scene/joint_checks.h"
#include "scene/scene_core.h"
#include "stores/growth.h"

namespace motley {
namespace {

void check_surface(const char* who, float friction, float restitution)
{
    check_range({who, ".friction"}, friction, 0, 1e9F, "a finite value from 0 to 1e9");
    check_range({who, ".restitution"}, restitution, 0, 1, "0 to 1");
}

void check_end(const char* name, const Vec3<float>& end, BodyModel model)
{
    check_vector(name, end, 1e6F, "a finite value from -1e6 to 1e6 (m)");
    if (model == BodyModel::particle) check_vector(name, end, 0, "0 of a particle (m)");
    if (model == BodyModel::planar) check_range({name, ".z"}, end.z, 0, 0, "0 of a planar body (m)");
}

}  // namespace

void SceneCore::check_capsule(const CapsuleDefinition& capsule) const
{
    const BodyId body = capsule.body == BodyId{} ? ground : capsule.body;
    require_alive(body, "CapsuleDefinition.body");
    // Bodies that cannot be pushed have orientations, whatever their model.
    const BodyModel model =
        bodies.motion(body) == BodyMotion::dynamic_body ? bodies.model(body) : BodyModel::rigid;
    check_capsule_on(model, capsule.from, capsule.to);
    check("CapsuleDefinition.radius", capsule.radius, 1e-6, 1e6, "1e-6 to 1e6 (m)");
    check_surface("CapsuleDefinition", capsule.friction, capsule.restitution);
}

void SceneCore::check_capsule_on(BodyModel model, const Vec3<float>& from, const Vec3<float>& to)
{
    check_end("CapsuleDefinition.from", from, model);
    check_end("CapsuleDefinition.to", to, model);
}

void SceneCore::check_half_space(const HalfSpaceDefinition& half_space) const
{
    const BodyId body = half_space.body == BodyId{} ? ground : half_space.body;
    require_alive(body, "HalfSpaceDefinition.body");
    if (bodies.motion(body) == BodyMotion::dynamic_body)
        refuse("HalfSpaceDefinition.body", "a dynamic body", "a static or kinematic body");
    check_position("HalfSpaceDefinition.point", half_space.point);
    const Vec3<double> normal = convert<double>(half_space.normal);
    check("HalfSpaceDefinition.normal", std::sqrt(dot(normal, normal)), 1e-6, 1e6,
          "a length from 1e-6 to 1e6 (length shown)");
    check_surface("HalfSpaceDefinition", half_space.friction, half_space.restitution);
}

void SceneCore::make_room_for_shapes(std::size_t capsules, std::size_t half_spaces)
{
    const std::size_t slots = shapes.slots.size() + capsules + half_spaces;
    if (slots > ShapeStore::most_slots)
        refuse("shapes of a scene", static_cast<double>(slots), "at most 2^28");
    shapes.make_room(capsules, half_spaces);
}

ShapeId SceneCore::put_capsule(const CapsuleDefinition& capsule)
{
    Capsule own;
    own.from = capsule.from;
    own.to = capsule.to;
    own.radius = capsule.radius;
    own.surface = {capsule.friction, capsule.restitution, capsule.category, capsule.mask};
    own.group = capsule.group;
    own.body = capsule.body == BodyId{} ? ground : capsule.body;
    return shapes.put(own);
}

ShapeId Scene::add_capsule(const CapsuleDefinition& capsule)
{
    ShapeId id;
    add_capsules({&capsule, 1}, {&id, 1});
    return id;
}

void Scene::add_capsules(std::span<const CapsuleDefinition> capsules, std::span<ShapeId> ids)
{
    if (ids.size() != capsules.size())
        refuse("add_capsules.ids.size()", static_cast<double>(ids.size()), "the size of capsules");
    for (const CapsuleDefinition& capsule : capsules) {
        core_->check_capsule(capsule);
        check("CapsuleDefinition.group", capsule.group, 0, ShapeStore::first_given_group - 1,
              "0 to 2^31 - 1");
    }
    core_->make_room_for_shapes(capsules.size(), 0);
    for (std::size_t i = 0; i < capsules.size(); ++i) ids[i] = core_->put_capsule(capsules[i]);
}

ShapeId Scene::add_half_space(const HalfSpaceDefinition& half_space)
{
    core_->check_half_space(half_space);
    core_->make_room_for_shapes(0, 1);
    HalfSpace own;
    own.point = half_space.point;
    const Vec3<double> normal = convert<double>(half_space.normal);
    own.normal = convert<float>((1 / std::sqrt(dot(normal, normal))) * normal);
    own.surface = {half_space.friction, half_space.restitution, half_space.category, half_space.mask};
    own.body = half_space.body == BodyId{} ? core_->ground : half_space.body;
    return core_->shapes.put(own);
}

void Scene::remove_shape(ShapeId shape)
{
    if (!is_alive(shape))
        refuse("remove_shape.shape", "slot " + std::to_string(shape.slot) + ", not alive",
               "a shape of this scene");
    make_room_for(core_->shapes.free_slots, 1);
    core_->shapes.remove(shape.slot);
}

bool Scene::is_alive(ShapeId shape) const
{
    return core_->shapes.is_alive(shape);
}

std::span<const ContactImpulse> SceneCore::shape_impulses() const
{
    return contacts.step_impulses().subspan(listed_contacts());
}

namespace {

template <class Wanted>
std::vector<ShapeContact> contacts_of(const SceneCore& scene, const Wanted& wanted)
{
    std::vector<ShapeContact> found;
    scene.for_each_shape_impulse([&](const Contact& contact, const ContactImpulse& impulse, WallId wall) {
        if (!wanted(contact)) return;
        const Vec3<float> push = scene.force_of(impulse.normal * contact.normal);
        found.push_back({contact.body_a, contact.body_b, wall, contact.normal, contact.arm_b,
                         contact.separation, dot(push, contact.normal), scene.force_of(impulse.friction)});
    });
    return found;
}

}  // namespace

std::vector<ShapeContact> Scene::shape_contacts() const
{
    return contacts_of(*core_, [](const Contact&) { return true; });
}

std::vector<ShapeContact> Scene::shape_contacts_of(BodyId body) const
{
    core_->require_alive(body, "shape_contacts_of.body");
    return contacts_of(
        *core_, [body](const Contact& contact) { return contact.body_a == body || contact.body_b == body; });
}

}  // namespace motley
