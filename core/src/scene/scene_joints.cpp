// Adding, changing and removing joints, and reports on joints and contacts.
#include "scene/scene_core.h"
#include "stores/joint_store.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "contract/built.h"
#include "motley/core/invalid_input.h"
#include "stores/array.h"
#include "stores/generations.h"

namespace motley {

template class Boxed<JointStores>;

bool SceneCore::asks_for_iterations() const
{
    return joints->with_iterations > 0 || !island_iterations.empty();
}

JointBodies SceneCore::check_joint_bodies(BodyId a, BodyId b) const
{
    require_alive(a, "joint.body_a");
    require_alive(b, "joint.body_b");
    if (a == b) refuse("joint.body_b", "the same body as body_a", "two different bodies");
    const bool fixed_a = bodies.row_of(a).kind() == BodyKind::fixed;
    const bool fixed_b = bodies.row_of(b).kind() == BodyKind::fixed;
    if (fixed_a && fixed_b)
        refuse("joint.body_b", "a second body that cannot move", "at least one dynamic body");
    return {bodies.model(a), bodies.model(b), fixed_a, fixed_b};
}

void SceneCore::check_joints_after(BodyId body, BodyModel model) const
{
    joints->for_each_on(bodies.first_ends[body.slot], [&](const JointStores::Slot& joint) {
        joints->for_each([&](const auto& store, int type) {
            if (type != joint.type) return;
            using Type = typename std::remove_cvref_t<decltype(store)>::Type;
            const auto& definition = store.definitions[joint.index];
            JointBodies after = check_joint_bodies(definition.body_a, definition.body_b);
            (definition.body_a == body ? after.model_a : after.model_b) = model;
            try {
                Type::validate(definition, after);
            } catch (const InvalidInput& refusal) {
                throw InvalidInput("change_body.body has a joint, slot " +
                                   std::to_string(store.slots[joint.index]) + ": " + refusal.what());
            }
        });
    });
}

ConstraintId SceneCore::take_joint_slot(int type, std::size_t index)
{
    std::uint32_t slot;
    if (joints->free_slots.empty()) {
        slot = static_cast<std::uint32_t>(joints->slots.size());
        joints->slots.emplace_back().generation = joints->slots[0].generation;
        joints->ends.resize(2 * joints->slots.size());
    } else {
        slot = joints->free_slots.back();
        joints->free_slots.pop_back();
    }
    JointStores::Slot& entry = joints->slots[slot];
    entry.generation = next_generation(entry.generation);
    entry.index = static_cast<std::uint32_t>(index);
    entry.type = static_cast<std::uint8_t>(type);
    entry.live = 1;
    entry.watched = 0;
    entry.break_limit = {};
    entry.iterations = 0;
    entry.number = ++joints->added;
    return {slot, entry.generation};
}

std::size_t SceneCore::index_of_joint(ConstraintId joint, int type) const
{
    if (!is_alive(joint))
        refuse("joint", joint.generation == 0 ? "null" : "removed", "a joint of this scene");
    const JointStores::Slot& slot = joints->slots[joint.slot];
    if (slot.type != type) refuse("set_joint.definition", "of another type", "the type of the joint");
    return slot.index;
}

void SceneCore::require_alive(ConstraintId joint, const char* what) const
{
    if (!is_alive(joint))
        refuse(what, "slot " + std::to_string(joint.slot) + ", not alive", "a joint of this scene");
}

bool SceneCore::is_alive(ConstraintId joint) const
{
    return joint.slot < joints->slots.size() && joints->slots[joint.slot].live != 0 &&
           joints->slots[joint.slot].generation == joint.generation;
}

std::size_t Scene::joint_count() const
{
    std::size_t count = 0;
    core_->joints->for_each([&](const auto& store, int) { count += store.size(); });
    return count;
}

void SceneCore::remove_joint_at(int type, std::size_t index)
{
    joints->for_each([&](auto& store, int t) {
        if (t != type) return;
        wake_island(store.definitions[index].body_a.slot);
        wake_island(store.definitions[index].body_b.slot);
        JointStores::Slot& entry = joints->slots[store.slots[index]];
        entry.live = 0;
        if (entry.iterations != 0) --joints->with_iterations;
        const std::uint32_t slot = store.slots[index];
        joints->free_slots.push_back(slot);
        joints->unlink(2 * slot, bodies.first_ends[store.definitions[index].body_a.slot]);
        joints->unlink(2 * slot + 1, bodies.first_ends[store.definitions[index].body_b.slot]);
        store.swap_remove(index);
        joints->change(slot);
        if (index == store.size()) return;
        joints->slots[store.slots[index]].index = static_cast<std::uint32_t>(index);
        joints->change(store.slots[index]);
    });
}

void Scene::remove_joint(ConstraintId joint)
{
    core_->require_alive(joint, "remove_joint.joint");
    core_->remove_joint_at(core_->joints->slots[joint.slot].type, core_->joints->slots[joint.slot].index);
}

void SceneCore::remove_joints_of(std::span<const BodyId> removed)
{
    Array<std::pair<int, std::uint32_t>> going;  // type and index
    for (const BodyId body : removed) {
        joints->for_each_on(bodies.first_ends[body.slot], [&](const JointStores::Slot& joint) {
            going.emplace_back(joint.type, joint.index);
        });
    }
    // Within a type the last one first, because each removal moves the last joint into the gap.
    std::sort(going.begin(), going.end(), [](const auto& x, const auto& y) {
        return x.first != y.first ? x.first < y.first : x.second > y.second;
    });
    going.erase(std::unique(going.begin(), going.end()), going.end());
    for (const auto& [type, index] : going) remove_joint_at(type, index);
}

void SceneCore::check_break_limit(const BreakLimit& limit)
{
    if (!(limit.force > 0)) refuse("BreakLimit.force", limit.force, "> 0 (N), infinite for none");
    if (!(limit.torque > 0)) refuse("BreakLimit.torque", limit.torque, "> 0 (N m), infinite for none");
}

void SceneCore::check_wish(const char* field, int at_least)
{
    if (at_least < 0 || at_least > 10000) refuse(field, at_least, "0 to 10000");
}

void SceneCore::check_island_wish(const IslandIterations& asked) const
{
    require_alive(asked.body, "set_island_iterations.body");
    if (bodies.row_of(asked.body).kind() == BodyKind::fixed)
        refuse("set_island_iterations.body", "a body that nothing moves", "a dynamic body");
    check_wish("set_island_iterations.at_least", asked.at_least);
}

void Scene::set_break_limit(ConstraintId joint, const BreakLimit& limit)
{
    core_->require_alive(joint, "set_break_limit.joint");
    core_->check_break_limit(limit);
    JointStores::Slot& slot = core_->joints->slots[joint.slot];
    if (slot.watched == 0) core_->joints->watched.push_back(joint);
    slot.watched = 1;
    slot.break_limit = limit;
}

void Scene::set_iterations(ConstraintId joint, int at_least)
{
    core_->require_alive(joint, "set_iterations.joint");
    core_->check_wish("set_iterations.at_least", at_least);
    std::uint16_t& iterations = core_->joints->slots[joint.slot].iterations;
    core_->joints->with_iterations += (at_least != 0 ? 1U : 0U) - (iterations != 0 ? 1U : 0U);
    iterations = static_cast<std::uint16_t>(at_least);
}

void Scene::set_island_iterations(BodyId body, int at_least)
{
    core_->check_island_wish({body, at_least});
    make_room_for(core_->island_iterations, 1);
    std::erase_if(core_->island_iterations,
                  [&](const IslandIterations& asked) { return asked.body == body; });
    if (at_least > 0) core_->island_iterations.push_back({body, at_least});
}

void SceneCore::make_room_for_break_events()
{
    break_events.reserve(joints->watched.size());
}

void SceneCore::find_break_events() noexcept
{
    break_events.clear();
    std::erase_if(joints->watched, [&](ConstraintId joint) {
        if (!is_alive(joint)) return true;
        JointStores::Slot& slot = joints->slots[joint.slot];
        const bool asks = !std::isinf(slot.break_limit.force) || !std::isinf(slot.break_limit.torque);
        slot.watched = asks ? 1 : 0;
        return !asks;
    });
    for (const ConstraintId joint : joints->watched) {
        const BreakLimit& limit = joints->slots[joint.slot].break_limit;
        const JointReport report = joint_report(joint);
        const float force = std::sqrt(dot(report.force, report.force));
        const float torque = std::sqrt(dot(report.torque, report.torque));
        if (force > limit.force || torque > limit.torque) break_events.push_back({joint, force, torque});
    }
}

/// The mean force over the last step that an impulse of that step makes.
Vec3<float> SceneCore::force_of(const Vec3<float>& impulse) const
{
    return last_step > 0 ? 1 / last_step * impulse : Vec3<float>{};
}

JointReport SceneCore::joint_report(ConstraintId joint) const
{
    require_alive(joint, "joint_report.joint");
    const JointStores::Slot& entry = joints->slots[joint.slot];
    JointReport result;
    joints->for_each([&](const auto& store, int type) {
        if (type != entry.type) return;
        using Type = typename std::remove_cvref_t<decltype(store)>::Type;
        const auto& definition = store.definitions[entry.index];
        result = Type::report(definition, store.memory_of(entry.index), state(definition.body_a),
                              state(definition.body_b));
        const Wrench<float> wrench = store.wrench_of(entry.index);
        result.force = force_of(wrench.push);
        result.torque = force_of(wrench.turn);
    });
    return result;
}

void Scene::read_joint_reports(std::span<const ConstraintId> joints, StridedSpan<JointReport> reports) const
{
    if (reports.size() != joints.size()) {
        refuse("read_joint_reports.reports.size()", static_cast<double>(reports.size()),
               "the size of joints");
    }
    for (const ConstraintId joint : joints) core_->require_alive(joint, "read_joint_reports.joints");
    for (std::size_t i = 0; i < joints.size(); ++i) reports[i] = core_->joint_report(joints[i]);
}

JointReport Scene::contact_report(std::span<const Contact> contacts, std::size_t index) const
{
    const ContactList& list = core_->contacts.current();
    if (index >= core_->listed_contacts() || index >= contacts.size()) {
        refuse("contact_report.index", static_cast<double>(index),
               "below the length of the last step's list and of `contacts`");
    }
    const Contact& contact = contacts[index];
    if (list.entries[index].key != contact.key)
        refuse("contact_report.contacts", "another list", "the list of the last step");
    const ContactImpulse& impulse = contact_impulses()[index];
    JointReport report;
    report.force = core_->force_of(impulse.normal * contact.normal + impulse.friction);
    report.error = std::fmax(0.0F, -contact.separation);
    report.state = impulse.normal > 0 ? JointState::active : JointState::inactive;
    return report;
}

namespace {

template <class Definition, class... Types>
constexpr bool is_built(TypeList<Types...>)
{
    return (std::is_same_v<Definition, typename Types::Definition> || ...);
}

/// The name of a definition as the compiler spells it.
template <class Definition>
std::string_view name_of()
{
    const std::string_view function = __PRETTY_FUNCTION__;
    const std::size_t begin = function.find("Definition = ") + 13;
    return function.substr(begin, function.find_first_of(";]", begin) - begin);
}

/// Returns work(store, its number) for the store of the joints that have such a definition. Refuses joints that are not built.
template <class Definition, class Result, class Work>
Result with_store_of(JointStores& joints, const Work& work)
{
    if constexpr (is_built<Definition>(JointTypes{})) {
        constexpr int type = TypeOfDefinition<Definition, JointTypes>::index;
        return work(std::get<static_cast<std::size_t>(type)>(joints.stores), type);
    } else {
        refuse_unbuilt_joint(name_of<Definition>());
    }
}

}  // namespace

template <class Definition>
ConstraintId Scene::add_joint(const Definition& definition)
{
    return with_store_of<Definition, ConstraintId>(*core_->joints, [&](auto& store, int type) {
        using Type = typename std::remove_cvref_t<decltype(store)>::Type;
        Type::validate(definition, core_->check_joint_bodies(definition.body_a, definition.body_b));
        core_->joints->make_room();
        store.make_room();
        const ConstraintId id = core_->take_joint_slot(type, store.size());
        store.push_back(definition, id.slot);
        core_->wake_island(definition.body_a.slot);
        core_->wake_island(definition.body_b.slot);
        core_->joints->link(2 * id.slot, core_->bodies.first_ends[definition.body_a.slot]);
        core_->joints->link(2 * id.slot + 1, core_->bodies.first_ends[definition.body_b.slot]);
        core_->joints->change(id.slot);
        return id;
    });
}

template <class Definition>
void Scene::set_joint(ConstraintId joint, const Definition& definition)
{
    with_store_of<Definition, void>(*core_->joints, [&](auto& store, int type) {
        using Type = typename std::remove_cvref_t<decltype(store)>::Type;
        const std::size_t index = core_->index_of_joint(joint, type);
        const Definition& now = store.definitions[index];
        if (definition.body_a != now.body_a || definition.body_b != now.body_b)
            refuse("set_joint.definition", "other bodies", "the bodies of the joint");
        Type::validate(definition, core_->check_joint_bodies(definition.body_a, definition.body_b));
        core_->wake_island(definition.body_a.slot);
        core_->wake_island(definition.body_b.slot);
        // Locks and other joints are laid out differently, and so are rotors.
        if (Type::is_equality(definition) != Type::is_equality(now) ||
            Type::rotor_load(definition, core_->bodies) != Type::rotor_load(now, core_->bodies))
            core_->joints->change_altogether();
        store.define(index, definition);
    });
}

namespace {

/// Instantiates both calls for every type in the list.
template <class List>
struct JointCalls;
template <class... Types>
struct JointCalls<TypeList<Types...>> {
    std::tuple<ConstraintId (Scene::*)(const typename Types::Definition&)...> add{
        &Scene::add_joint<typename Types::Definition>...};
    std::tuple<void (Scene::*)(ConstraintId, const typename Types::Definition&)...> set{
        &Scene::set_joint<typename Types::Definition>...};
};
[[gnu::used]] const JointCalls<AllJointTypes> joint_calls;

}  // namespace

}  // namespace motley
