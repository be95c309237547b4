// What the steering models share: the wish to reach the goal, and the force by which people take up a velocity.
#pragma once

#include <algorithm>
#include <cmath>

#include "worlds/crowd.h"

namespace motley::bench {

/// Straight to the goal at the desired speed, m/s.
inline Vec2<float> desired_velocity(const Crowd& crowd, std::size_t person)
{
    const Agent& agent = crowd.agents[person];
    const auto x = static_cast<float>(agent.goal.x - crowd.positions[person].x),
               y = static_cast<float>(agent.goal.y - crowd.positions[person].y);
    const float speed = agent.desired_speed / std::max(std::sqrt(x * x + y * y), 1e-3F);
    return {speed * x, speed * y};
}

/// m (wanted - v) / tau, N.
inline Vec2<float> towards(Vec2<float> wanted, const Crowd& crowd, std::size_t person)
{
    const float gain = crowd.agents[person].mass / crowd.relaxation_time;
    return {gain * (wanted.x - crowd.velocities[person].x), gain * (wanted.y - crowd.velocities[person].y)};
}

}  // namespace motley::bench
