// One pass over the stores; then the few joints that are new get their colours.
#include "layout/joint_intake.h"

#include <utility>

#include "stores/growth.h"
#include "stores/joint_store.h"

namespace motley {
namespace {

/// Whether a joint of this type has rows that are made once a step, and not once a substep.
template <class Type>
constexpr bool has_start_rows =
    std::is_empty_v<typename Type::template SubstepRow<float, BodyKind::rigid, BodyKind::rigid>>;

}  // namespace

void JointIntake::grow(const BodyStore& bodies)
{
    for (int kind = 0; kind < body_kind_count; ++kind)
        grow_to(is_jointed_[static_cast<std::size_t>(kind)], bodies.rows(static_cast<BodyKind>(kind)).size());
}

void JointIntake::note(BodyRow body)
{
    if (body.kind() == BodyKind::fixed) return;
    std::uint8_t& is_noted = is_jointed_[static_cast<std::size_t>(body.kind())][body.row()];
    if (std::exchange(is_noted, std::uint8_t{1}) == 0) bodies_.push_back(body);
}

void JointIntake::take(SceneCore& scene, bool limits_exactly, ColourMasks& masks)
{
    const BodyStore& bodies = scene.bodies;
    for (int kind = 0; kind < body_kind_count; ++kind)
        is_jointed_[static_cast<std::size_t>(kind)].assign(bodies.rows(static_cast<BodyKind>(kind)).size(),
                                                           0);
    std::size_t count = 0;
    scene.joints->for_each([&](const auto& store, int) { count += store.size(); });
    joints_.resize(count);
    uncoloured_.clear();
    bodies_.clear();
    sets_.reset([&](BodyKind kind) { return bodies.rows(kind).size(); });
    JointCandidate* next = joints_.data();
    scene.joints->for_each([&](auto& store, int type) {
        using Type = typename std::remove_cvref_t<decltype(store)>::Type;
        for (std::size_t i = 0; i < store.size(); ++i) {
            const typename Type::Definition& definition = store.definitions[i];
            const BodyRow a = bodies.row_of(definition.body_a), b = bodies.row_of(definition.body_b);
            if (store.colours[i] != no_colour) masks.try_take(a, b, store.colours[i]);
            if (bodies.is_contained(a) || bodies.is_contained(b)) {
                store.forget_impulse(i);
                continue;
            }
            if (bodies.is_asleep(a) || bodies.is_asleep(b)) continue;
            if (store.colours[i] == no_colour)
                uncoloured_.push_back(static_cast<std::uint32_t>(next - joints_.data()));
            if (has_start_rows<Type>) masks.note_start_rows(a, b);
            note(a);
            note(b);
            sets_.tie(a, b);
            const int equalities = Type::is_equality(definition) ? Type::equality_count : 0;
            *next++ = {{a, b, static_cast<std::int32_t>(i),
                        static_cast<std::uint8_t>(contact_type_count + type), store.colours[i]},
                       equalities,
                       Type::locks_point,
                       limits_exactly ? Type::active_row : ActiveRow::none,
                       Type::locks_place(definition)};
        }
    });
    joints_.resize(static_cast<std::size_t>(next - joints_.data()));
    sets_.flatten();
    colour(*scene.joints, masks);
}

/// Colours that are in use are taken already, so a new joint gets one that is free on both of its bodies.
void JointIntake::colour(JointStores& stores, ColourMasks& masks)
{
    auto next = uncoloured_.begin();
    stores.for_each([&](auto& store, int type) {
        for (; next != uncoloured_.end(); ++next) {
            Placement& joint = joints_[*next].placement;
            if (joint.type != contact_type_count + type) return;
            joint.colour = masks.take_first(joint.a, joint.b);
            store.colours[static_cast<std::size_t>(joint.constraint)] = joint.colour;
        }
    });
}

}  // namespace motley
