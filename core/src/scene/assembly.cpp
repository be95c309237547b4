// Copies of a figure.
#include "motley/core/assembly.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "motley/core/invalid_input.h"
#include "motley/core/six_dof.h"
#include "scene/scene_core.h"
#include "stores/array.h"
#include "stores/growth.h"
#include "stores/joint_store.h"

namespace motley {
namespace {

Quat<double> checked_orientation(const Placing& placing, std::span<const BodyDefinition> bodies)
{
    const Quat<double>& q = placing.orientation;
    const double length = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
    if (!(length > 0) || !std::isfinite(length))
        refuse("Placing.orientation", length, "a finite quaternion of a length above 0");
    const bool tilts = q.x != 0 || q.y != 0;
    for (const BodyDefinition& body : bodies) {
        if (tilts && body.model == BodyModel::planar)
            refuse("Placing.orientation", "tilted", "a turn about z, for a figure with planar bodies");
    }
    return {q.x / length, q.y / length, q.z / length, q.w / length};
}

BodyDefinition placed(BodyDefinition body, const Placing& placing, const Quat<double>& turn)
{
    const Quat<float> narrow = convert<float>(turn);
    body.position = placing.position + rotate(turn, body.position);
    body.linear_velocity = rotate(narrow, body.linear_velocity);
    if (body.motion != BodyMotion::static_body)
        body.linear_velocity = body.linear_velocity + placing.linear_velocity;
    if (body.model == BodyModel::planar) {
        body.yaw += 2 * std::atan2(turn.z, turn.w);
    } else {
        body.orientation = turn * body.orientation;
        body.angular_velocity = rotate(narrow, body.angular_velocity);
    }
    return body;
}

/// Adds the capsules of a copy. What was a group of the figure becomes one of this copy alone.
void put_in_own_groups(SceneCore& scene, std::span<Capsule> capsules)
{
    Array<std::uint32_t> groups;
    scene.make_room_for_shapes(capsules.size(), 0);
    for (Capsule& capsule : capsules) {
        if (capsule.group != 0) {
            const auto known = std::find(groups.begin(), groups.end(), capsule.group);
            const auto which = static_cast<std::uint32_t>(known - groups.begin());
            if (known == groups.end()) groups.push_back(capsule.group);
            capsule.group = scene.shapes.next_group + which;
        }
        scene.shapes.put(capsule);
    }
    scene.shapes.next_group += static_cast<std::uint32_t>(groups.size());
}

}  // namespace

BodyId Figure::add_body(const BodyDefinition& definition)
{
    make_room_for(bodies_, 1);
    const BodyId id = sketch_.add_body(definition);
    bodies_.push_back(definition);
    return id;
}

void Figure::add_six_dof(const SixDofDefinition& definition)
{
    refuse_ground(definition.body_a);
    refuse_ground(definition.body_b);
    // In a copy, because a refusal removes joints, and nothing is ever removed from the sketch: see join().
    Scene with_joint = sketch_;
    motley::add_six_dof(with_joint, definition);
    sketch_ = std::move(with_joint);
}

void Figure::add_capsule(const CapsuleDefinition& capsule)
{
    if (capsule.body == BodyId{} || is_ground(capsule.body))
        refuse("CapsuleDefinition.body", "the ground", "a body of the figure; a static one for the world");
    sketch_.add_capsule(capsule);
}

/// Of any scene: all have it in the same slot, and a host can only name that of another one.
bool Figure::is_ground(BodyId body) const
{
    return body.slot == sketch_.ground().slot;
}

void Figure::refuse_ground(BodyId body) const
{
    if (is_ground(body))
        refuse("joint.body_a or body_b", "the ground", "bodies of the figure; a static one for the world");
}

void Figure::join(Scene& scene, std::span<const BodyId> bodies) const
{
    // Nothing is ever removed from the sketch: the slots of its bodies follow that of its ground, and those of its
    // joints each other, in the order in which they were added.
    const auto of_scene = [&](BodyId body) { return bodies[body.slot - sketch_.ground().slot - 1]; };
    const JointStores& joints = *core_of(sketch_).joints;
    for (const JointStores::Slot& slot : joints.slots) {
        if (slot.live == 0) continue;
        joints.for_each([&](const auto& store, int type) {
            if (type != slot.type) return;
            auto definition = store.definitions[slot.index];
            definition.body_a = of_scene(definition.body_a);
            definition.body_b = of_scene(definition.body_b);
            scene.add_joint(definition);
        });
    }
    Array<Capsule> capsules = core_of(sketch_).shapes.capsules;
    for (Capsule& capsule : capsules) capsule.body = of_scene(capsule.body);
    put_in_own_groups(core_of(scene), capsules);
}

std::vector<BodyId> add_assembly(Scene& scene, const Figure& figure, std::span<const Placing> copies)
{
    std::vector<BodyDefinition> definitions;
    definitions.reserve(copies.size() * figure.bodies().size());
    for (const Placing& placing : copies) {
        const Quat<double> turn = checked_orientation(placing, figure.bodies());
        for (const BodyDefinition& body : figure.bodies()) definitions.push_back(placed(body, placing, turn));
    }
    std::vector<BodyId> ids(definitions.size());
    scene.add_bodies(definitions, ids);
    for (std::size_t copy = 0; copy < copies.size(); ++copy)
        figure.join(scene, std::span(ids).subspan(copy * figure.bodies().size(), figure.bodies().size()));
    return ids;
}

}  // namespace motley
