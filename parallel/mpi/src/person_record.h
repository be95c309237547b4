// A person as bytes, to be sent to another rank. Values are copied from the rows of a scene and back, so that no bit changes.
#pragma once

#include <array>
#include <cstdint>

#include "scene/scene_core.h"

namespace motley {

/// What may change in every step.
struct PersonState {
    BodyPose pose;
    std::array<float, 3> velocity{};      ///< vx vy w
    std::array<float, 3> acceleration{};  ///< of the host's force
    Damping damping;
};

/// All of a person.
struct PersonRecord {
    std::uint64_t number = 0;
    PersonState state;
    float inverse_mass = 0, inverse_inertia = 0;
    DiscShape shape;
    std::uint64_t user_data = 0;
    float slow_for = 0;                           ///< s: BodyStore::slow_for
    std::array<float, 3> sleeper_acceleration{};  ///< Sleeper::acceleration; 0 of who is awake
    std::uint32_t sleep = 0;                      ///< a Sleep
    std::uint32_t is_copy = 0;
    std::uint64_t island = 0;  ///< of who sleeps: see Region
};

PersonState read_state(const SceneCore& scene, std::uint32_t slot);
void write_state(SceneCore& scene, std::uint32_t slot, const PersonState& state);
/// `is_copy` and `island` are left to the caller.
PersonRecord read_person(const SceneCore& scene, std::uint32_t slot);
/// Writes a person, but for the host's own number of it, into a planar body that was added for it.
void write_person(SceneCore& scene, std::uint32_t slot, const PersonRecord& person);

/// An impulse that waits for its contact to be found again, by the numbers of its people.
struct ImpulseRecord {
    std::uint64_t a = 0;
    std::uint64_t b = 0;  ///< or a segment
    float normal = 0, tangent = 0, side = 0;
    float step_normal = 0, step_tangent = 0;  ///< of people who sleep
    std::uint32_t is_wall = 0;
};

}  // namespace motley
