// Computes velocities anew from impulses where there are many sweeps.
//
// A sweep adds each change of an impulse to the velocities of two bodies, which round it. After thousands of sweeps
// velocities and impulses differ by what was lost, and a host that reads forces gets others than those that acted. So
// from time to time the velocities are computed as v = v_0 + M^-1 J^T lambda, where v_0 are the velocities without
// the impulses lambda, M is the mass matrix and J the Jacobian.
#pragma once

#include <array>

#include "layout/layout.h"
#include "sweeper.h"

namespace motley {

class Renewal {
  public:
    /// After this many sweeps velocities and impulses differ by 1e-6; with fewer nothing is computed anew.
    static constexpr int sweeps = 32;

    Renewal(Sweeper& sweeper, Layout& layout) : sweeper_(sweeper), layout_(layout) {}
    /// Stores what velocities would be without the impulses that the blocks hold. Allocates only when there are more
    /// bodies than ever before.
    void begin();
    /// Computes velocities from those and from the impulses that the blocks hold now.
    void renew();

  private:
    Sweeper& sweeper_;
    Layout& layout_;
    std::array<AlignedVector<float>, body_kind_count> unpushed_;  ///< velocities, by kind

    void change_signs();
};

}  // namespace motley
