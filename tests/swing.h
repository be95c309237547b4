// The period of something that swings about z.
#pragma once

#include "rig.h"

namespace motley::testing {

/// s: the mean time between successive ends of the swing on one side, over `seconds`, which must have more than four.
inline double swing_period(Scene& scene, Solver& solver, BodyId body, int seconds)
{
    double last_rate = 0, first = 0, last = 0;
    int ends = 0;
    for (int step = 0; step < 60 * seconds; ++step) {
        solver.step(scene, frame_time);
        const double rate = scene.state(body).angular_velocity.z;
        if (last_rate > 0 && rate <= 0) {
            last = (step + last_rate / (last_rate - rate)) / 60;
            if (ends++ == 0) first = last;
        }
        last_rate = rate;
    }
    EXPECT_GT(ends, 4);
    return (last - first) / (ends - 1);
}

}  // namespace motley::testing
