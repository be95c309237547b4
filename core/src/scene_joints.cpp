// Joints that come and go, and what they and contacts did.
#include "motley/core/scene.h"

#include <cmath>

#include "motley/core/invalid_input.h"

namespace motley {

JointBodies Scene::check_joint_bodies(BodyId a, BodyId b) const
{
    require_alive(a, "joint.body_a");
    require_alive(b, "joint.body_b");
    if (a == b) refuse("joint.body_b", "the same body as body_a", "two different bodies");
    const bool fixed_a = bodies_.row_of(a).kind() == BodyKind::fixed;
    const bool fixed_b = bodies_.row_of(b).kind() == BodyKind::fixed;
    if (fixed_a && fixed_b)
        refuse("joint.body_b", "a second body that cannot move", "at least one dynamic body");
    return {bodies_.model(a), bodies_.model(b), fixed_a, fixed_b};
}

ConstraintId Scene::take_joint_slot(int type, std::size_t index)
{
    std::uint32_t slot;
    if (joints_.free_slots.empty()) {
        slot = static_cast<std::uint32_t>(joints_.slots.size());
        joints_.slots.emplace_back();
    } else {
        slot = joints_.free_slots.back();
        joints_.free_slots.pop_back();
    }
    JointStores::Slot& entry = joints_.slots[slot];
    if (++entry.generation == 0) entry.generation = 1;
    entry.index = static_cast<std::uint32_t>(index);
    entry.type = static_cast<std::uint8_t>(type);
    entry.live = true;
    entry.watched = false;
    entry.break_limit = {};
    entry.iterations = 0;
    return {slot, entry.generation};
}

std::size_t Scene::index_of_joint(ConstraintId joint, int type) const
{
    if (!is_alive(joint))
        refuse("joint", joint.generation == 0 ? "null" : "removed", "a joint of this scene");
    const JointStores::Slot& slot = joints_.slots[joint.slot];
    if (slot.type != type) refuse("set_joint.definition", "of another type", "the type of the joint");
    return slot.index;
}

bool Scene::is_alive(ConstraintId joint) const
{
    return joint.slot < joints_.slots.size() && joints_.slots[joint.slot].live &&
           joints_.slots[joint.slot].generation == joint.generation;
}

std::size_t Scene::joint_count() const
{
    std::size_t count = 0;
    joints_.for_each([&](const auto& store, int) { count += store.size(); });
    return count;
}

void Scene::remove_joint_at(int type, std::size_t index)
{
    joints_.for_each([&](auto& store, int t) {
        if (t != type) return;
        JointStores::Slot& entry = joints_.slots[store.slots[index]];
        entry.live = false;
        if (entry.iterations != 0) --joints_.with_iterations;
        joints_.free_slots.push_back(store.slots[index]);
        --bodies_.joint_counts[store.definitions[index].body_a.slot];
        --bodies_.joint_counts[store.definitions[index].body_b.slot];
        store.swap_remove(index);
        if (index < store.size()) joints_.slots[store.slots[index]].index = static_cast<std::uint32_t>(index);
    });
    joints_.version.reset();
}

void Scene::remove_joint(ConstraintId joint)
{
    if (!is_alive(joint)) {
        refuse("remove_joint.joint", "slot " + std::to_string(joint.slot) + ", not alive",
               "a joint of this scene");
    }
    remove_joint_at(joints_.slots[joint.slot].type, joints_.slots[joint.slot].index);
}

void Scene::remove_joints_of(std::span<const BodyId> bodies)
{
    bool any = false;
    for (const BodyId body : bodies) any = any || bodies_.joint_counts[body.slot] != 0;
    if (!any) return;
    std::vector<std::uint8_t> going(bodies_.slot_count(), 0);
    for (const BodyId body : bodies) going[body.slot] = 1;
    joints_.for_each([&](auto& store, int type) {
        for (std::size_t i = store.size(); i-- > 0;) {
            if (going[store.definitions[i].body_a.slot] || going[store.definitions[i].body_b.slot])
                remove_joint_at(type, i);
        }
    });
}

void Scene::set_break_limit(ConstraintId joint, const BreakLimit& limit)
{
    if (!is_alive(joint)) {
        refuse("set_break_limit.joint", "slot " + std::to_string(joint.slot) + ", not alive",
               "a joint of this scene");
    }
    if (!(limit.force > 0)) refuse("BreakLimit.force", limit.force, "> 0 (N), infinite for none");
    if (!(limit.torque > 0)) refuse("BreakLimit.torque", limit.torque, "> 0 (N m), infinite for none");
    JointStores::Slot& slot = joints_.slots[joint.slot];
    if (!slot.watched) joints_.watched.push_back(joint);
    slot.watched = true;
    slot.break_limit = limit;
}

void Scene::set_iterations(ConstraintId joint, int at_least)
{
    if (!is_alive(joint)) {
        refuse("set_iterations.joint", "slot " + std::to_string(joint.slot) + ", not alive",
               "a joint of this scene");
    }
    if (at_least < 0 || at_least > 10000) refuse("set_iterations.at_least", at_least, "0 to 10000");
    std::uint16_t& iterations = joints_.slots[joint.slot].iterations;
    joints_.with_iterations += (at_least != 0 ? 1U : 0U) - (iterations != 0 ? 1U : 0U);
    iterations = static_cast<std::uint16_t>(at_least);
}

void Scene::set_island_iterations(BodyId body, int at_least)
{
    require_alive(body, "set_island_iterations.body");
    if (bodies_.row_of(body).kind() == BodyKind::fixed)
        refuse("set_island_iterations.body", "a body that nothing moves", "a dynamic body");
    if (at_least < 0 || at_least > 10000) refuse("set_island_iterations.at_least", at_least, "0 to 10000");
    std::erase_if(island_iterations_, [&](const IslandIterations& asked) { return asked.body == body; });
    if (at_least > 0) island_iterations_.push_back({body, at_least});
}

void Scene::find_break_events()
{
    break_events_.clear();
    std::erase_if(joints_.watched, [&](ConstraintId joint) {
        if (!is_alive(joint)) return true;
        JointStores::Slot& slot = joints_.slots[joint.slot];
        slot.watched = !std::isinf(slot.break_limit.force) || !std::isinf(slot.break_limit.torque);
        return !slot.watched;
    });
    break_events_.reserve(joints_.watched.size());
    for (const ConstraintId joint : joints_.watched) {
        const BreakLimit& limit = joints_.slots[joint.slot].break_limit;
        const JointReport report = joint_report(joint);
        const float force = std::sqrt(dot(report.force, report.force));
        const float torque = std::sqrt(dot(report.torque, report.torque));
        if (force > limit.force || torque > limit.torque) break_events_.push_back({joint, force, torque});
    }
}

JointReport Scene::joint_report(ConstraintId joint) const
{
    if (!is_alive(joint)) {
        refuse("joint_report.joint", "slot " + std::to_string(joint.slot) + ", not alive",
               "a joint of this scene");
    }
    const JointStores::Slot& entry = joints_.slots[joint.slot];
    const double inverse_substep = last_substep > 0 ? 1 / static_cast<double>(last_substep) : 0;
    JointReport result;
    joints_.for_each([&](const auto& store, int type) {
        if (type != entry.type) return;
        using Type = typename std::remove_cvref_t<decltype(store)>::Type;
        const auto& definition = store.definitions[entry.index];
        result = Type::report(definition, store.memory_of(entry.index), state(definition.body_a),
                              state(definition.body_b), inverse_substep);
    });
    return result;
}

JointReport Scene::contact_report(std::span<const Contact> contacts, std::size_t index) const
{
    const ContactList& list = contacts_.current();
    if (index >= list.count || index >= contacts.size()) {
        refuse("contact_report.index", static_cast<double>(index),
               "below the length of the last step's list and of `contacts`");
    }
    const Contact& contact = contacts[index];
    if (list.entries[index].key != contact.key)
        refuse("contact_report.contacts", "another list", "the list of the last step");
    const ContactImpulse& impulse = contacts_.impulses()[index];
    JointReport report;
    if (last_substep > 0)
        report.force = (1 / last_substep) * (impulse.normal * contact.normal + impulse.friction);
    report.error = std::fmax(0.0F, -contact.separation);
    report.state = impulse.normal > 0 ? JointState::active : JointState::inactive;
    return report;
}

}  // namespace motley
