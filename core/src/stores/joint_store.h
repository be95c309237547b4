// The joints of a scene, one store a type: what the host defined, and what persists from step to step.
#pragma once

#include <cstdint>
#include <cstring>
#include <memory>
#include <tuple>
#include <utility>

#include "contract/constraint_type.h"
#include "contract/constraint_types.h"
#include "motley/core/ids.h"
#include "motley/core/joint_report.h"
#include "scene/joint_pose.h"
#include "stores/aligned_vector.h"
#include "stores/contact_cache.h"
#include "stores/growth.h"

namespace motley {

/// The number of floats in T, rounded up to whole quads of four, in which lanes are loaded.
template <class T>
inline constexpr std::size_t quad_floats = (sizeof(T) / sizeof(float) + 3) / 4 * 4;

/// Joints of one type, without gaps: removal moves the last joint into the gap. Their order decides which joints share
/// a block, and so every bit of the result.
template <JointType JointInList>
struct JointStore {
    using Type = JointInList;
    using Parameters = typename Type::template Parameters<float>;
    using Memory = typename Type::template Memory<float>;

    Array<typename Type::Definition> definitions;
    AlignedVector<float> parameters;  ///< quad_floats<Parameters> a joint
    AlignedVector<float> memory;      ///< quad_floats<Memory> a joint: impulses of the last substep
    AlignedVector<float> wrenches;    ///< quad_floats<Wrench> a joint: of the last step
    Array<WorldPoints> world_points;  ///< only of types with has_world_points
    Array<std::uint8_t> colours;      ///< no_colour until the first step
    Array<std::uint32_t> slots;       ///< handle slot of each joint

    static constexpr bool has_world_points = Type::has_world_points;
    static constexpr std::size_t wrench_floats = quad_floats<Wrench<float>>;
    [[nodiscard]] std::size_t size() const { return definitions.size(); }

    /// Reserves room for one more joint, so that push_back() cannot fail.
    void make_room()
    {
        make_room_for(definitions, 1);
        make_room_for(parameters, quad_floats<Parameters>);
        make_room_for(memory, quad_floats<Memory>);
        make_room_for(wrenches, wrench_floats);
        if constexpr (has_world_points) make_room_for(world_points, 1);
        make_room_for(colours, 1);
        make_room_for(slots, 1);
    }
    void push_back(const typename Type::Definition& definition, std::uint32_t slot)
    {
        definitions.push_back(definition);
        parameters.resize(parameters.size() + quad_floats<Parameters>);
        if constexpr (has_world_points) world_points.emplace_back();
        define(size() - 1, definition);
        memory.resize(memory.size() + quad_floats<Memory>);
        wrenches.resize(wrenches.size() + wrench_floats);
        colours.push_back(no_colour);
        slots.push_back(slot);
    }
    /// Replaces the definition of a joint. Its accumulated impulses are kept.
    void define(std::size_t index, const typename Type::Definition& definition)
    {
        const Parameters packed = Type::parameters(definition);
        definitions[index] = definition;
        std::memcpy(&parameters[index * quad_floats<Parameters>], &packed, sizeof packed);
        if constexpr (has_world_points) world_points[index] = Type::world_points(definition);
    }
    void forget_impulse(std::size_t index)
    {
        std::memset(&memory[index * quad_floats<Memory>], 0, quad_floats<Memory> * sizeof(float));
        std::memset(&wrenches[index * wrench_floats], 0, wrench_floats * sizeof(float));
    }
    [[nodiscard]] Memory memory_of(std::size_t index) const
    {
        Memory m;
        std::memcpy(static_cast<void*>(&m), &memory[index * quad_floats<Memory>], sizeof m);
        return m;
    }
    [[nodiscard]] Wrench<float> wrench_of(std::size_t index) const
    {
        Wrench<float> wrench;
        std::memcpy(static_cast<void*>(&wrench), &wrenches[index * wrench_floats], sizeof wrench);
        return wrench;
    }
    void swap_remove(std::size_t index)
    {
        const std::size_t last = size() - 1;
        if (index != last) {
            definitions[index] = definitions[last];
            std::memcpy(&parameters[index * quad_floats<Parameters>],
                        &parameters[last * quad_floats<Parameters>], quad_floats<Parameters> * sizeof(float));
            std::memcpy(&memory[index * quad_floats<Memory>], &memory[last * quad_floats<Memory>],
                        quad_floats<Memory> * sizeof(float));
            std::memcpy(&wrenches[index * wrench_floats], &wrenches[last * wrench_floats],
                        wrench_floats * sizeof(float));
            if constexpr (has_world_points) world_points[index] = world_points[last];
            colours[index] = colours[last];
            slots[index] = slots[last];
        }
        if constexpr (has_world_points) world_points.pop_back();
        definitions.pop_back();
        parameters.resize(last * quad_floats<Parameters>);
        memory.resize(last * quad_floats<Memory>);
        wrenches.resize(last * wrench_floats);
        colours.pop_back();
        slots.pop_back();
    }
};

template <class List>
struct StoresOf;
template <class... Types>
struct StoresOf<TypeList<Types...>> {
    using type = std::tuple<JointStore<Types>...>;
};

/// The stores of all types, the handles, and a token of the present set of joints.
struct JointStores {
    struct Slot {
        std::uint32_t generation = 0;
        std::uint32_t index = 0;
        std::uint8_t type = 0;
        std::uint8_t live = 0;     ///< 1 or 0; no bool, which a corrupt file could make invalid
        std::uint8_t watched = 0;  ///< likewise: whether the joint is in `watched` below
        BreakLimit break_limit{};
        std::uint16_t iterations =
            0;  ///< least number of sweeps of solve in a substep; 0: as SolverSettings says
        std::uint64_t number = 0;  ///< how many joints had been added to the scene with this one
    };
    typename StoresOf<JointTypes>::type stores;
    Array<Slot> slots{Slot{}};  ///< slot 0 is the null handle's: new ones go on from its generation
    Array<std::uint32_t> free_slots;
    std::uint64_t added = 0;  ///< how many joints, with those that were removed since
    /// The joints on each body as a doubly linked list of joint ends: end 2 s is the end of the joint in slot s on its
    /// body a, end 2 s + 1 the one on its body b; 0 is no end. The list of a body begins at BodyStore::first_ends.
    struct End {
        std::uint32_t next = 0, previous = 0;
    };
    Array<End> ends{2};
    Array<ConstraintId> watched;      ///< joints with a break limit, and some that had one
    std::size_t with_iterations = 0;  ///< number of joints with `iterations` above 0
    /// Token of this set of joints: null after a change, made by the next step, shared by copies of the scene.
    /// A layout that holds the same token was made from the same joints.
    std::shared_ptr<const char> version;
    /// What has changed since the set had the token `since`, so that a layout that holds it need not start over: the slots
    /// of joints that came, went, moved in their store, or whose bodies fell asleep or woke, in any order, some of them twice.
    struct Changes {
        std::shared_ptr<const char> since;  ///< null when a list of joints would not do, or would be too long
        Array<std::uint32_t> slots;
    } changes;
    /// The joint in this slot has come, gone or moved, or is solved no more, or again. Does not allocate: more changes than there is room for are no longer
    /// followed one by one.
    void change(std::uint32_t slot)
    {
        if (version) changes.since = std::exchange(version, nullptr);
        if (changes.slots.size() == changes.slots.capacity()) changes.since.reset();
        if (changes.since) changes.slots.push_back(slot);
    }
    /// The same for all joints of the list that begins at `first`: their body has fallen asleep or woken.
    void change_all_on(std::uint32_t first)
    {
        for (std::uint32_t end = first; end != 0; end = ends[end].next) change(end / 2);
    }
    /// The rows of bodies, or which joints are solved, have changed.
    void change_altogether()
    {
        version.reset();
        changes.since.reset();
    }
    /// Gives the set a token, and room to note as many changes as it pays to follow one by one.
    void close_changes()
    {
        changes.since.reset();
        changes.slots.clear();
        changes.slots.reserve(64 + slots.size() / 16);
        if (!version) version = std::make_shared<const char>('\0');
    }

    /// Joints of one type get their colours in the order in which they were added, whatever was removed since: so figures that
    /// are built alike get alike colours.
    [[nodiscard]] std::uint64_t colouring_order(std::uint32_t slot) const
    {
        return std::uint64_t{slots[slot].type} << 56 | slots[slot].number;
    }

    /// Reserves room to give out one more handle and to take it back, so that neither can fail.
    void make_room()
    {
        make_room_for(slots, 1);
        make_room_for(ends, 2);
        if (free_slots.capacity() <= slots.size()) free_slots.reserve(slots.capacity());
    }
    /// link() puts an end at the front of the list that begins at `first`; unlink() takes it out.
    void link(std::uint32_t end, std::uint32_t& first)
    {
        ends[end] = {first, 0};
        if (first != 0) ends[first].previous = end;
        first = end;
    }
    void unlink(std::uint32_t end, std::uint32_t& first)
    {
        const auto [next, previous] = ends[end];
        (previous != 0 ? ends[previous].next : first) = next;
        if (next != 0) ends[next].previous = previous;
    }
    /// Calls visit(slot) for each joint of the list that begins at `first`.
    template <class Visit>
    void for_each_on(std::uint32_t first, Visit&& visit) const
    {
        for (std::uint32_t end = first; end != 0; end = ends[end].next) visit(slots[end / 2]);
    }

    /// Calls visit(store, type number) for each type.
    template <class Visit>
    void for_each(Visit&& visit)
    {
        int type = 0;
        std::apply([&](auto&... store) { (visit(store, type++), ...); }, stores);
    }
    template <class Visit>
    void for_each(Visit&& visit) const
    {
        int type = 0;
        std::apply([&](const auto&... store) { (visit(store, type++), ...); }, stores);
    }
};

/// The joint type whose definition is Definition, and its number in JointTypes.
template <class Definition, class List>
struct TypeOfDefinition;
template <class Definition, class First, class... Rest>
struct TypeOfDefinition<Definition, TypeList<First, Rest...>> {
    static constexpr bool here = std::is_same_v<Definition, typename First::Definition>;
    static constexpr int index = [] {
        if constexpr (here) {
            return 0;
        } else {
            return 1 + TypeOfDefinition<Definition, TypeList<Rest...>>::index;
        }
    }();
};

}  // namespace motley
