// See person_record.h.
#include "person_record.h"

#include <algorithm>

#include "stores/growth.h"

namespace motley {
namespace {

std::size_t row_of(const SceneCore& scene, std::uint32_t slot)
{
    return scene.bodies.row_of(scene.bodies.id_of_slot(slot)).row();
}

}  // namespace

PersonState read_state(const SceneCore& scene, std::uint32_t slot)
{
    const BodyRows& rows = scene.bodies.rows(BodyKind::planar);
    const std::size_t row = row_of(scene, slot);
    const float* v = &rows.velocity[4 * row];
    const float* a = &rows.acceleration[4 * row];
    return {rows.pose[row], {v[0], v[1], v[2]}, {a[0], a[1], a[2]}, scene.bodies.dampings[slot]};
}

void write_state(SceneCore& scene, std::uint32_t slot, const PersonState& state)
{
    BodyRows& rows = scene.bodies.rows(BodyKind::planar);
    const std::size_t row = row_of(scene, slot);
    rows.pose[row] = state.pose;
    for (std::size_t i = 0; i < 3; ++i) {
        rows.velocity[4 * row + i] = state.velocity[i];
        rows.acceleration[4 * row + i] = state.acceleration[i];
    }
    scene.bodies.set_damping(slot, state.damping);
}

PersonRecord read_person(const SceneCore& scene, std::uint32_t slot)
{
    PersonRecord person;
    person.number = scene.discs.numbers[slot];
    person.state = read_state(scene, slot);
    person.inverse_mass = scene.bodies.inverse_masses[slot];
    person.inverse_inertia = scene.bodies.inverse_inertias[slot];
    person.shape = scene.discs.shapes[slot];
    person.user_data = slot < scene.user_data.size() ? scene.user_data[slot] : 0;
    person.slow_for = scene.bodies.slow_for[slot];
    person.sleep = static_cast<std::uint32_t>(scene.bodies.sleep[slot]);
    if (scene.bodies.is_asleep(slot))
        std::copy_n(scene.sleep.sleepers[slot].acceleration.begin(), person.sleeper_acceleration.size(),
                    person.sleeper_acceleration.begin());
    return person;
}

void write_person(SceneCore& scene, std::uint32_t slot, const PersonRecord& person)
{
    BodyRows& rows = scene.bodies.rows(BodyKind::planar);
    const std::size_t row = row_of(scene, slot);
    scene.bodies.inverse_masses[slot] = rows.velocity[4 * row + 3] = person.inverse_mass;
    scene.bodies.inverse_inertias[slot] = rows.delta[4 * row + 3] = person.inverse_inertia;
    scene.bodies.slow_for[slot] = person.slow_for;
    if (person.sleep != static_cast<std::uint32_t>(Sleep::awake)) {
        grow_to(scene.sleep.sleepers, scene.bodies.slot_count());
        scene.bodies.fall_asleep(slot);
        scene.bodies.sleep[slot] = static_cast<Sleep>(person.sleep);
        scene.sleep.sleepers[slot].next = slot;
        std::copy(person.sleeper_acceleration.begin(), person.sleeper_acceleration.end(),
                  scene.sleep.sleepers[slot].acceleration.begin());
    }
    // After that, because a sleeper may have been given a speed for when it wakes.
    write_state(scene, slot, person.state);
    scene.discs.numbers[slot] = person.number;
    scene.discs.set_shape(slot, person.shape);
}

}  // namespace motley
