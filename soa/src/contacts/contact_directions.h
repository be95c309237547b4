// The directions of a contact's rows, from the row that its kernels prepared: for solvers of whole islands, which need
// the Jacobian itself.
#pragma once

#include <cmath>
#include <cstddef>

#include "constraints/contact.h"
#include "kernels/kernel_table.h"
#include "stores/disc_fields.h"

namespace motley {

/// One row J = [-n, -l_a, n, l_b] of a contact: n its direction, l = r x n the levers of the bodies' arms.
struct ContactDirection {
    Vec3<double> n, lever_a, lever_b;
};

/// A contact as a solver of islands reads it from lane `lane` of a block.
struct ContactDirections {
    static constexpr int most = 3;
    ContactDirection of[most];  ///< the normal, and the tangents if there is friction
    int count = 1;
    double separation = 0;             ///< m, when the step began
    double friction = 0;               ///< coefficient
    double surface_speed[2] = {0, 0};  ///< of a's surface along the tangents, m/s
    double most_force = HUGE_VAL;      ///< N, along the normal
};

namespace detail {

template <class Real>
Vec3<double> in_double(const Vec3<Real>& v)
{
    return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
}
template <class Real>
Vec3<double> in_double(const Vec2<Real>& v)
{
    return {static_cast<double>(v.x), static_cast<double>(v.y), 0};
}
/// A lever of one number is about z.
inline Vec3<double> in_double(float lever)
{
    return {0, 0, static_cast<double>(lever)};
}
inline Vec3<double> in_double(NoLever)
{
    return {0, 0, 0};
}

template <class Type, BodyKind a, BodyKind b>
ContactDirections directions_of(const float* rows, std::size_t block, std::size_t lane)
{
    const auto whole = load_lane<typename Type::template Row<float, a, b>>(rows, block, lane);
    const auto& row = [&]() -> const auto&
    {
        if constexpr (Type::has_restitution) {
            return whole.in_sweep;
        } else {
            return whole;
        }
    }
    ();
    ContactDirections all;
    all.separation = static_cast<double>(row.separation);
    const Vec3<double> n = in_double(row.normal);
    if constexpr (Type::smooth) {
        all.of[0] = {n, in_double(row.lever_a), in_double(row.lever_b)};
    } else {
        all.friction = static_cast<double>(row.friction);
        constexpr bool planar = !requires
        {
            row.tangent;
        };
        const Vec3<double> arm_a = in_double(row.arm_a), arm_b = in_double(row.arm_b);
        const auto along = [&](const Vec3<double>& d) {
            return ContactDirection{d, cross(arm_a, d), cross(arm_b, d)};
        };
        all.of[0] = along(n);
        if constexpr (requires { row.tangent; }) {
            const Vec3<double> t = in_double(row.tangent);
            all.of[1] = along(t);
            all.of[2] = along(cross(n, t));
            all.count = 3;
        } else {
            all.of[1] = along(in_double(Type::tangent_of(row.normal)));
            all.count = 2;
        }
        if constexpr (Type::has_restitution) {
            all.most_force = static_cast<double>(row.most_force);
            const Vec3<double> along_tangents = in_double(row.surface_speed);
            all.surface_speed[0] = planar ? along_tangents.z : along_tangents.x;
            all.surface_speed[1] = planar ? 0 : along_tangents.y;
        }
    }
    return all;
}

/// The same of discs, whose normals pass through their centres; a wall's body turns about its own.
template <DiscClass c>
ContactDirections directions_of_discs(const float* rows, std::size_t block, std::size_t lane)
{
    const auto whole = load_lane<typename DiscFieldsOf<c>::Row>(rows, block, lane);
    const auto& row = whole.in_sweep;
    ContactDirections all;
    all.separation = static_cast<double>(whole.start_separation);
    const Vec3<double> n = in_double(row.normal), t{-n.y, n.x, 0};
    Vec3<double> arm_a{0, 0, 0};
    if constexpr (is_wall(c)) {
        arm_a = in_double(row.arm_a);
        all.most_force = static_cast<double>(row.most_force);
    }
    all.of[0] = {n, cross(arm_a, n), {0, 0, 0}};
    if constexpr (is_rough(c)) {
        if constexpr (is_wall(c)) {
            all.surface_speed[0] = static_cast<double>(row.surface_speed);
        } else {
            arm_a = static_cast<double>(row.arm_a) * n;
        }
        all.friction = static_cast<double>(row.friction);
        all.of[1] = {t, cross(arm_a, t), {0, 0, -static_cast<double>(row.arm_b)}};
        all.count = 2;
    }
    return all;
}

using ReadDirections = ContactDirections (*)(const float* rows, std::size_t block, std::size_t lane);

/// Null for pairs that do not occur: body a is of the kind that comes first (see ContactIntake), and one of them moves.
template <class Type, BodyKind a, BodyKind b>
constexpr ReadDirections reader_of()
{
    if constexpr (a > b || a == BodyKind::fixed) {
        return nullptr;
    } else {
        return directions_of<Type, a, b>;
    }
}
template <class Type, BodyKind a>
ReadDirections reader_of(BodyKind b)
{
    switch (b) {
        case BodyKind::particle:
            return reader_of<Type, a, BodyKind::particle>();
        case BodyKind::planar:
            return reader_of<Type, a, BodyKind::planar>();
        case BodyKind::rigid:
            return reader_of<Type, a, BodyKind::rigid>();
        case BodyKind::fixed:
            break;
    }
    return reader_of<Type, a, BodyKind::fixed>();
}
template <class Type>
ReadDirections reader_of(BodyKind a, BodyKind b)
{
    switch (a) {
        case BodyKind::particle:
            return reader_of<Type, BodyKind::particle>(b);
        case BodyKind::planar:
            return reader_of<Type, BodyKind::planar>(b);
        case BodyKind::rigid:
            return reader_of<Type, BodyKind::rigid>(b);
        case BodyKind::fixed:
            break;
    }
    return reader_of<Type, BodyKind::fixed>(b);
}

}  // namespace detail

using detail::ReadDirections;

/// What reads the rows of contacts of discs: with friction or not, with each other or a wall.
inline ReadDirections reader_of_discs(bool rough, bool wall)
{
    if (wall) {
        return rough ? detail::directions_of_discs<DiscClass::rough_wall>
                     : detail::directions_of_discs<DiscClass::smooth_wall>;
    }
    return rough ? detail::directions_of_discs<DiscClass::rough_pair>
                 : detail::directions_of_discs<DiscClass::smooth_pair>;
}

/// What reads the rows of a contact type and pair of bodies.
inline ReadDirections reader_of_contacts(int type, BodyKind a, BodyKind b)
{
    switch (static_cast<Touch>(type)) {
        case Touch::smooth:
            return detail::reader_of<SmoothContact>(a, b);
        case Touch::rough:
            return detail::reader_of<RoughContact>(a, b);
        case Touch::bouncing:
            break;
    }
    return detail::reader_of<BouncingContact>(a, b);
}

}  // namespace motley
