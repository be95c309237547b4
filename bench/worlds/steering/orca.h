// Optimal reciprocal collision avoidance: J. van den Berg, S. J. Guy, M. Lin and D. Manocha, "Reciprocal n-body collision
// avoidance", Springer Tracts in Advanced Robotics 70, 3 (2011), written from the paper.
//
// Of two people, velocities relative to each other that would make them collide within `horizon` form a cone with a
// round tip (a velocity obstacle). u is the smallest change that takes their relative velocity out of it, and each makes
// half of the change: v is to stay in the half plane at v + u / 2 across u. Among all half planes of the nearest people,
// and of walls, the velocity nearest to the wish is taken. It is reached with a force of at most m v0 / tau, so that a
// person who is held pushes no harder than with the other models; what then touches is motley's part.
#pragma once

#include "worlds/neighbours.h"
#include "worlds/steering.h"
#include "worlds/steering/half_planes.h"

namespace motley::bench {

/// The nearest way out of the velocity obstacle of someone at `offset`, m, whose distance is larger than `radii`, the sum
/// of both: the point of its border that is nearest to the `relative` velocity, and the normal there, which points out of
/// the obstacle.
HalfPlane way_out(Vec2<float> offset, float radii, Vec2<float> relative);

class Orca final : public Steering {
  public:
    static constexpr float horizon = 2;         ///< s: collisions that people avoid
    static constexpr float wall_horizon = 0.5;  ///< s
    static constexpr float reaction_time =
        0.1F;                          ///< s in which a velocity is taken up, as far as the force allows
    static constexpr float reach = 3;  ///< m: the gap beyond which nobody is considered
    /// m that people keep between each other where there is room: they take up a velocity late, and would brush.
    static constexpr float clearance = 0.05F;
    static constexpr std::size_t most = 10;  ///< people who are considered, the nearest

    void find_forces(const Crowd& crowd, std::span<Vec3<float>> forces, Executor& executor) override;

  private:
    Neighbours neighbours_;
};

}  // namespace motley::bench
