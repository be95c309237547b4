// Who sleeps, and what wakes a sleeper.
//
// An island is a set of dynamic bodies that joints and touching contacts connect. When all bodies of an island have been
// slower than SolverSettings::sleep_speed for sleep_after, they fall asleep together at the end of that step: they lose
// what speed they have, and nothing moves them. Joints and contacts between sleepers, and between sleepers and bodies
// that are not dynamic, are left out of steps and keep what they bore. An island wakes as a whole:
//
//   - at once, by Scene::wake, and by every call that changes one of its bodies (set_pose, set_mass, set_damping,
//     change_body, set_disc, clear_disc, remove_body), its joints (add_joint, set_joint, remove_joint) or a wall near it
//     (add_wall, remove_wall, set_pose or remove_body of the wall's body);
//   - when the next step begins, by set_velocity with a speed other than zero, and by set_force with a force that has
//     changed since the island fell asleep by so much that it would bring a free body to sleep_speed within a second;
//   - when a step begins with another gravity, or without sleep_speed;
//   - when a step begins in which a dynamic body that is awake, or a moving kinematic one, may come to touch it: their
//     gap is at most a millimetre and what the other body goes in this step at its present speed and acceleration; or
//     with a joint on a kinematic body that moves;
//   - when a step begins in which a new contact of the host's list or of capsules touches, or one that pushed is no longer
//     listed.
//
// In a step in which a body hits a sleeper that it was not foreseen to reach, because something else threw it within that
// step or because the host has just put it there, the sleeper counts as a body that cannot move; the next step wakes it.
#pragma once

#include <array>
#include <cstdint>

#include "motley/core/vector.h"
#include "stores/array.h"

namespace motley {

/// m: things that are nearer than this touch.
inline constexpr double touching_distance = 0.001;

/// What is kept of a body that sleeps.
struct Sleeper {
    std::uint32_t next = 0;  ///< the slot of the next body of its island, in a ring; 0 while it is awake
    /// As BodyRows::acceleration when it fell asleep.
    std::array<float, 6> acceleration{};
};

struct SleepStore {
    Array<Sleeper> sleepers;  ///< by slot of the body; may be shorter than the table of slots
    float speed = 0;          ///< m/s, SolverSettings::sleep_speed of the last step
    Vec3<float> gravity{};    ///< m/s2, of the last step
    std::int32_t pause = 0;   ///< steps before islands are looked for again
};

}  // namespace motley
