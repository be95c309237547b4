// An impulse of several directions whose norm is bounded: friction within its cone, a servo within its strength.
//
//   w = 0 and |lambda| <= bound,   or   |lambda| = bound and lambda = -(bound / |w|) w
//
// lambda is the impulse and w the relative speed that remains after it. Inside the bound no speed remains; at the bound
// the impulse points against it (Coulomb's law of friction). K = J M^-1 J^T is the response of the bodies. The step to
// lambda - K^-1 w makes w = 0 at once, but shortening that to the bound would be wrong: it converges to an impulse
// along K^-1 w, which is not the direction of w where K differs from direction to direction. A rod that slides on its
// end would be braked 16 degrees off. The step to lambda - w / k_max, which has the same stride in every direction, may
// be shortened: it converges only where lambda points against w. With k_max at least the largest eigenvalue of K no
// such step adds energy, because it is a projected gradient step on the energy of the pair.
#pragma once

#include "maths/lane_body.h"

namespace motley {

/// The factor, at most 1, that makes a vector no longer than `most`.
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

/// The impulse after a step: `free` = lambda - K^-1 w where that is within the bound, else `cautious` = lambda - w /
/// k_max, shortened to the bound if it is longer.
template <class Vector, class Real>
Vector bounded_impulse(const Vector& free, const Vector& cautious, const Real& bound)
{
    const auto held_back = dot(free, free) > bound * bound;
    const Vector next = select(held_back, cautious, free);
    return scale_within(next, bound) * next;
}

/// An upper bound on the largest eigenvalue of a symmetric matrix: the largest sum of the absolute values in a row
/// (Gershgorin). Exact for a multiple of the identity.
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
    Vec2<Real> direction;  ///< unit eigenvector of the largest eigenvalue; the other is perpendicular to it
    Real largest, smallest;
};
template <class Real>
Principal<Real> principal(const Sym2<Real>& k)
{
    // Divided by the mean of the diagonal, so that no square leaves the range of a float.
    const Real mean = Real(0.5F) * (k.xx + k.yy), scale = inverse_or_zero(mean);
    const Real half = Real(0.5F) * scale * (k.xx - k.yy), xy = scale * k.xy;
    const Real apart2 = half * half + xy * xy;
    const auto differ = apart2 > Real(1e-12F);
    const Real apart = square_root(select(differ, apart2, Real(1)));
    // The eigenvector is a column of K - smallest I: that of the axis nearer to it, where no digits are lost.
    const auto nearer_x = half > Real(0);
    const Real along = apart + absolute(half);
    const Vec2<Real> v{select(nearer_x, along, xy), select(nearer_x, xy, along)};
    const Real unit = select(differ, Real(1) / square_root(dot(v, v)), Real(0));
    const Real spread = select(differ, apart, Real(0));
    // A smallest eigenvalue that is lost in rounding is raised to 1e-6 of the mean: steps get smaller, but not wrong.
    return {{select(differ, unit * v.x, Real(1)), unit * v.y},
            mean * (Real(1) + spread),
            mean * maximum(Real(1) - spread, Real(1e-6F))};
}

}  // namespace motley
