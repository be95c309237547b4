// A body as the maths of a constraint sees it: only the coordinates its kind has, in any scalar. The same
// functions (velocity at a point, impulse at a point, inverse mass at a point) exist for every kind, so that
// a constraint is written once for all pairs.
#pragma once

#include <type_traits>

#include "maths/scalar.h"
#include "motley/core/vector.h"
#include "stores/body_store.h"

namespace motley {

template <class Real, BodyKind kind>
struct LaneBody;

template <class Real>
struct LaneBody<Real, BodyKind::particle> {
    static constexpr BodyKind kind = BodyKind::particle;
    Vec3<Real> linear;
    Real inverse_mass;
    Vec3<Real> delta;  ///< displacement since the step began
};

template <class Real>
struct LaneBody<Real, BodyKind::planar> {
    static constexpr BodyKind kind = BodyKind::planar;
    Vec2<Real> linear;
    Real yaw_rate;
    Real inverse_mass;
    Vec2<Real> delta;
    Real delta_yaw;
    Real inverse_inertia;
};

template <class Real>
struct LaneBody<Real, BodyKind::rigid> {
    static constexpr BodyKind kind = BodyKind::rigid;
    Vec3<Real> linear;
    Real inverse_mass;
    Vec3<Real> angular;
    Vec3<Real> delta;
    Quat<Real> delta_rotation;
    Sym3<Real> inverse_inertia;  ///< world
};

template <class Real>
struct LaneBody<Real, BodyKind::fixed> {
    static constexpr BodyKind kind = BodyKind::fixed;
    Vec3<Real> linear;
    Vec3<Real> angular;
    Vec3<Real> delta;
    Quat<Real> delta_rotation;
};

/// Two dimensions when nothing in the pair can leave the plane, else three.
constexpr bool is_planar_pair(BodyKind a, BodyKind b)
{
    return (a == BodyKind::planar && (b == BodyKind::planar || b == BodyKind::fixed)) ||
           (a == BodyKind::fixed && b == BodyKind::planar);
}

template <class Real, bool planar>
struct PairSpace {
    using Vector = Vec3<Real>;
    using Symmetric = Sym3<Real>;
};
template <class Real>
struct PairSpace<Real, true> {
    using Vector = Vec2<Real>;
    using Symmetric = Sym2<Real>;
};
template <class Real, BodyKind a, BodyKind b>
using PairVector = typename PairSpace<Real, is_planar_pair(a, b)>::Vector;
template <class Real, BodyKind a, BodyKind b>
using PairSymmetric = typename PairSpace<Real, is_planar_pair(a, b)>::Symmetric;

/// Converts a vector to the space of a pair: drops or keeps z.
template <class Vector, class Real>
Vector to_space(const Vec3<Real>& v)
{
    if constexpr (requires { Vector{}.z; }) {
        return v;
    } else {
        return {v.x, v.y};
    }
}
template <class Real>
Vec3<Real> to_three(const Vec3<Real>& v)
{
    return v;
}
template <class Real>
Vec3<Real> to_three(const Vec2<Real>& v)
{
    return {v.x, v.y, Real(0)};
}

// ---- velocity of the point at `arm` --------------------------------------------------------------------------------

template <class Real>
Vec3<Real> velocity_at(const LaneBody<Real, BodyKind::particle>& body, const Vec3<Real>&)
{
    return body.linear;
}
template <class Real>
Vec2<Real> velocity_at(const LaneBody<Real, BodyKind::planar>& body, const Vec2<Real>& arm)
{
    return {body.linear.x - body.yaw_rate * arm.y, body.linear.y + body.yaw_rate * arm.x};
}
template <class Real>
Vec3<Real> velocity_at(const LaneBody<Real, BodyKind::planar>& body, const Vec3<Real>& arm)
{
    return {body.linear.x - body.yaw_rate * arm.y, body.linear.y + body.yaw_rate * arm.x, Real(0)};
}
template <class Real>
Vec3<Real> velocity_at(const LaneBody<Real, BodyKind::rigid>& body, const Vec3<Real>& arm)
{
    return body.linear + cross(body.angular, arm);
}
template <class Real>
Vec3<Real> velocity_at(const LaneBody<Real, BodyKind::fixed>& body, const Vec3<Real>& arm)
{
    return body.linear + cross(body.angular, arm);
}
template <class Real>
Vec2<Real> velocity_at(const LaneBody<Real, BodyKind::fixed>& body, const Vec2<Real>& arm)
{
    return {body.linear.x - body.angular.z * arm.y, body.linear.y + body.angular.z * arm.x};
}

// ---- impulse P at the point at `arm`: v += M^-1 J^T P --------------------------------------------------------------

template <class Real>
void apply_impulse(LaneBody<Real, BodyKind::particle>& body, const Vec3<Real>&, const Vec3<Real>& impulse)
{
    body.linear = body.linear + body.inverse_mass * impulse;
}
template <class Real>
void apply_impulse(LaneBody<Real, BodyKind::planar>& body, const Vec2<Real>& arm, const Vec2<Real>& impulse)
{
    body.linear = body.linear + body.inverse_mass * impulse;
    body.yaw_rate = body.yaw_rate + body.inverse_inertia * cross(arm, impulse);
}
template <class Real>
void apply_impulse(LaneBody<Real, BodyKind::planar>& body, const Vec3<Real>& arm, const Vec3<Real>& impulse)
{
    apply_impulse(body, Vec2<Real>{arm.x, arm.y}, Vec2<Real>{impulse.x, impulse.y});
}
template <class Real>
void apply_impulse(LaneBody<Real, BodyKind::rigid>& body, const Vec3<Real>& arm, const Vec3<Real>& impulse)
{
    body.linear = body.linear + body.inverse_mass * impulse;
    body.angular = body.angular + body.inverse_inertia * cross(arm, impulse);
}
template <class Real, class Vector>
void apply_impulse(LaneBody<Real, BodyKind::fixed>&, const Vector&, const Vector&)
{
}

/// The rotation by a rotation vector, exactly (the exponential map), at most half a turn.
template <class Real>
Quat<Real> rotation_by(const Vec3<Real>& turn)
{
    const Real angle = square_root(maximum(dot(turn, turn), Real(1e-30F)));
    const SineCosine<Real> half = sine_cosine(minimum(Real(0.5F) * angle, Real(1.5707963F)));
    const Real scale = half.sine / angle;
    return {scale * turn.x, scale * turn.y, scale * turn.z, half.cosine};
}

// ---- the same for positions, in a position solve -------------------------------------------------------------------

template <class Real>
void apply_displacement(LaneBody<Real, BodyKind::particle>& body, const Vec3<Real>&, const Vec3<Real>& push)
{
    body.delta = body.delta + body.inverse_mass * push;
}
template <class Real>
void apply_displacement(LaneBody<Real, BodyKind::planar>& body, const Vec2<Real>& arm, const Vec2<Real>& push)
{
    body.delta = body.delta + body.inverse_mass * push;
    body.delta_yaw = body.delta_yaw + body.inverse_inertia * cross(arm, push);
}
template <class Real>
void apply_displacement(LaneBody<Real, BodyKind::planar>& body, const Vec3<Real>& arm, const Vec3<Real>& push)
{
    apply_displacement(body, Vec2<Real>{arm.x, arm.y}, Vec2<Real>{push.x, push.y});
}
template <class Real>
void apply_displacement(LaneBody<Real, BodyKind::rigid>& body, const Vec3<Real>& arm, const Vec3<Real>& push)
{
    body.delta = body.delta + body.inverse_mass * push;
    body.delta_rotation =
        normalised(rotation_by(body.inverse_inertia * cross(arm, push)) * body.delta_rotation);
}
template <class Real, class Vector>
void apply_displacement(LaneBody<Real, BodyKind::fixed>&, const Vector&, const Vector&)
{
}

// ---- inverse mass of the point at the arm r, -[r]x I^-1 [r]x + 1/m -------------------------------------------------

template <class Real, class Vector>
auto inverse_point_mass(const LaneBody<Real, BodyKind::particle>& body, const Vector&)
{
    const Real m = body.inverse_mass, zero(0);
    return Sym3<Real>{m, zero, zero, m, zero, m};
}
template <class Real>
Sym2<Real> inverse_point_mass(const LaneBody<Real, BodyKind::planar>& body, const Vec2<Real>& arm)
{
    const Real m = body.inverse_mass, i = body.inverse_inertia;
    return {m + i * arm.y * arm.y, -(i * arm.x * arm.y), m + i * arm.x * arm.x};
}
template <class Real>
Sym3<Real> inverse_point_mass(const LaneBody<Real, BodyKind::planar>& body, const Vec3<Real>& arm)
{
    const Sym2<Real> k = inverse_point_mass(body, Vec2<Real>{arm.x, arm.y});
    const Real zero(0);
    return {k.xx, k.xy, zero, k.yy, zero, zero};
}
template <class Real>
Sym3<Real> inverse_point_mass(const LaneBody<Real, BodyKind::rigid>& body, const Vec3<Real>& r)
{
    const Sym3<Real>& i = body.inverse_inertia;
    const Real m = body.inverse_mass;
    // Columns of I^-1 [r]x^T, that is I^-1 (r x e) for each axis e.
    const Vec3<Real> cx = i * Vec3<Real>{Real(0), r.z, -r.y};
    const Vec3<Real> cy = i * Vec3<Real>{-r.z, Real(0), r.x};
    const Vec3<Real> cz = i * Vec3<Real>{r.y, -r.x, Real(0)};
    // Row e of K is (c_e x r), c_e = I^-1 (r x e).
    return {m + (cx.y * r.z - cx.z * r.y), cx.z * r.x - cx.x * r.z, cx.x * r.y - cx.y * r.x,
            m + (cy.z * r.x - cy.x * r.z), cy.x * r.y - cy.y * r.x, m + (cz.x * r.y - cz.y * r.x)};
}
template <class Real>
Sym2<Real> inverse_point_mass(const LaneBody<Real, BodyKind::fixed>&, const Vec2<Real>&)
{
    return {Real(0), Real(0), Real(0)};
}
template <class Real>
Sym3<Real> inverse_point_mass(const LaneBody<Real, BodyKind::fixed>&, const Vec3<Real>&)
{
    const Real zero(0);
    return {zero, zero, zero, zero, zero, zero};
}

// ---- displacement of the point that started at `arm`, to first order in the rotation; and the rotated arm ----------

template <class Real>
Vec3<Real> displacement_at(const LaneBody<Real, BodyKind::particle>& body, const Vec3<Real>&)
{
    return body.delta;
}
template <class Real>
Vec2<Real> displacement_at(const LaneBody<Real, BodyKind::planar>& body, const Vec2<Real>& arm)
{
    return {body.delta.x - body.delta_yaw * arm.y, body.delta.y + body.delta_yaw * arm.x};
}
template <class Real>
Vec3<Real> displacement_at(const LaneBody<Real, BodyKind::planar>& body, const Vec3<Real>& arm)
{
    return {body.delta.x - body.delta_yaw * arm.y, body.delta.y + body.delta_yaw * arm.x, Real(0)};
}
/// The rotation vector of a small rotation, 2 vec(q).
template <class Real>
Vec3<Real> small_rotation(const Quat<Real>& q)
{
    return {q.x + q.x, q.y + q.y, q.z + q.z};
}
template <class Real, BodyKind kind>
requires(kind == BodyKind::rigid ||
         kind == BodyKind::fixed) Vec3<Real> displacement_at(const LaneBody<Real, kind>& body,
                                                             const Vec3<Real>& arm)
{
    return body.delta + cross(small_rotation(body.delta_rotation), arm);
}
template <class Real>
Vec2<Real> displacement_at(const LaneBody<Real, BodyKind::fixed>& body, const Vec2<Real>& arm)
{
    const Real yaw = body.delta_rotation.z + body.delta_rotation.z;
    return {body.delta.x - yaw * arm.y, body.delta.y + yaw * arm.x};
}

template <class Real>
Vec3<Real> turned(const LaneBody<Real, BodyKind::particle>&, const Vec3<Real>& arm)
{
    return arm;
}
template <class Real>
Vec2<Real> turned(const LaneBody<Real, BodyKind::planar>& body, const Vec2<Real>& arm)
{
    const SineCosine<Real> t = sine_cosine(body.delta_yaw);
    return {t.cosine * arm.x - t.sine * arm.y, t.sine * arm.x + t.cosine * arm.y};
}
template <class Real>
Vec3<Real> turned(const LaneBody<Real, BodyKind::planar>& body, const Vec3<Real>& arm)
{
    const Vec2<Real> flat = turned(body, Vec2<Real>{arm.x, arm.y});
    return {flat.x, flat.y, arm.z};
}
template <class Real, BodyKind kind>
requires(kind == BodyKind::rigid ||
         kind == BodyKind::fixed) Vec3<Real> turned(const LaneBody<Real, kind>& body, const Vec3<Real>& arm)
{
    return rotate(body.delta_rotation, arm);
}
template <class Real>
Vec2<Real> turned(const LaneBody<Real, BodyKind::fixed>& body, const Vec2<Real>& arm)
{
    const Vec3<Real> full = rotate(body.delta_rotation, Vec3<Real>{arm.x, arm.y, Real(0)});
    return {full.x, full.y};
}

/// Translation since the step began, in the space of the pair.
template <class Vector, class Body>
Vector translation(const Body& body)
{
    return to_space<Vector>(to_three(body.delta));
}

/// p_b - p_a now, computed from its value when the step began and from displacements, so that nothing is lost far from
/// the origin.
template <class Vector, class A, class B>
Vector anchor_error(const Vector& start_error, const Vector& start_arm_a, const Vector& start_arm_b,
                    const Vector& arm_a, const Vector& arm_b, const A& a, const B& b)
{
    return start_error + (translation<Vector>(b) - translation<Vector>(a)) + (arm_b - start_arm_b) -
           (arm_a - start_arm_a);
}

/// Moves the ends of two arms from their anchors to the midpoint between these; `apart` is p_b - p_a. Where both
/// impulses of a joint act at one point they have no moment together, so angular momentum is kept however far apart the
/// anchors are.
template <class Vector>
void meet_half_way(Vector& arm_a, Vector& arm_b, const Vector& apart)
{
    using Real = std::remove_cvref_t<decltype(apart.x)>;
    arm_a = arm_a + Real(0.5F) * apart;
    arm_b = arm_b - Real(0.5F) * apart;
}

// ---- inverses of effective masses: zero where a direction cannot move, never a division by zero --------------------

/// 1/x, or 0 where x is not above the smallest mass that a float can invert.
template <class Real>
Real inverse_or_zero(const Real& x)
{
    const auto usable = x > Real(1e-30F);
    return select(usable, Real(1) / select(usable, x, Real(1)), Real(0));
}

template <class Real>
Real trace(const Sym3<Real>& k)
{
    return k.xx + k.yy + k.zz;
}

/// The trace of the product of two symmetric matrices.
template <class Real>
Real trace_of_product(const Sym3<Real>& a, const Sym3<Real>& b)
{
    return (a.xx * b.xx + a.yy * b.yy + a.zz * b.zz) + Real(2) * (a.xy * b.xy + a.xz * b.xz + a.yz * b.yz);
}

/// The inverse of a symmetric matrix. It is divided by its trace first, because determinants of bodies of 5e-20 kg m2
/// and of 1e10 kg m2 leave the range of a float. Zero where the determinant of the scaled matrix is lost in rounding.
template <class Real>
Sym2<Real> inverse(const Sym2<Real>& k)
{
    const Real scale = inverse_or_zero(k.xx + k.yy);
    const Real xx = scale * k.xx, xy = scale * k.xy, yy = scale * k.yy;
    const Real d = scale * inverse_or_zero(xx * yy - xy * xy);
    return {d * yy, -(d * xy), d * xx};
}

template <class Real>
Sym3<Real> inverse(const Sym3<Real>& k)
{
    const Real scale = inverse_or_zero(trace(k));
    const Sym3<Real> m{scale * k.xx, scale * k.xy, scale * k.xz, scale * k.yy, scale * k.yz, scale * k.zz};
    const Real d = scale * inverse_or_zero(determinant(m));
    return {d * (m.yy * m.zz - m.yz * m.yz), d * (m.xz * m.yz - m.xy * m.zz),
            d * (m.xy * m.yz - m.xz * m.yy), d * (m.xx * m.zz - m.xz * m.xz),
            d * (m.xz * m.xy - m.xx * m.yz), d * (m.xx * m.yy - m.xy * m.xy)};
}

}  // namespace motley
