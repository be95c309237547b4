// Checks that capsules and half-spaces, as read from a file, are such as a host could have added.
#include <cmath>
#include <cstdlib>

#include "scene/archive_checks.h"
#include "scene/scene_archive.h"

namespace motley {
namespace {

bool is_finite(const Contact& contact)
{
    const Vec3<float> sum = contact.normal + contact.arm_a + contact.arm_b;
    return std::isfinite(sum.x + sum.y + sum.z) && std::isfinite(contact.separation);
}

}  // namespace

void SceneArchive::check_capsules(const SceneCore& scene)
{
    const ShapeStore& shapes = scene.shapes;
    using Kind = ShapeStore::Kind;
    demand(!shapes.slots.empty() && shapes.slots[0].kind == Kind::none &&
               shapes.slots.size() <= ShapeStore::most_slots,
           "a shape of the null handle");
    std::size_t alive = 0;
    for (const ShapeStore::Slot& slot : shapes.slots) {
        demand(slot.kind <= Kind::half_space && slot.generation != 0, "a handle of no shape");
        alive += slot.kind != Kind::none ? 1 : 0;
    }
    demand(alive == shapes.capsules.size() + shapes.half_spaces.size(), "a handle of no shape");
    check_free_list(
        shapes.free_slots, shapes.slots.size(),
        [&](std::uint32_t slot) { return shapes.slots[slot].kind != Kind::none; },
        "a free shape that is taken");
    const auto check_slot = [&](std::uint32_t slot, Kind kind, std::size_t index) {
        demand(slot < shapes.slots.size() && shapes.slots[slot].kind == kind &&
                   shapes.slots[slot].index == index,
               "a shape without a handle");
    };
    for (std::size_t i = 0; i < shapes.capsules.size(); ++i) {
        const Capsule& own = shapes.capsules[i];
        check_slot(own.slot, Kind::capsule, i);
        demand(own.body != BodyId{}, "a capsule on no body");
        scene.check_capsule({own.body, own.from, own.to, own.radius, own.surface.friction,
                             own.surface.restitution, own.surface.category, own.surface.mask, own.group});
    }
    for (std::size_t i = 0; i < shapes.half_spaces.size(); ++i) {
        const HalfSpace& own = shapes.half_spaces[i];
        check_slot(own.slot, Kind::half_space, i);
        demand(own.body != BodyId{}, "a half-space on no body");
        scene.check_half_space({own.body, own.point, own.normal, own.surface.friction,
                                own.surface.restitution, own.surface.category, own.surface.mask});
        demand(std::abs(dot(own.normal, own.normal) - 1) < 1e-4F, "a normal that is none");
    }
    demand(shapes.next_group >= ShapeStore::first_given_group, "a group that was not given out");
    demand(shapes.walls_met.size() == shapes.contacts.size() &&
               shapes.contacts.size() <= scene.contacts.current().count,
           "contacts of capsules that were not solved");
    for (const WallMet& met : shapes.walls_met)
        demand(std::abs(met.side) <= 1, "a capsule on no side of a wall");
    for (const Contact& contact : shapes.contacts) demand(is_finite(contact), "a contact that is nowhere");
}

}  // namespace motley
