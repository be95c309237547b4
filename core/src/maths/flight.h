// Free flight under a constant acceleration a: in a step of duration dt with substeps h, the integration
// v += h a, x += h v moves a body by a h dt / 2 too far, which is corrected at the end of the step.
#pragma once

#include <cstdint>

#include "maths/scalar.h"
#include "motley/core/vector.h"

namespace motley {

/// Whether, to a thousandth, forces alone changed the velocity v of a body along its acceleration a in a step. The
/// arguments are v . a at the start, v . a now, and dt a . a, m2/s3. Impulses perpendicular to a do not change how far
/// a moves the body.
template <class Real>
auto flew_freely(const Real& v_a_at_start, const Real& v_a, const Real& a_a_dt)
{
    return absolute(v_a - v_a_at_start - a_a_dt) < Real(1e-3F) * a_a_dt;
}

/// What BodyStore::commit needs in order to correct bodies that flew freely.
struct Flight {
    const float* start_along = nullptr;        ///< by row: v . a when the step began, see flew_freely
    const std::uint8_t* is_jointed = nullptr;  ///< by row: whether it has joints; FreeGroups corrects these
    float excess = 0;                          ///< StepConstants::flight_excess, s2
    float seconds = 0;                         ///< dt
    Vec3<float> gravity{};                     ///< m/s2
};

}  // namespace motley
