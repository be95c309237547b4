// An impulse of several directions whose norm is bounded: friction within its cone, a servo within its strength.
//
//   C(lambda):  w = 0 and |lambda| <= bound,   or   |lambda| = bound and lambda = -(bound / |w|) w
//
// w is the speed that is left. Inside the bound nothing is left; at the bound the impulse points against what is left
// (Coulomb's law of friction). lambda - K^-1 w solves w = 0 at once, but to shorten it when it is too long is wrong: it ends
// along K^-1 w, which is not the direction of w where the response K of the bodies differs from direction to direction. A
// rod that slides on its end would be braked 16 degrees off. The same stride in every direction, lambda - w / k_max, and then
// shortened, comes to rest only where lambda points against w. With k_max the largest eigenvalue of K, or above it, no
// such step adds energy: it is a projected gradient step on the energy of the pair.
#pragma once

#include "motley/core/lane_body.h"

namespace motley {

/// What makes a vector no longer than `most`: 1, or less.
template <class Vector, class Real>
Real scale_within(const Vector& v, const Real& most)
{
    const Real length2 = dot(v, v);
    const auto too_long = length2 > most * most;
    return select(too_long, most / square_root(select(too_long, length2, Real(1))), Real(1));
}

template <class Mask, class Real>
Vec2<Real> select(const Mask& mask, const Vec2<Real>& if_true, const Vec2<Real>& if_false)
{
    return {select(mask, if_true.x, if_false.x), select(mask, if_true.y, if_false.y)};
}
template <class Mask, class Real>
Vec3<Real> select(const Mask& mask, const Vec3<Real>& if_true, const Vec3<Real>& if_false)
{
    return {select(mask, if_true.x, if_false.x), select(mask, if_true.y, if_false.y),
            select(mask, if_true.z, if_false.z)};
}

/// The impulse after a step: `free` = lambda - K^-1 w where that is within the bound, else `cautious` = lambda - w / k_max,
/// made no longer than the bound.
template <class Vector, class Real>
Vector bounded_impulse(const Vector& free, const Vector& cautious, const Real& bound)
{
    const auto held_back = dot(free, free) > bound * bound;
    const Vector next = select(held_back, cautious, free);
    return scale_within(next, bound) * next;
}

/// An upper bound on the largest eigenvalue of a symmetric matrix: its largest sum of a row's sizes (Gershgorin). What is
/// the same in every direction has it exactly.
template <class Real>
Real largest_response(const Sym2<Real>& k)
{
    const Real xy = absolute(k.xy);
    return maximum(k.xx, k.yy) + xy;
}
template <class Real>
Real largest_response(const Sym3<Real>& k)
{
    const Real xy = absolute(k.xy), xz = absolute(k.xz), yz = absolute(k.yz);
    return maximum(maximum(k.xx + xy + xz, k.yy + xy + yz), k.zz + xz + yz);
}

/// The principal directions of a symmetric matrix of positive eigenvalues.
template <class Real>
struct Principal {
    Vec2<Real> direction;  ///< unit, of the largest; the other one is across it
    Real largest, smallest;
};
template <class Real>
Principal<Real> principal(const Sym2<Real>& k)
{
    // By the mean, so that no square leaves the range of a float.
    const Real mean = Real(0.5F) * (k.xx + k.yy), scale = inverse_or_zero(mean);
    const Real half = Real(0.5F) * scale * (k.xx - k.yy), xy = scale * k.xy;
    const Real apart2 = half * half + xy * xy;
    const auto differ = apart2 > Real(1e-12F);
    const Real apart = square_root(select(differ, apart2, Real(1)));
    // (K - smallest) of the axis that is nearer to the largest: no digits are lost.
    const auto nearer_x = half > Real(0);
    const Real along = apart + absolute(half);
    const Vec2<Real> v{select(nearer_x, along, xy), select(nearer_x, xy, along)};
    const Real unit = select(differ, Real(1) / square_root(dot(v, v)), Real(0));
    const Real spread = select(differ, apart, Real(0));
    // What is lost in the rounding of the largest is held at what rounding can tell: a smaller step, no wrong one.
    return {{select(differ, unit * v.x, Real(1)), unit * v.y},
            mean * (Real(1) + spread),
            mean * maximum(Real(1) - spread, Real(1e-6F))};
}

}  // namespace motley
