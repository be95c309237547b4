// Light bodies that bear heavy loads.
//
// A taut joint is a stiff spring against turning: an impulse P that pulls at the end of an arm r turns back what has
// turned by an angle, with r . P of it. A substep sees the arm where it was, and swings the body wider each time once
// h r . P exceeds about twice the inertia: the load gains energy without bound, however well the joint holds. So the inertia grows
// for this step by twice what an explicit substep cannot follow,
//
//   I' = I + 2 max(0, h r . P - 1 / b),   b = tr I^-1 - n . I^-1 n,   n = r / |r|,
//
// and (h w)^2 = h r . P / I', w the frequency, stays below 1 whatever the load; an explicit substep follows up to 4. Twice, because P is of the step before. All
// directions alike, which inverts nothing that may be singular. Velocities stay as they are: nothing is slowed down that turns
// as one, and nothing at all is changed of what bears loads that a substep can follow.
// (Mass scaling by geometric stiffness; M. Tournier and others, Stable Constrained Dynamics, 2015, S. Andrews and others,
// Geometric Stiffness for Real-time Constrained Multibody Dynamics, 2017, add the same K and slow bodies down by it.)
#pragma once

#include "motley/core/lane_body.h"

namespace motley {

/// What a joint pulls with when a step begins.
template <class Real>
struct Tension {
    Vec3<Real> arm_a, arm_b;    ///< m, world: from the centres of mass to where it pulls
    Vec3<Real> push_a, push_b;  ///< N s, of the substep before
};

/// What h r . P has beyond what a substep can follow, kg m2; 0 for bodies that do not turn.
template <class Real, BodyKind kind>
Real unbearable_tension(const LaneBody<Real, kind>& body, const Vec3<Real>& arm, const Vec3<Real>& push,
                        const Real& substep)
{
    if constexpr (kind == BodyKind::rigid) {
        const Sym3<Real>& i = body.inverse_inertia;
        const Real across = (i.xx + i.yy + i.zz) - inverse_or_zero(dot(arm, arm)) * dot(arm, i * arm);
        const Real beyond = substep * dot(arm, push) - inverse_or_zero(across);
        return select(across > Real(0), maximum(beyond, Real(0)), Real(0));
    } else if constexpr (kind == BodyKind::planar) {
        const Real& i = body.inverse_inertia;
        const Real beyond = substep * (arm.x * push.x + arm.y * push.y) - inverse_or_zero(i);
        return select(i > Real(0), maximum(beyond, Real(0)), Real(0));
    } else {
        return Real(0);
    }
}

/// Gives a body I' for I.
template <class Real, BodyKind kind>
void stiffen(LaneBody<Real, kind>& body, const Vec3<Real>& arm, const Vec3<Real>& push, const Real& substep)
{
    const Real k = Real(2) * unbearable_tension(body, arm, push, substep);
    if constexpr (kind == BodyKind::rigid) {
        // (I + k)^-1 = (1 + k I^-1)^-1 I^-1, which commute.
        const Sym3<Real>& i = body.inverse_inertia;
        const Real one(1);
        const Sym3<Real> share =
            inverse(Sym3<Real>{one + k * i.xx, k * i.xy, k * i.xz, one + k * i.yy, k * i.yz, one + k * i.zz});
        const Vec3<Real> x = share * Vec3<Real>{i.xx, i.xy, i.xz}, y = share * Vec3<Real>{i.xy, i.yy, i.yz},
                         z = share * Vec3<Real>{i.xz, i.yz, i.zz};
        const auto bears = k > Real(0);
        body.inverse_inertia = {select(bears, x.x, i.xx), select(bears, x.y, i.xy), select(bears, x.z, i.xz),
                                select(bears, y.y, i.yy), select(bears, y.z, i.yz), select(bears, z.z, i.zz)};
    } else if constexpr (kind == BodyKind::planar) {
        const Real& i = body.inverse_inertia;
        body.inverse_inertia = select(k > Real(0), i / (Real(1) + k * i), i);
    }
}

}  // namespace motley
