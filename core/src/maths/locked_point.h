// How far a limit or a motor may step where exact joints hold a point of its two bodies.
//
// A sweep knows the response K = J M^-1 J^T of the two bodies alone: after a step of lambda = -K^-1 J v, J v = 0. Then the exact
// joints are solved, which leaves only part of it. An elbow's limit, for example, turns the forearm about its centre, and the
// elbow then makes it turn about the elbow, where its moment of inertia is larger: a small part of the step is left. Such a
// limit needs many sweeps, gives way by many times what its softness says, and may keep a figure moving for ever.
//
// So the step is longer, by a factor of up to 1.8: below 2 it never gains energy (successive over-relaxation; C. Cryer, The
// Solution of a Quadratic Programming Problem Using Systematic Overrelaxation, 1971). It is never longer than
//
//   1 / (K - u . K_p^-1 u)
//
// times -J v, after which J v = 0 if the two bodies are held together at the point and touch nothing else. K_p is the response
// of the point, and u how fast it would come apart after a unit impulse along the row.
#pragma once

#include "maths/lane_body.h"
#include "maths/wrench.h"

namespace motley {

/// The most by which a step is longer than that of the two bodies alone.
constexpr float longest_step = 1.8F;

/// The inverse of the response, kg m2, with which an angular row steps whose axis is n on b and -n on a. The arms are those of
/// the point, m. 0 where neither body turns.
template <class Real, class A, class B>
Real effective_mass_at_point(const Vec3<Real>& n, const A& a, const Vec3<Real>& arm_a, const B& b,
                             const Vec3<Real>& arm_b)
{
    const Vec3<Real> turn_a = over_inertia(a, n), turn_b = over_inertia(b, n);
    const Real k = dot(n, turn_a + turn_b);
    const Vec3<Real> u = cross(turn_b, arm_b) + cross(turn_a, arm_a);
    const Sym3<Real> k_p = inverse_point_mass(a, arm_a) + inverse_point_mass(b, arm_b);
    return inverse_or_zero(maximum(k - dot(u, inverse(k_p) * u), Real(1 / longest_step) * k));
}

}  // namespace motley
