// The operations that constraint maths may use on a Real, for float; soa/ defines the same names for lanes.
// Each is defined by what it selects, not by a library call, so that every width gives the same bits:
// max(0, -0) and max(0, NaN) differ between the instructions of processors.
#pragma once

#include <cmath>

namespace motley {

inline float select(bool mask, float if_true, float if_false)
{
    return mask ? if_true : if_false;
}
inline float square_root(float x)
{
    return std::sqrt(x);
}

/// Where x or y is not a number, y.
template <class Real>
Real minimum(const Real& x, const Real& y)
{
    return select(x < y, x, y);
}

/// Where x or y is not a number, y.
template <class Real>
Real maximum(const Real& x, const Real& y)
{
    return select(x > y, x, y);
}

template <class Real>
Real absolute(const Real& x)
{
    return select(x < Real(0), -x, x);
}

template <class Real>
struct SineCosine {
    Real sine, cosine;
};

/// Sine and cosine for |x| <= pi, absolute error below 4e-7. Not those of the C library, whose bits differ between
/// systems: Taylor polynomials of sine (degree 9) and cosine (degree 8) on |x| <= pi/4 of the quarter angle folded
/// twice.
template <class Real>
SineCosine<Real> sine_cosine(const Real& angle)
{
    // Halve twice, evaluate on |y| <= pi/4, and double twice: no branches and no range table.
    const Real y = angle * Real(0.25F);
    const Real y2 = y * y;
    const Real s =
        y * (Real(1) + y2 * (Real(-1.0F / 6) +
                             y2 * (Real(1.0F / 120) + y2 * (Real(-1.0F / 5040) + y2 * Real(1.0F / 362880)))));
    // versine = 1 - cos keeps its digits when the angle is small.
    const Real v =
        y2 * (Real(0.5F) + y2 * (Real(-1.0F / 24) + y2 * (Real(1.0F / 720) + y2 * Real(-1.0F / 40320))));
    // sin 2y = 2 s (1 - v); versin 2y = 2 s^2.
    const Real s2 = (s + s) * (Real(1) - v);
    const Real v2 = (s + s) * s;
    const Real s4 = (s2 + s2) * (Real(1) - v2);
    const Real v4 = (s2 + s2) * s2;
    return {s4, Real(1) - v4};
}

/// The angle of (x, y) for x >= 0, absolute error below 2e-7: Abramowitz and Stegun 4.4.49 on the smaller over the
/// larger. Not that of the C library, whose bits differ between systems; (0, 0) gives 0.
template <class Real>
Real arc_tangent2(const Real& y, const Real& x)
{
    const Real rise = absolute(y);
    const auto steep = rise > x;
    const Real t = select(steep, x, rise) / maximum(select(steep, rise, x), Real(1e-30F));
    const Real t2 = t * t;
    const Real angle =
        t * (Real(1) +
             t2 * (Real(-0.3333314528F) +
                   t2 * (Real(0.1999355085F) +
                         t2 * (Real(-0.1420889944F) +
                               t2 * (Real(0.1065626393F) +
                                     t2 * (Real(-0.0752896400F) +
                                           t2 * (Real(0.0429096138F) + t2 * (Real(-0.0161657367F) +
                                                                             t2 * Real(0.0028662257F)))))))));
    const Real up = select(steep, Real(1.5707963F) - angle, angle);
    return select(y < Real(0), -up, up);
}
/// The same for any x, -pi to pi.
template <class Real>
Real full_arc_tangent2(const Real& y, const Real& x)
{
    const Real angle = arc_tangent2(y, absolute(x)), pi(3.14159265F);
    return select(x < Real(0), select(y < Real(0), -pi, pi) - angle, angle);
}

}  // namespace motley
