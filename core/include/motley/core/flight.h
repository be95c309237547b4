// Free flight under a constant force, which v += h a, x += h v takes a h dt / 2 too far in a step of substeps h.
#pragma once

#include <cstdint>

#include "motley/core/scalar.h"
#include "motley/core/vector.h"

namespace motley {

/// Whether forces alone made what a body's velocity v gained along its acceleration a in a step, up to a thousandth: all three are
/// products with a, m2/s3. What pushes across a does not matter to how far a takes it.
template <class Real>
auto flew_freely(const Real& v_a_at_start, const Real& v_a, const Real& a_a_dt)
{
    return absolute(v_a - v_a_at_start - a_a_dt) < Real(1e-3F) * a_a_dt;
}

/// What a commit has to know of the step: v += h a, x += h v takes what flies freely a h dt / 2 too far.
struct Flight {
    const float* start_along = nullptr;        ///< by row: v a when the step began, see flew_freely
    const std::uint8_t* is_jointed = nullptr;  ///< by row: FreeGroups sees to these
    float excess = 0;                          ///< StepConstants::flight_excess, s2
    float seconds = 0;                         ///< dt
    Vec3<float> gravity{};                     ///< m/s2
};

}  // namespace motley
