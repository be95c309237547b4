// One pass over the stores; then the few joints that are new get their colours.
#include "layout/joint_intake.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "stores/growth.h"
#include "stores/joint_store.h"

namespace motley {
namespace {

/// Whether a joint of this type has rows that are made once a step, and not once a substep.
template <class Type>
constexpr bool has_start_rows =
    std::is_empty_v<typename Type::template SubstepRow<float, BodyKind::rigid, BodyKind::rigid>>;

template <class Type>
JointCandidate candidate_of(const JointStore<Type>& store, int type, std::size_t index,
                            const BodyStore& bodies)
{
    const typename Type::Definition& definition = store.definitions[index];
    return {
        {bodies.row_of(definition.body_a), bodies.row_of(definition.body_b), static_cast<std::int32_t>(index),
         static_cast<std::uint8_t>(contact_type_count + type), store.colours[index]},
        Type::is_equality(definition) ? Type::equality_count : 0,
        Type::locks_point,
        Type::active_row,
        Type::locks_place(definition),
        Type::rotor_load(definition, bodies)};
}

void forget_impulse(JointStores& stores, int type, std::size_t index)
{
    stores.for_each([&](auto& store, int t) {
        if (t == type) store.forget_impulse(index);
    });
}

}  // namespace

JointColumns::JointColumns(JointStores& stores) : stores_(&stores)
{
    auto type = static_cast<std::size_t>(contact_type_count);
    stores.for_each([&](auto& store, int) {
        slots_[type] = store.slots.data();
        colours_[type++] = store.colours.data();
    });
}

std::uint64_t JointColumns::order_of(const Placement& joint) const
{
    return stores_->colouring_order(slot_of(joint.type, joint.constraint));
}

void JointColumns::give_colour(Placement& joint, ColourMasks& masks) const
{
    joint.colour = masks.take_first(joint.a, joint.b);
    colours_[joint.type][joint.constraint] = joint.colour;
}

JointCandidate JointIntake::candidate(const SceneCore& scene, int type, std::size_t index)
{
    using Call = JointCandidate (*)(const JointStores&, std::size_t, const BodyStore&);
    static constexpr auto calls = []<std::size_t... types>(std::index_sequence<types...>)
    {
        return std::array<Call, sizeof...(types)>{
            [](const JointStores& stores, std::size_t i, const BodyStore& bodies) {
                return candidate_of(std::get<types>(stores.stores), static_cast<int>(types), i, bodies);
            }...};
    }
    (std::make_index_sequence<JointTypes::size>{});
    return calls[static_cast<std::size_t>(type)](*scene.joints, index, scene.bodies);
}

std::uint32_t JointIntake::start_rows_bit_of(std::size_t type)
{
    static constexpr auto bits = []<class... Types>(TypeList<Types...>) {
        return std::array<std::uint32_t, sizeof...(Types)>{has_start_rows<Types> ? start_rows_bit
                                                                                 : std::uint32_t{}...};
    }(JointTypes{});
    return bits[type - contact_type_count];
}

void JointIntake::grow(const BodyStore& bodies)
{
    for (int kind = 0; kind < body_kind_count; ++kind)
        grow_to(is_jointed_[static_cast<std::size_t>(kind)], bodies.rows(static_cast<BodyKind>(kind)).size());
}

void JointIntake::take(SceneCore& scene, bool limits_exactly, ColourMasks& masks)
{
    const BodyStore& bodies = scene.bodies;
    for (int kind = 0; kind < body_kind_count; ++kind)
        is_jointed_[static_cast<std::size_t>(kind)].assign(bodies.rows(static_cast<BodyKind>(kind)).size(),
                                                           0);
    std::array<std::size_t, JointTypes::size> counts{};
    scene.joints->for_each(
        [&](const auto& store, int type) { counts[static_cast<std::size_t>(type)] = store.size(); });
    joints_.resize(std::accumulate(counts.begin(), counts.end(), std::size_t{0}));
    uncoloured_.clear();
    sets_.reset([&](BodyKind kind) { return bodies.rows(kind).size(); });
    JointCandidate* next = joints_.data();
    const auto list = [&](const JointCandidate& joint) {
        const BodyRow a = joint.placement.a, b = joint.placement.b;
        const std::uint8_t colour = joint.placement.colour;
        if (colour != no_colour) masks.try_take(a, b, colour);
        if (bodies.is_contained(a) || bodies.is_contained(b)) return false;
        if (bodies.is_asleep(a) || bodies.is_asleep(b)) return true;
        if (colour == no_colour) uncoloured_.push_back(static_cast<std::uint32_t>(next - joints_.data()));
        if (start_rows_bit_of(joint.placement.type) != 0) masks.note_start_rows(a, b);
        note(a, true);
        note(b, true);
        sets_.tie(a, b);
        *next = joint;
        if (!limits_exactly && !joint.has_rotor()) next->active_row = ActiveRow::none;
        ++next;
        return true;
    };
    for (int type = 0; type < JointTypes::size; ++type) {
        for (std::size_t i = 0; i < counts[static_cast<std::size_t>(type)]; ++i)
            if (!list(candidate(scene, type, i))) forget_impulse(*scene.joints, type, i);
    }
    joints_.resize(static_cast<std::size_t>(next - joints_.data()));
    sets_.flatten();
    colour(*scene.joints, masks);
}

/// Colours that are in use are taken already, so a new joint gets one that is free on both of its bodies.
void JointIntake::colour(JointStores& stores, ColourMasks& masks)
{
    const JointColumns columns(stores);
    std::sort(uncoloured_.begin(), uncoloured_.end(), [&](std::uint32_t i, std::uint32_t j) {
        return columns.order_of(joints_[i].placement) < columns.order_of(joints_[j].placement);
    });
    for (const std::uint32_t i : uncoloured_) columns.give_colour(joints_[i].placement, masks);
}

}  // namespace motley
