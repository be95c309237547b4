// How far a limit or a motor may step where exact joints hold a point of its two bodies.
//
// A sweep knows the response K = J M^-1 J^T of the two bodies alone, with which a step of lambda = -K^-1 J v ends at J v = 0.
// Exact joints are solved after it and move the bodies back: a forearm that an elbow's limit has turned about its centre must
// turn about the elbow, and of the step only a twentieth may be left. The limit would then need many sweeps, give way by
// many times what its softness says, and can keep a figure moving for ever. With a step of up to 1.8 times the length
// a sweep still never gains energy (successive over-relaxation converges for factors below 2: C. Cryer, The Solution of a
// Quadratic Programming Problem Using Systematic Overrelaxation, 1971), and it is never longer than
//
//   1 / (K - u . K_p^-1 u)
//
// which would end at J v = 0 if the two bodies were alone and held together at the point. K_p is the response of the point
// and u its speed after a unit impulse along the row.
#pragma once

#include "maths/lane_body.h"
#include "maths/wrench.h"

namespace motley {

/// The most by which a step is longer than that of the two bodies alone.
constexpr float longest_step = 1.8F;

/// The effective mass of an angular row with the axis n on b, -n on a, and the response K of the two bodies alone; r: arms of
/// the point.
template <class Real, class A, class B>
Real effective_mass_at_point(const Real& k, const Vec3<Real>& n, const A& a, const Vec3<Real>& arm_a,
                             const B& b, const Vec3<Real>& arm_b)
{
    const Vec3<Real> u = cross(over_inertia(b, n), arm_b) + cross(over_inertia(a, n), arm_a);
    const Sym3<Real> k_p = inverse_point_mass(a, arm_a) + inverse_point_mass(b, arm_b);
    return inverse_or_zero(maximum(k - dot(u, inverse(k_p) * u), Real(1 / longest_step) * k));
}

}  // namespace motley
