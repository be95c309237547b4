// Converts a scene to a world of the reference, and back.
#include "motley/reference/scene_step.h"

#include <algorithm>
#include <cmath>

#include "as_eigen.h"
#include "disc_points.h"
#include "motley/reference/joint_models.h"
#include "motley/reference/world.h"
#include "stores/joint_store.h"

namespace motley::reference {
namespace {

Body body_of(const SceneCore& scene, BodyId id)
{
    const BodyState state = scene.state(id);
    const BodyStore& store = scene.bodies;
    const BodyRow where = store.row_of(id);
    BodyDefinition definition;
    definition.model = store.model(id);
    // A contained body cannot be moved until the host revives it.
    definition.motion = store.contained[id.slot] != 0 ? BodyMotion::static_body : store.motion(id);
    definition.position = state.position;
    definition.orientation = state.orientation;
    definition.yaw = state.yaw;
    definition.linear_velocity = state.linear_velocity;
    definition.angular_velocity = state.angular_velocity;
    definition.linear_damping = store.dampings[id.slot].linear;
    definition.angular_damping = store.dampings[id.slot].angular;
    const BodyRows& rows = store.rows(where.kind());
    if (where.kind() == BodyKind::rigid) definition.inertia = rows.inertia[where.row()];
    Body body = Body::from(definition);
    if (where.kind() == BodyKind::fixed) return body;
    body.mass = 1 / static_cast<double>(store.inverse_masses[id.slot]);
    const float* acceleration =
        &rows.acceleration[static_cast<std::size_t>(4 * quads_of(where.kind())) * where.row()];
    for (int i = 0; i < 3; ++i) body.force(i) = body.mass * static_cast<double>(acceleration[i]);
    if (where.kind() == BodyKind::planar) {
        const double inertia = 1 / static_cast<double>(store.inverse_inertias[id.slot]);
        body.inertia(2, 2) = inertia;
        body.force(2) = 0;
        body.force(5) = inertia * static_cast<double>(acceleration[2]);
    }
    if (where.kind() == BodyKind::rigid) {
        for (int i = 0; i < 3; ++i) body.force(3 + i) = static_cast<double>(acceleration[4 + i]);
    }
    return body;
}

/// Writes velocities in any case, poses only where they are finite.
void write_back(SceneCore& scene, BodyId id, const Body& body)
{
    BodyStore& store = scene.bodies;
    const BodyRow where = store.row_of(id);
    if (store.contained[id.slot] != 0) return;
    BodyRows& rows = store.rows(where.kind());
    float* velocity = &rows.velocity[static_cast<std::size_t>(4 * quads_of(where.kind())) * where.row()];
    if (where.kind() != BodyKind::fixed) {
        for (int i = 0; i < 3; ++i) velocity[i] = static_cast<float>(body.velocity(i));
        if (where.kind() == BodyKind::planar) velocity[2] = static_cast<float>(body.velocity(5));
        for (int i = 0; where.kind() == BodyKind::rigid && i < 3; ++i)
            velocity[4 + i] = static_cast<float>(body.velocity(3 + i));
    }
    if (!body.position.allFinite() || !body.orientation.coeffs().allFinite()) {
        velocity[0] = std::numeric_limits<float>::quiet_NaN();
        return;
    }
    BodyPose& pose = rows.pose[where.row()];
    const Eigen::Quaterniond& q = body.orientation;
    pose.position = convert<PoseReal>(Vec3<double>{body.position.x(), body.position.y(), body.position.z()});
    if (where.kind() == BodyKind::planar)
        pose.yaw += static_cast<PoseReal>(
            std::remainder(2 * std::atan2(q.z(), q.w()) - static_cast<double>(pose.yaw), 2 * EIGEN_PI));
    if (quads_of(where.kind()) == 2)
        rows.orientation[where.row()] = convert<PoseReal>(Quat<double>{q.x(), q.y(), q.z(), q.w()});
}

}  // namespace

DirectResult step_directly(SceneCore& scene, float dt, const SolverSettings& settings,
                           std::span<const Contact> contacts, std::span<const ContactSurface<float>> surfaces)
{
    World world;
    std::vector<int> index_of_slot(scene.bodies.slot_count(), -1);
    std::vector<BodyId> ids;
    for (std::uint32_t slot = 1; slot < scene.bodies.slot_count(); ++slot) {
        if (!scene.bodies.is_slot_live(slot)) continue;
        index_of_slot[slot] = static_cast<int>(ids.size());
        ids.push_back(scene.bodies.id_of_slot(slot));
        world.bodies.push_back(body_of(scene, ids.back()));
    }
    const BodyStore& bodies = scene.bodies;
    const auto is_left_out = [&](BodyId a, BodyId b) {
        return bodies.is_contained(bodies.row_of(a)) || bodies.is_contained(bodies.row_of(b));
    };
    scene.joints->for_each([&](const auto& store, int) {
        using Store = std::remove_cvref_t<decltype(store)>;
        for (std::size_t i = 0; i < store.size(); ++i) {
            const auto& definition = store.definitions[i];
            if (is_left_out(definition.body_a, definition.body_b)) continue;
            Joint joint{index_of_slot[definition.body_a.slot], index_of_slot[definition.body_b.slot],
                        model_of(definition)};
            constexpr std::size_t stride = quad_floats<typename Store::Memory>;
            joint.memory = {&store.memory[i * stride], stride};
            joint.travelled = joint.model->travelled_in(joint.memory.data());
            joint.rotor_lag = joint.model->rotor_lag_in(joint.memory.data());
            joint.rotor_change = joint.model->rotor_change_in(joint.memory.data());
            world.joints.push_back(std::move(joint));
        }
    });
    std::vector<ContactPoint> points;
    for (std::size_t i = 0; i < contacts.size(); ++i) {
        const Contact& contact = contacts[i];
        if (scene.contacts.staged().colours[i] == no_colour) continue;  // left out by the layout
        ContactPoint point{index_of_slot[contact.body_a.slot], index_of_slot[contact.body_b.slot], contact};
        if (i >= contacts.size() - surfaces.size()) {
            const ContactSurface<float>& surface = surfaces[i - (contacts.size() - surfaces.size())];
            point.surface = {convert<double>(surface.velocity), static_cast<double>(surface.most_force)};
        }
        points.push_back(point);
    }

    const ContactList& before = scene.contacts.current();
    World::ContactResults recalled;
    for (std::size_t i = 0; i < before.count; ++i) {
        const ContactImpulse& impulse = before.impulses[i + 1];
        recalled[before.entries[i].key] = {
            static_cast<double>(impulse.normal),
            {static_cast<double>(impulse.friction.x), static_cast<double>(impulse.friction.y),
             static_cast<double>(impulse.friction.z)}};
    }
    DiscPoints discs;
    discs.list(scene, index_of_slot, points, recalled);
    world.recall(static_cast<double>(scene.last_substep), std::move(recalled));

    const DirectResult result = world.step_directly(static_cast<double>(dt), settings, points);

    // Everything that allocates comes before anything is written.
    std::vector<std::vector<double>> memories;
    for (const Joint& joint : world.joints) memories.push_back(joint.model->memory(joint));

    for (std::size_t i = 0; i < ids.size(); ++i) write_back(scene, ids[i], world.bodies[i]);
    auto next = memories.begin();
    auto joint = world.joints.begin();
    scene.joints->for_each([&](auto& store, int) {
        using Store = std::remove_cvref_t<decltype(store)>;
        constexpr std::size_t stride = quad_floats<typename Store::Memory>;
        for (std::size_t i = 0; i < store.size(); ++i) {
            if (is_left_out(store.definitions[i].body_a, store.definitions[i].body_b)) {
                store.forget_impulse(i);
                continue;
            }
            const std::vector<double>& memory = *next++;
            for (std::size_t k = 0; k < std::min(memory.size(), stride); ++k)
                store.memory[i * stride + k] = narrow(memory[k]);
            float* wrench = &store.wrenches[i * Store::wrench_floats];
            for (const double part : (joint++)->wrench) *wrench++ = narrow(part);
        }
    });
    ContactList& staged = scene.contacts.staged();
    const auto result_of = [&](const World::ContactResults& results, std::uint64_t key) -> ContactImpulse {
        const auto found = results.find(key);
        if (found == results.end()) return {};
        const auto& [normal, friction] = found->second;
        return {narrow(normal), {narrow(friction.x()), narrow(friction.y()), narrow(friction.z())}};
    };
    for (std::size_t i = 0; i < contacts.size(); ++i) {
        staged.impulses[i + 1] = result_of(world.last_substep_results(), contacts[i].key);
        staged.step_impulses[i] = result_of(world.step_results(), contacts[i].key);
    }
    discs.store(world, scene.discs);
    return result;
}

}  // namespace motley::reference
