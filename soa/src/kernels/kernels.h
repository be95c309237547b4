// The kernels of constraint types for every pair of body kinds. Included inside an anonymous namespace, after Lanes.
#pragma once

#include "kernels/kernel_rows.h"

#include "kernels/kernel_bodies.h"

#include "kernels/kernel_bundle.h"

#include "kernels/kernel_blocks.h"

#include "kernels/kernel_sweeps.h"

#include "kernels/kernel_once.h"

#include "kernels/kernel_rare.h"

#include "kernels/kernel_exact_rows.h"

constexpr bool is_built(BodyKind kind)
{
    switch (kind) {
#ifdef MOTLEY_WITHOUT_PARTICLE
        case BodyKind::particle:
            return false;
#endif
#ifdef MOTLEY_WITHOUT_PLANAR
        case BodyKind::planar:
            return false;
#endif
#ifdef MOTLEY_WITHOUT_RIGID
        case BodyKind::rigid:
            return false;
#endif
        default:
            return true;
    }
}

/// Whether blocks of such a pair occur. A scene refuses two bodies that cannot move, which need no constraint, and a particle
/// where the type locks axes, which a particle does not have. Contacts are put in order: see ContactIntake.
template <class Type, BodyKind a, BodyKind b>
constexpr bool occurs()
{
    constexpr bool moves = a != BodyKind::fixed || b != BodyKind::fixed;
    constexpr bool has_particle = a == BodyKind::particle || b == BodyKind::particle;
    const bool in_order = !Type::is_contact || a <= b;
    return is_built(a) && is_built(b) && moves && in_order && !(has_particle && Type::needs_bodies_that_turn);
}
/// Two moving bodies of different kinds.
constexpr bool is_mixed(BodyKind a, BodyKind b)
{
    return a != b && a != BodyKind::fixed && b != BodyKind::fixed;
}
/// Two bodies of one kind, or one of them fixed. Not joints about axes on planar bodies: most of their rows lock what
/// the plane forbids anyway, and in the plane a ball-socket serves as the hinge and a distance joint as the rope.
template <class Type, BodyKind a, BodyKind b>
constexpr bool is_usual()
{
    const bool is_planar = a == BodyKind::planar || b == BodyKind::planar;
    return !is_mixed(a, b) && !(is_planar && Type::needs_bodies_that_turn) && !Type::is_rare;
}
/// Joints between moving bodies of different kinds are few in any scene, and so are joints of a rare type between others
/// than rigid bodies: one scalar copy of their kernels serves every instruction set, with the same bits. See kernel_table().
template <class Type, BodyKind a, BodyKind b>
constexpr bool is_left_to_scalar()
{
    const bool has_rigid = a == BodyKind::rigid || b == BodyKind::rigid;
    const bool few = is_mixed(a, b) || (Type::is_rare && !has_rigid);
    return Lanes_width > 1 && few && !Type::is_contact;
}

/// The kind as which a kernel computes a body. One kernel serves all unusual pairs of a joint. A joint that does not need to
/// know which of its bodies are fixed takes a fixed body for a rigid one without inverse mass.
template <class Type, BodyKind kind, BodyKind partner>
constexpr BodyKind computed_as()
{
    if (Type::is_contact) return kind;
    if (is_mixed(kind, partner) || (Type::needs_bodies_that_turn && is_planar_pair(kind, partner)))
        return any_kind;
    const bool as_rigid = kind == BodyKind::fixed && partner == BodyKind::rigid && !Type::has_restitution;
    return as_rigid ? BodyKind::rigid : kind;
}

template <KernelShare share, class Type, BodyKind a, BodyKind b>
void enter_pair(ConstraintKernels* pairs)
{
    if constexpr (occurs<Type, a, b>() && !is_left_to_scalar<Type, a, b>()) {
        constexpr BodyKind as_a = computed_as<Type, a, b>(), as_b = computed_as<Type, b, a>();
        ConstraintKernels& kernels = pairs[class_of(0, a, b)];
        constexpr bool usual = is_usual<Type, a, b>();
        if constexpr (share == (usual ? KernelShare::swept : KernelShare::unusual)) {
            SweepKernels<Type, as_a, as_b>::enter(kernels);
            ExactRowKernels<Type, as_a, as_b>::enter_swept(kernels);
        }
        if constexpr (share == (usual ? KernelShare::once : KernelShare::rare))
            OnceKernels<Type, as_a, as_b>::enter(kernels);
        if constexpr (share == KernelShare::rare) {
            RareKernels<Type, as_a, as_b>::enter(kernels);
            ExactRowKernels<Type, as_a, as_b>::enter_rare(kernels);
        }
    }
}

template <KernelShare share, class Type, BodyKind a>
void enter_partners(ConstraintKernels* pairs)
{
    enter_pair<share, Type, a, BodyKind::particle>(pairs);
    enter_pair<share, Type, a, BodyKind::planar>(pairs);
    enter_pair<share, Type, a, BodyKind::rigid>(pairs);
    enter_pair<share, Type, a, BodyKind::fixed>(pairs);
}

template <KernelShare share, class Type>
void enter_type(ConstraintKernels* pairs)
{
    enter_partners<share, Type, BodyKind::particle>(pairs);
    enter_partners<share, Type, BodyKind::planar>(pairs);
    enter_partners<share, Type, BodyKind::rigid>(pairs);
    enter_partners<share, Type, BodyKind::fixed>(pairs);
}

template <KernelShare share, class... Types>
void enter_types(ConstraintKernels* pairs, TypeList<Types...>)
{
    int type = 0;
    (enter_type<share, Types>(pairs + class_of(type++, BodyKind{}, BodyKind{})), ...);
}
