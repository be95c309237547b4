// Whether what was read is a scene: a checksum tells of accidents, this of everything else.
#include "scene_archive.h"

#include <string>

namespace motley {
namespace {

void demand(bool holds, const char* what)
{
    if (!holds) throw std::runtime_error(std::string("is no scene: ") + what);
}

}  // namespace

void SceneArchive::check(const Scene& scene)
{
    const BodyStore& bodies = scene.bodies_;
    const std::size_t slots = bodies.slots_.size();
    demand(slots > 0 && bodies.live_.size() == slots && bodies.models_.size() == slots &&
               bodies.motions_.size() == slots && bodies.joint_counts.size() == slots &&
               bodies.contained.size() == slots && bodies.inverse_masses.size() == slots &&
               bodies.inverse_inertias.size() == slots,
           "its tables of bodies differ in length");
    for (int kind = 0; kind < body_kind_count; ++kind) {
        const BodyRows& rows = bodies.rows(static_cast<BodyKind>(kind));
        const std::size_t size = rows.slot.size();
        const std::size_t floats = size * 4 * static_cast<std::size_t>(quads_of(static_cast<BodyKind>(kind)));
        const bool rigid = static_cast<BodyKind>(kind) == BodyKind::rigid;
        const bool turns = rigid || static_cast<BodyKind>(kind) == BodyKind::fixed;
        demand(size > 0 && rows.slot[0] == 0 && rows.velocity.size() == floats &&
                   rows.delta.size() == floats && rows.acceleration.size() == floats &&
                   rows.unpushed.size() == floats && rows.pose.size() == size &&
                   rows.orientation.size() == (turns ? size : 0) &&
                   rows.world_inverse_inertia.size() == (rigid ? 8 * size : 0) &&
                   rows.start_inverse_inertia.size() == (rigid ? 8 * size : 0) &&
                   rows.inertia.size() == (rigid ? size : 0) &&
                   rows.inverse_inertia.size() == (rigid ? size : 0),
               "its rows of bodies differ in length");
        for (const std::uint32_t slot : rows.slot) {
            demand(slot == 0 || (slot < slots && bodies.live_[slot] != 0), "a row of no body");
        }
        for (const std::uint32_t row : rows.free_rows)
            demand(row < size && rows.slot[row] == 0, "a free row that is taken");
    }
    std::size_t alive = 0;
    for (std::uint32_t slot = 1; slot < slots; ++slot) {
        demand(static_cast<int>(bodies.models_[slot]) <= static_cast<int>(BodyModel::rigid) &&
                   static_cast<int>(bodies.motions_[slot]) <= static_cast<int>(BodyMotion::static_body),
               "a body of no model");
        if (bodies.live_[slot] == 0) continue;
        ++alive;
        const BodyRow where = bodies.slots_[slot].row;
        const BodyRows& rows = bodies.rows(where.kind());
        demand(where.row() < rows.slot.size() && rows.slot[where.row()] == slot, "a body without a row");
    }
    for (const std::uint32_t slot : bodies.free_slots_)
        demand(slot > 0 && slot < slots && bodies.live_[slot] == 0, "a free handle that is taken");
    demand(bodies.is_alive(scene.ground_) && alive == scene.body_count_ + 1, "bodies that are not counted");
    for (const Scene::IslandIterations& asked : scene.island_iterations_)
        demand(bodies.is_alive(asked.body), "a wish of a body that is gone");

    const JointStores& joints = scene.joints_;
    const auto is_colour = [](std::uint8_t colour) { return colour <= 30 || colour == no_colour; };
    joints.for_each([&](const auto& store, int type) {
        using Store = std::remove_cvref_t<decltype(store)>;
        const std::size_t size = store.definitions.size();
        demand(store.parameters.size() == size * quad_floats<typename Store::Parameters> &&
                   store.memory.size() == size * quad_floats<typename Store::Memory> &&
                   store.world_points.size() == (Store::has_world_points ? size : 0) &&
                   store.colours.size() == size && store.slots.size() == size,
               "its lists of joints differ in length");
        for (std::size_t i = 0; i < size; ++i) {
            demand(
                bodies.is_alive(store.definitions[i].body_a) && bodies.is_alive(store.definitions[i].body_b),
                "a joint of a body that is gone");
            demand(is_colour(store.colours[i]), "a joint of no colour");
            const std::uint32_t slot = store.slots[i];
            demand(slot > 0 && slot < joints.slots.size() && joints.slots[slot].live &&
                       joints.slots[slot].type == type && joints.slots[slot].index == i,
                   "a joint without a handle");
        }
    });
    for (const std::uint32_t slot : joints.free_slots)
        demand(slot > 0 && slot < joints.slots.size() && !joints.slots[slot].live,
               "a free joint that is taken");
    for (const ConstraintId id : joints.watched) demand(id.slot < joints.slots.size(), "a watch on no joint");
    const ContactList& list = scene.contacts_.current();
    for (std::size_t i = 0; i < list.count; ++i) demand(is_colour(list.colours[i]), "a contact of no colour");
}

}  // namespace motley
