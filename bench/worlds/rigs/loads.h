// Light links that bear a heavy ball: iterations converge slowly here.
#pragma once

#include "worlds/rigs/nets.h"

namespace motley::bench {

/// Ten links of 1 kg and a ball of `ratio` kg, along `way` from a point of the world.
inline Rig make_loaded_chain(Vec3<double> way, float ratio)
{
    constexpr int links = 10;
    Rig rig;
    int before = rig_world;
    for (int i = 0; i <= links; ++i) {
        RigBody body = chain_link((i < links ? 0.25 + 0.5 * i : 0.5 * (links + 1)) * way);
        if (way.y != 0) body.inertia = {0.02333F, 0.005F, 0.02333F};
        if (i == links) {
            body.mass = ratio;
            // A ball of 0.5 m: 2/5 m r2.
            body.inertia = {0.1F * ratio, 0.1F * ratio, 0.1F * ratio};
        }
        const int link = rig.add(body);
        rig.joints.push_back({.a = before, .b = link, .anchor = (0.5 * i) * way});
        before = link;
    }
    return rig;
}

inline Rig make_load_level(std::int64_t bodies, std::uint64_t)
{
    return repeat(make_loaded_chain({1, 0, 0}, 1000), bodies / 11);
}
template <int ratio>
Rig make_load_of(std::int64_t bodies, std::uint64_t)
{
    return repeat(make_loaded_chain({0, -1, 0}, static_cast<float>(ratio)), bodies / 11);
}

}  // namespace motley::bench
