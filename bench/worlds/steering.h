// How people decide where to go: the part of a crowd simulation that belongs to the host. motley takes the forces that a
// model asks for and adds the contacts.
#pragma once

#include <memory>
#include <span>

#include "motley/motley.h"

namespace motley::bench {

class Crowd;

/// plain: straight to the goal, see Crowd::steer(); the others are described in steering/.
enum class SteeringModel { plain, social_force, orca };

class Steering {
  public:
    Steering() = default;
    Steering(const Steering&) = delete;
    Steering& operator=(const Steering&) = delete;
    virtual ~Steering() = default;
    /// Writes the force on each person, N, in the order of crowd.agents, from what crowd.observe() has read.
    virtual void find_forces(const Crowd& crowd, std::span<Vec3<float>> forces, Executor& executor) = 0;
};

/// Null for `plain`.
std::unique_ptr<Steering> make_steering(SteeringModel model);

}  // namespace motley::bench
