// What the tests of crowds on several ranks share.
#pragma once

#include <gtest/gtest.h>
#include <mpi.h>

#include <cstdint>
#include <vector>

#include "walkers.h"

namespace motley::testing {

inline constexpr float dt = 1.0F / 60;

inline int rank()
{
    int own = 0;
    MPI_Comm_rank(MPI_COMM_WORLD, &own);
    return own;
}
inline int ranks()
{
    int all = 1;
    MPI_Comm_size(MPI_COMM_WORLD, &all);
    return all;
}
inline std::int64_t sum(std::int64_t value)
{
    MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_INT64_T, MPI_SUM, MPI_COMM_WORLD);
    return value;
}

/// Adds each person on some rank, whatever the person's place.
inline void add_all(DistributedCrowd& crowd, const Walkers& walkers)
{
    walkers.add_walls(crowd.scene());
    for (std::size_t i = 0; i < walkers.numbers.size(); ++i) {
        if (static_cast<int>(i * 7919 % 101) % ranks() != rank()) continue;
        crowd.add_people({&walkers.numbers[i], 1}, {&walkers.bodies[i], 1}, {&walkers.discs[i], 1});
    }
}

/// Every rank gets the loads that rank 0 has.
inline void send_to_all(std::vector<BodyLoad>& loads)
{
    MPI_Bcast(loads.data(), static_cast<int>(sizeof(BodyLoad) * loads.size()), MPI_BYTE, 0, MPI_COMM_WORLD);
}

inline void expect_same(const BodyLoad& load, const BodyLoad& expected)
{
    EXPECT_EQ(load.normal_force, expected.normal_force);
    EXPECT_EQ(load.largest_normal_force, expected.largest_normal_force);
    EXPECT_EQ(load.net_force.x, expected.net_force.x);
    EXPECT_EQ(load.net_force.y, expected.net_force.y);
    EXPECT_EQ(load.pressure, expected.pressure);
}

/// A wall across the middle of the hall that goes to and fro and turns: on a kinematic body, which every rank has and moves
/// alike.
class Door {
  public:
    Door(Scene& scene, const Walkers& walkers)
    {
        body_ = scene.add_body({.motion = BodyMotion::kinematic_body,
                                .position = {0.5 * walkers.width, 0.5 * walkers.height, 0}});
        const std::vector<Vec2<double>> ends{{-0.2 * walkers.width, 0}, {0.2 * walkers.width, 0}};
        scene.add_wall({.points = ends, .body = body_, .friction = 0.3F});
    }
    /// To be called before each step.
    void move(Scene& scene, int step) const
    {
        const float direction = step / 60 % 2 == 0 ? 1 : -1;
        scene.set_velocity(body_, {0.3F * direction, 0.8F * direction, 0}, {0, 0, 0.3F});
    }
    void stop(Scene& scene) const { scene.set_velocity(body_, {}, {}); }

  private:
    BodyId body_;
};

}  // namespace motley::testing
