// The social force model: D. Helbing and P. Molnar, Phys. Rev. E 51, 4282 (1995), with the parameters of D. Helbing,
// I. Farkas and T. Vicsek, Nature 407, 487 (2000).
//
//     f_i = m (v0 e - v) / tau + sum_j A exp((r_i + r_j - d_ij) / B) n_ij + sum_w A exp((r_i - d_iw) / B) n_iw
//
// d is a distance between centres, or from the nearest point of a wall; n points at person i. The model of 2000 adds a
// body force k (r_i + r_j - d) and a sliding friction while people touch. Both are left out: motley's contacts take
// their place, and need no spring that is stiff enough to keep people apart.
#pragma once

#include "worlds/neighbours.h"
#include "worlds/steering.h"

namespace motley::bench {

class SocialForce final : public Steering {
  public:
    static constexpr float strength = 2000;  ///< N: A
    static constexpr float range = 0.08F;    ///< m: B
    static constexpr float reach = 1;        ///< m: beyond this gap the force is below 0.01 N and left out

    void find_forces(const Crowd& crowd, std::span<Vec3<float>> forces, Executor& executor) override;

  private:
    Neighbours neighbours_;
};

}  // namespace motley::bench
