// Velocities made anew from impulses where there are many sweeps.
//
// A sweep adds each change of an impulse to the velocities of two bodies, which round it. Thousands of sweeps leave velocities
// and impulses apart by what was lost, and a host that reads forces is told others than acted. So from time to time the
// velocities are what they would be without the impulses, and those are applied once more, all at once: v = v_0 + M^-1 J^T lambda.
#pragma once

#include <array>

#include "layout.h"
#include "sweeper.h"

namespace motley {

class Renewal {
  public:
    /// So many sweeps leave velocities and impulses 1e-6 apart; with fewer nothing is made anew.
    static constexpr int sweeps = 32;

    Renewal(Sweeper& sweeper, Layout& layout) : sweeper_(sweeper), layout_(layout) {}
    /// Notes what velocities would be without the impulses that the blocks hold. Allocates only when there are more bodies than
    /// ever before.
    void begin();
    /// Makes velocities of that and of the impulses that the blocks hold now.
    void renew();

  private:
    Sweeper& sweeper_;
    Layout& layout_;
    std::array<AlignedVector<float>, body_kind_count> unpushed_;  ///< velocities, by kind

    void change_signs();
};

}  // namespace motley
