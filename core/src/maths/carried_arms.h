// Lever arms for relaxation, which sweeps after bodies have moved.
//
// Rows are built when a substep begins. The impulses P of a joint on both bodies act at one point, and so change no angular
// momentum. After the bodies have moved by h v, the same arms end at points that are h (v_b - v_a) apart, and every P changes it by
// the cross product of that with P. So the arms are carried along with the bodies, to the middle of where their points have got to:
//
//   r_a' = r_a + h (u - v_a),   r_b' = r_b + h (u - v_b),   u = (v_a + w_a x r_a + v_b + w_b x r_b) / 2
//
// r: arms; v, w: velocities, about those with which the bodies have moved; h: the time. u - v is w x r where the joint holds, so this
// is also how far arms turn, to first order in h w.
//
// The effective mass stays that of the old arms. A sweep with another one gives energy where the response K = J M^-1 J^T along some
// direction has become twice what it was. Arms that move by x change K by about x^2 tr(I^-1), beside 1/m_a + 1/m_b which is in
// K along every direction. Where the sum of that for both bodies is more than a quarter, as a share, arms stay: to move them only
// in part would be worse than either.
//
// A rod, rope or spring acts on each body at its own point, along the line between them. Arms turn with their own bodies then, and
// the axis u with the line: with d between the points,
//
//   r' = r + h w x r of each body,   u' = d' / |d'|,   d' = d + h (v_b + w_b x r_b - v_a - w_a x r_a)
#pragma once

#include "maths/wrench.h"

namespace motley {

/// tr(I^-1) of each body over 1/m_a + 1/m_b, in 1/m2: the same all through a step.
template <class Real>
struct ArmWeights {
    Real a, b;
};
template <class A, class B>
auto arm_weights(const A& a, const B& b)
{
    const auto mass = inverse_or_zero(linear_size(a) + linear_size(b));
    return ArmWeights<std::remove_cvref_t<decltype(mass)>>{mass * angular_size(a), mass * angular_size(b)};
}

/// The share of a response that carried arms may change, and the square of the turn of an axis, rad2.
inline constexpr float most_carried = 0.25F;

/// The velocity of a body's centre, as a vector of its pair.
template <class Vector, class Body>
Vector of_centre(const Body& body)
{
    return to_space<Vector>(to_three(body.linear));
}

/// Carries the arms of one point along, if the bodies have moved for StepConstants::moved_for.
template <class Real, class Vector, class A, class B>
void carry_arms(const StepConstants& step, const ArmWeights<Real>& weights, Vector& arm_a, Vector& arm_b,
                const A& a, const B& b)
{
    const Vector middle = Real(0.5F) * (velocity_at(a, arm_a) + velocity_at(b, arm_b));
    const Vector by_a = middle - of_centre<Vector>(a), by_b = middle - of_centre<Vector>(b);
    const Real h(step.moved_for);
    const Real changed = h * h * (weights.a * dot(by_a, by_a) + weights.b * dot(by_b, by_b));
    const Real moved = select(changed < Real(most_carried), h, Real(0));
    arm_a = arm_a + moved * by_a;
    arm_b = arm_b + moved * by_b;
}

/// The same for impulses along the line between the ends of the arms, which is `length` long and has this unit axis.
template <class Real, class Vector, class A, class B>
void carry_line(const StepConstants& step, const ArmWeights<Real>& weights, const Real& length, Vector& axis,
                Vector& arm_a, Vector& arm_b, const A& a, const B& b)
{
    const Real h(step.moved_for);
    const Vector at_a = velocity_at(a, arm_a), at_b = velocity_at(b, arm_b);
    const Vector by_a = h * (at_a - of_centre<Vector>(a)), by_b = h * (at_b - of_centre<Vector>(b));
    const Vector d = length * axis + h * (at_b - at_a);
    const Vector by_axis = inverse_or_zero(square_root(dot(d, d))) * d - axis;
    const Real turned = dot(by_axis, by_axis);
    const Real changed = weights.a * (dot(by_a, by_a) + turned * dot(arm_a, arm_a)) +
                         weights.b * (dot(by_b, by_b) + turned * dot(arm_b, arm_b));
    // Where the points meet or pass each other the axis has no direction, or turns round.
    const Real moved = select(maximum(changed, turned) < Real(most_carried), Real(1), Real(0));
    axis = axis + moved * by_axis;
    arm_a = arm_a + moved * by_a;
    arm_b = arm_b + moved * by_b;
}

}  // namespace motley
