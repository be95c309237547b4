// See contact_events.h.
#include "motley/core/contact_events.h"

#include <algorithm>
#include <utility>

#include "queries/radix_sort.h"
#include "scene/disc_impulses.h"
#include "stores/array.h"
#include "stores/growth.h"

namespace motley {
namespace {

/// A pair in sixteen bytes. The key has the slots in the order of the lists; among the living they say it all.
struct Pair {
    std::uint64_t key;                         ///< of a or the wall above that of b; the highest bit: a wall
    std::uint32_t generation_a, generation_b;  ///< of the same
};
constexpr std::uint64_t wall_bit = std::uint64_t{1} << 63;  // slots have less than 31 bits, as rows do

constexpr std::uint64_t key_of(std::uint32_t first, std::uint32_t b)
{
    return std::uint64_t{first} << 32 | b;
}

bool is_before(const Pair& one, const Pair& other)
{
    if (one.key != other.key) return one.key < other.key;
    if (one.generation_a != other.generation_a) return one.generation_a < other.generation_a;
    return one.generation_b < other.generation_b;
}

ContactPair pair_of(const Pair& pair)
{
    const auto first = static_cast<std::uint32_t>((pair.key & ~wall_bit) >> 32);
    const BodyId b{static_cast<std::uint32_t>(pair.key), pair.generation_b};
    if ((pair.key & wall_bit) != 0) return {{}, b, {first, pair.generation_a}};
    return {{first, pair.generation_a}, b, {}};
}

/// Of bodies a and b, or of a wall and body b.
Pair pair_of(BodyId a, BodyId b, WallId wall)
{
    if (wall != WallId{}) return {wall_bit | key_of(wall.slot, b.slot), wall.generation, b.generation};
    if (a.slot < b.slot) return {key_of(a.slot, b.slot), a.generation, b.generation};
    return {key_of(b.slot, a.slot), b.generation, a.generation};
}

/// Appends the pairs that pushed in the last step.
void list_pushing(const SceneCore& scene, Array<Pair>& pairs)
{
    scene.for_each_disc_impulse([&](const DiscImpulse& impulse) {
        const WallId wall = impulse.segment != UINT32_MAX ? scene.discs.wall_of(impulse.segment) : WallId{};
        pairs.push_back(
            pair_of(scene.bodies.id_of_slot(impulse.slot_a), scene.bodies.id_of_slot(impulse.slot_b), wall));
    });
    scene.for_each_shape_impulse([&](const Contact& contact, const ContactImpulse& impulse, WallId wall) {
        if (impulse.normal > 0) pairs.push_back(pair_of(contact.body_a, contact.body_b, wall));
    });
}

/// Appends what is in `these` and not in `those`; both are sorted.
void list_missing(const Array<Pair>& these, const Array<Pair>& those, Array<ContactPair>& missing)
{
    auto other = those.begin();
    for (const Pair& pair : these) {
        while (other != those.end() && is_before(*other, pair)) ++other;
        if (other == those.end() || is_before(pair, *other)) missing.push_back(pair_of(pair));
    }
}

/// What an update finds.
struct Found {
    Array<Pair> pairs;  ///< sorted
    Array<ContactPair> began, ended;
};

}  // namespace

struct ContactEventsCore {
    Found last, next;
    Array<Pair> spare;  ///< room to sort
};
template class Boxed<ContactEventsCore>;

ContactEvents::ContactEvents() = default;

void ContactEvents::update(const Scene& scene)
{
    const SceneCore& core = core_of(scene);
    const Found& last = core_->last;
    Found& next = core_->next;
    next.pairs.clear();
    next.began.clear();
    next.ended.clear();
    list_pushing(core, next.pairs);
    grow_to(core_->spare, next.pairs.size());
    radix_sort(std::span(next.pairs), std::span(core_->spare), [](const Pair& pair) { return pair.key; });
    const auto same = [](const Pair& one, const Pair& other) { return one.key == other.key; };
    next.pairs.erase(std::unique(next.pairs.begin(), next.pairs.end(), same), next.pairs.end());
    list_missing(next.pairs, last.pairs, next.began);
    list_missing(last.pairs, next.pairs, next.ended);
    std::swap(core_->last, core_->next);
}

std::span<const ContactPair> ContactEvents::began() const
{
    return core_->last.began;
}

std::span<const ContactPair> ContactEvents::ended() const
{
    return core_->last.ended;
}

std::size_t ContactEvents::pushing() const
{
    return core_->last.pairs.size();
}

void ContactEvents::clear()
{
    core_->last = {};
}

}  // namespace motley
