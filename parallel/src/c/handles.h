// What the opaque handles of the C interface hold, and the structs that many of its calls use.
#pragma once

#include "maths/bit_cast.h"
#include "mirror.h"
#include "motley/c/figures.h"
#include "motley/c/scene.h"
#include "motley/core/assembly.h"
#include "motley/core/ids.h"
#include "motley/core/scene.h"

struct motley_scene {
    motley::Scene scene;
};
struct motley_figure {
    motley::Figure figure;
};

namespace motley::c {

inline Scene& scene_of(motley_scene* scene)
{
    return need(scene, "scene").scene;
}
inline const Scene& scene_of(const motley_scene* scene)
{
    return need(scene, "scene").scene;
}

inline Figure& figure_of(motley_figure* figure)
{
    return need(figure, "figure").figure;
}
inline const Figure& figure_of(const motley_figure* figure)
{
    return need(figure, "figure").figure;
}

template <>
struct Mirror<motley_vec2f, Vec2<float>> : Pair<motley_vec2f, Vec2<float>> {
    static constexpr auto fields = std::tuple(MOTLEY_FIELD(x), MOTLEY_FIELD(y));
};
template <>
struct Mirror<motley_vec2d, Vec2<double>> : Pair<motley_vec2d, Vec2<double>> {
    static constexpr auto fields = std::tuple(MOTLEY_FIELD(x), MOTLEY_FIELD(y));
};
template <>
struct Mirror<motley_vec3f, Vec3<float>> : Pair<motley_vec3f, Vec3<float>> {
    static constexpr auto fields = std::tuple(MOTLEY_FIELD(x), MOTLEY_FIELD(y), MOTLEY_FIELD(z));
};
template <>
struct Mirror<motley_vec3d, Vec3<double>> : Pair<motley_vec3d, Vec3<double>> {
    static constexpr auto fields = std::tuple(MOTLEY_FIELD(x), MOTLEY_FIELD(y), MOTLEY_FIELD(z));
};
template <>
struct Mirror<motley_quatf, Quat<float>> : Pair<motley_quatf, Quat<float>> {
    static constexpr auto fields =
        std::tuple(MOTLEY_FIELD(x), MOTLEY_FIELD(y), MOTLEY_FIELD(z), MOTLEY_FIELD(w));
};
template <>
struct Mirror<motley_quatd, Quat<double>> : Pair<motley_quatd, Quat<double>> {
    static constexpr auto fields =
        std::tuple(MOTLEY_FIELD(x), MOTLEY_FIELD(y), MOTLEY_FIELD(z), MOTLEY_FIELD(w));
};
template <>
struct Mirror<motley_sym3f, Sym3<float>> : Pair<motley_sym3f, Sym3<float>> {
    static constexpr auto fields = std::tuple(MOTLEY_FIELD(xx), MOTLEY_FIELD(xy), MOTLEY_FIELD(xz),
                                              MOTLEY_FIELD(yy), MOTLEY_FIELD(yz), MOTLEY_FIELD(zz));
};
template <>
struct Mirror<motley_body_id, BodyId> : Pair<motley_body_id, BodyId> {
    static constexpr auto fields = std::tuple(MOTLEY_FIELD(slot), MOTLEY_FIELD(generation));
};
template <>
struct Mirror<motley_constraint_id, ConstraintId> : Pair<motley_constraint_id, ConstraintId> {
    static constexpr auto fields = std::tuple(MOTLEY_FIELD(slot), MOTLEY_FIELD(generation));
};
template <>
struct Mirror<motley_wall_id, WallId> : Pair<motley_wall_id, WallId> {
    static constexpr auto fields = std::tuple(MOTLEY_FIELD(slot), MOTLEY_FIELD(generation));
};
template <>
struct Mirror<motley_shape_id, ShapeId> : Pair<motley_shape_id, ShapeId> {
    static constexpr auto fields = std::tuple(MOTLEY_FIELD(slot), MOTLEY_FIELD(generation));
};

/// A value of the C interface that has the same layout as one of the C++ interface, as that, and the other way.
template <class To, class From>
To as(const From& value)
{
    if constexpr (requires { Mirror<From, To>::fields; }) {
        static_assert(same_layout<From, To>());
    } else {
        static_assert(same_layout<To, From>());
    }
    return motley::bit_cast<To>(value);
}

/// Writes a handle to where the host wants it, if it does.
template <class C, class Cpp>
void give_handle(C* to, const Cpp& handle)
{
    if (to != nullptr) *to = as<C>(handle);
}

inline std::span<const BodyId> bodies_of(const motley_body_id* bodies, std::size_t count)
{
    return array<const BodyId>(bodies, count, "bodies");
}

}  // namespace motley::c
