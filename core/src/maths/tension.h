// Stability of light bodies that bear heavy loads.
//
// A taut joint is a stiff spring against rotation: an impulse P of a substep h that pulls outwards at the end of an arm
// r turns a body back that has turned by a small angle, by an angular impulse of r . P times that angle. A substep
// applies P at the arm of its beginning, and once h r . P exceeds about twice the inertia I each substep swings the
// body wider: its load gains energy without bound, however exactly the joint holds. So for this step the inertia grows
// by twice the part of h r . P that an explicit substep cannot follow,
//
//   I' = I + 2 max(0, h r . P - 1 / b),   b = tr I^-1 - n . I^-1 n,   n = r / |r|,
//
// where b is the response to torques perpendicular to the arm. Then (h w)^2 = h r . P / I', with the angular frequency
// w of the swing, stays below 1 whatever the load; an explicit substep is stable up to 4. The factor is two because P
// is of the step before. The same is added in all directions, so that no singular matrix has to be inverted. Velocities
// are not changed: bodies that turn as a whole are not slowed down, and bodies with loads that a substep can follow are
// not changed at all. (Mass scaling by geometric stiffness. M. Tournier and others, Stable Constrained Dynamics, 2015,
// and S. Andrews and others, Geometric Stiffness for Real-time Constrained Multibody Dynamics, 2017, add the same
// stiffness, but it slows bodies down.)
#pragma once

#include "maths/lane_body.h"

namespace motley {

/// The arms and impulses of a joint when a step begins.
template <class Real>
struct Tension {
    Vec3<Real> arm_a, arm_b;    ///< m, world: from the centres of mass to where the impulses act
    Vec3<Real> push_a, push_b;  ///< N s, of the substep before
};

/// max(0, h r . P - 1 / b), kg m2: what a substep cannot follow; 0 for bodies that do not turn.
template <class Real, BodyKind kind>
Real unbearable_tension(const LaneBody<Real, kind>& body, const Vec3<Real>& arm, const Vec3<Real>& push,
                        const Real& substep)
{
    if constexpr (kind == BodyKind::rigid) {
        const Sym3<Real>& i = body.inverse_inertia;
        const Real across = trace(i) - inverse_or_zero(dot(arm, arm)) * dot(arm, i * arm);
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

/// Replaces the inertia I of a body by I'.
template <class Real, BodyKind kind>
void stiffen(LaneBody<Real, kind>& body, const Vec3<Real>& arm, const Vec3<Real>& push, const Real& substep)
{
    const Real k = Real(2) * unbearable_tension(body, arm, push, substep);
    if constexpr (kind == BodyKind::rigid) {
        // (I + k 1)^-1 = (1 + k I^-1)^-1 I^-1; the factors commute, so the product is symmetric.
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
