// A body whose kind is known only when a kernel runs: for joints between kinds that few scenes join. One kernel then
// serves all of these pairs, where a kernel for each would be a tenth of the library. All lanes of a bundle are of one
// kind, so the switches below depend on no lane, and each calls the functions of that kind: the bits are the same.
#pragma once

#include "maths/tension.h"
#include "maths/torque.h"
#include "maths/wrench.h"

namespace motley {

/// The kind of such a body, beside those of BodyKind.
inline constexpr BodyKind any_kind{body_kind_count};

/// The fields of a rigid body, and the yaw of a planar one, whose turns are about z. A field that the body's own kind does
/// not have is 0.
template <class Real>
struct LaneBody<Real, any_kind> {
    static constexpr BodyKind kind = any_kind;
    BodyKind own_kind;
    Vec3<Real> linear;
    Real inverse_mass;
    Vec3<Real> angular;
    Vec3<Real> delta;
    Real delta_yaw;
    Quat<Real> delta_rotation;
    Sym3<Real> inverse_inertia;
};
template <class Real>
struct Orientation<Real, any_kind> {
    BodyKind own_kind;
    Real yaw;
    Quat<Real> rotation;
};

// ---- to a body of a certain kind, and back --------------------------------------------------------------------------

template <class Real>
void copy_fields(const LaneBody<Real, any_kind>& from, LaneBody<Real, BodyKind::particle>& to)
{
    to = {from.linear, from.inverse_mass, from.delta};
}
template <class Real>
void copy_fields(const LaneBody<Real, any_kind>& from, LaneBody<Real, BodyKind::planar>& to)
{
    to = {{from.linear.x, from.linear.y}, from.angular.z, from.inverse_mass,
          {from.delta.x, from.delta.y},   from.delta_yaw, from.inverse_inertia.zz};
}
template <class Real>
void copy_fields(const LaneBody<Real, any_kind>& from, LaneBody<Real, BodyKind::rigid>& to)
{
    to = {from.linear, from.inverse_mass,   from.angular,
          from.delta,  from.delta_rotation, from.inverse_inertia};
}
template <class Real>
void copy_fields(const LaneBody<Real, any_kind>& from, LaneBody<Real, BodyKind::fixed>& to)
{
    to = {from.linear, from.angular, from.delta, from.delta_rotation};
}

/// All fields, 0 where the kind has none.
template <class Real, BodyKind kind>
LaneBody<Real, any_kind> as_any(const LaneBody<Real, kind>& body)
{
    const Real none(0);
    LaneBody<Real, any_kind> any{kind,
                                 to_three(body.linear),
                                 none,
                                 {none, none, none},
                                 to_three(body.delta),
                                 none,
                                 {none, none, none, none},
                                 {none, none, none, none, none, none}};
    if constexpr (kind != BodyKind::fixed) any.inverse_mass = body.inverse_mass;
    if constexpr (kind == BodyKind::planar) {
        any.angular.z = body.yaw_rate;
        any.delta_yaw = body.delta_yaw;
        any.inverse_inertia.zz = body.inverse_inertia;
    } else if constexpr (kind != BodyKind::particle) {
        any.angular = body.angular;
        any.delta_rotation = body.delta_rotation;
        if constexpr (kind == BodyKind::rigid) any.inverse_inertia = body.inverse_inertia;
    }
    return any;
}

/// The kinds that such a body may be of: all, or those that turn. Types with rows about axes are not for particles.
enum class Kinds { all, that_turn };

/// Returns work(kind), with the body's own kind as an integral constant.
template <Kinds kinds, class Work>
auto with_kind(BodyKind own_kind, const Work& work)
{
    if constexpr (kinds == Kinds::all) {
        if (own_kind == BodyKind::particle)
            return work(std::integral_constant<BodyKind, BodyKind::particle>{});
    }
    if (own_kind == BodyKind::planar) return work(std::integral_constant<BodyKind, BodyKind::planar>{});
    if (own_kind == BodyKind::rigid) return work(std::integral_constant<BodyKind, BodyKind::rigid>{});
    return work(std::integral_constant<BodyKind, BodyKind::fixed>{});
}
/// Returns look(body) with the body as one of its own kind.
template <Kinds kinds, class Real, class Look>
auto look_at(const LaneBody<Real, any_kind>& any, const Look& look)
{
    return with_kind<kinds>(any.own_kind, [&](auto kind) {
        LaneBody<Real, kind()> body;
        copy_fields(any, body);
        return look(body);
    });
}
/// Calls change(body) likewise, and takes over what it changed.
template <Kinds kinds, class Real, class Change>
void change_by(LaneBody<Real, any_kind>& any, const Change& change)
{
    with_kind<kinds>(any.own_kind, [&](auto kind) {
        LaneBody<Real, kind()> body;
        copy_fields(any, body);
        change(body);
        any = as_any(body);
    });
}

// ---- the functions of lane_body.h ------------------------------------------------------------------------------------

template <class Real>
Vec3<Real> velocity_at(const LaneBody<Real, any_kind>& any, const Vec3<Real>& arm)
{
    return look_at<Kinds::all>(any, [&](const auto& body) { return velocity_at(body, arm); });
}
template <class Real>
void apply_impulse(LaneBody<Real, any_kind>& any, const Vec3<Real>& arm, const Vec3<Real>& impulse)
{
    change_by<Kinds::all>(any, [&](auto& body) { apply_impulse(body, arm, impulse); });
}
template <class Real>
void apply_displacement(LaneBody<Real, any_kind>& any, const Vec3<Real>& arm, const Vec3<Real>& push)
{
    change_by<Kinds::all>(any, [&](auto& body) { apply_displacement(body, arm, push); });
}
template <class Real>
Sym3<Real> inverse_point_mass(const LaneBody<Real, any_kind>& any, const Vec3<Real>& arm)
{
    return look_at<Kinds::all>(any, [&](const auto& body) { return inverse_point_mass(body, arm); });
}
template <class Real>
Vec3<Real> turned(const LaneBody<Real, any_kind>& any, const Vec3<Real>& arm)
{
    return look_at<Kinds::all>(any, [&](const auto& body) { return turned(body, arm); });
}

// ---- of joint_pose.h and wrench.h ------------------------------------------------------------------------------------

template <class Real>
Vec3<Real> to_world(const Orientation<Real, any_kind>& o, const Vec3<Real>& local)
{
    if (o.own_kind == BodyKind::particle) return local;
    if (o.own_kind == BodyKind::planar) return to_world(Orientation<Real, BodyKind::planar>{o.yaw}, local);
    return to_world(Orientation<Real, BodyKind::rigid>{o.rotation}, local);
}
template <class Real>
Quat<Real> to_world(const Orientation<Real, any_kind>& o, const Quat<Real>& local)
{
    if (o.own_kind == BodyKind::planar) return to_world(Orientation<Real, BodyKind::planar>{o.yaw}, local);
    return to_world(Orientation<Real, BodyKind::rigid>{o.rotation}, local);
}
template <class Real>
Vec3<Real> over_mass(const LaneBody<Real, any_kind>& any, const Vec3<Real>& v)
{
    return look_at<Kinds::that_turn>(any, [&](const auto& body) { return over_mass(body, v); });
}
template <class Real>
Vec3<Real> over_inertia(const LaneBody<Real, any_kind>& any, const Vec3<Real>& v)
{
    return look_at<Kinds::that_turn>(any, [&](const auto& body) { return over_inertia(body, v); });
}
/// The inertia of a planar body is about z, and fields that a kind does not have are 0: these need no switch.
template <class Real>
const Sym3<Real>& angular_response(const LaneBody<Real, any_kind>& any)
{
    return any.inverse_inertia;
}
template <class Real>
Real angular_size(const LaneBody<Real, any_kind>& any)
{
    return trace(any.inverse_inertia);
}
template <class Real>
void apply_wrench(LaneBody<Real, any_kind>& any, const Vec3<Real>& linear, const Vec3<Real>& angular)
{
    change_by<Kinds::that_turn>(any, [&](auto& body) { apply_wrench(body, linear, angular); });
}
template <class Real>
void apply_turn(LaneBody<Real, any_kind>& any, const Vec3<Real>& angular)
{
    change_by<Kinds::that_turn>(any, [&](auto& body) { apply_turn(body, angular); });
}
template <class Real>
void displace(LaneBody<Real, any_kind>& any, const Vec3<Real>& linear, const Vec3<Real>& angular)
{
    change_by<Kinds::that_turn>(any, [&](auto& body) { displace(body, linear, angular); });
}
template <class Real>
Quat<Real> turn_of(const LaneBody<Real, any_kind>& any)
{
    return look_at<Kinds::that_turn>(any, [](const auto& body) -> Quat<Real> { return turn_of(body); });
}
template <class Real>
Real turn_about(const LaneBody<Real, any_kind>& any, const Vec3<Real>& axis)
{
    return look_at<Kinds::that_turn>(any, [&](const auto& body) { return turn_about(body, axis); });
}
template <class Real>
Vec3<Real> small_turn_of(const LaneBody<Real, any_kind>& any)
{
    return look_at<Kinds::that_turn>(any, [](const auto& body) { return small_turn_of(body); });
}
template <class Real>
bool is_fixed(const LaneBody<Real, any_kind>& any)
{
    return any.own_kind == BodyKind::fixed;
}
template <class Real>
bool stays_in_plane(const LaneBody<Real, any_kind>& any)
{
    return any.own_kind != BodyKind::rigid;
}

// ---- of tension.h and torque.h ---------------------------------------------------------------------------------------

template <class Real>
Real unbearable_tension(const LaneBody<Real, any_kind>& any, const Vec3<Real>& arm, const Vec3<Real>& push,
                        const Real& substep)
{
    return look_at<Kinds::all>(
        any, [&](const auto& body) { return unbearable_tension(body, arm, push, substep); });
}
template <class Real>
void stiffen(LaneBody<Real, any_kind>& any, const Vec3<Real>& arm, const Vec3<Real>& push,
             const Real& substep)
{
    change_by<Kinds::all>(any, [&](auto& body) { stiffen(body, arm, push, substep); });
}
template <class Real>
Real largest_response(const LaneBody<Real, any_kind>& any)
{
    return look_at<Kinds::all>(any, [](const auto& body) { return largest_response(body); });
}

}  // namespace motley
